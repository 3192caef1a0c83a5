// A gait library as a sortable table and a scatter, with links to the pages of its gaits.
"use strict";

const AT_ONCE = 100; // rows of the table that are shown before one asks for more

class Library {
  constructor(data) {
    Object.assign(this, { data, rows: data.rows, shown: AT_ONCE, chosen: null });
    this.sorting = { column: data.columns.indexOf("speed"), down: true };
    this.index = (name) => data.columns.indexOf(name);
    this.label = (name) => (data.units[name] ? `${name} [${data.units[name]}]` : name);
    this.search = make("input", { type: "search", placeholder: "Filter by text", "aria-label": "Filter by text",
      oninput: () => this.refresh() });
    const verdicts = [...new Set(this.rows.map((row) => row[this.index("verdict")]))].sort();
    this.verdict = select("Verdict", ["all verdicts", ...verdicts], () => this.refresh());
    const numeric = data.columns.filter((name, i) => name !== "number" &&
      this.rows.some((row) => typeof row[i] === "number"));
    this.x = select("Horizontal axis", numeric, () => this.refresh(), "speed");
    this.y = select("Vertical axis", numeric, () => this.refresh(), numeric.includes("zmp_margin") ? "zmp_margin" : numeric[0]);
    this.scatter = new Scatter(this, (row) => this.choose(row));
    this.picked = make("p", { class: "faint" }, "Click on a point or on a row to choose a gait.");
    this.head = make("tr", {}, ...data.columns.map((name, i) => make("th", {}, make("button", {
      title: "Sort", onclick: () => this.sort(i),
    }, this.label(name)))), make("th", {}, "Page"));
    this.body = make("tbody");
    this.more = make("button", { onclick: () => { this.shown += 5 * AT_ONCE; this.refresh(); } }, "Show more");
    this.count = make("span", { class: "faint" });
    this.refresh();
  }

  sort(column) {
    const { sorting } = this;
    this.sorting = { column, down: sorting.column === column ? !sorting.down : false };
    this.refresh();
  }

  selected() {
    const text = this.search.value.trim().toLowerCase(), verdict = this.index("verdict");
    const kind = this.verdict.selectedIndex ? this.verdict.value : null;
    const found = this.rows.filter((row) => (kind === null || row[verdict] === kind) &&
      (!text || row.some((cell) => cell !== null && String(cell).toLowerCase().includes(text))));
    const { column, down } = this.sorting;
    return found.sort((a, b) => {
      const [p, q] = [a[column], b[column]];
      if (p === null || q === null) return (p === null) - (q === null); // missing values at the end
      const order = typeof p === "number" && typeof q === "number" ? p - q : String(p).localeCompare(String(q));
      return down ? -order : order;
    });
  }

  refresh() {
    const rows = this.selected(), shown = rows.slice(0, this.shown);
    this.body.replaceChildren(...shown.map((row) => this.rowElement(row)));
    this.count.textContent = `${shown.length} of ${rows.length} gaits`;
    this.more.hidden = shown.length === rows.length;
    [...this.head.children].forEach((cell, i) => cell.setAttribute("aria-sort",
      i !== this.sorting.column ? "none" : this.sorting.down ? "descending" : "ascending"));
    this.scatter.set(rows, this.x.value, this.y.value);
  }

  rowElement(row) {
    const verdict = row[this.index("verdict")];
    const cells = row.slice(0, this.data.columns.length).map((cell) => make("td",
      { class: typeof cell === "number" ? "number" : "" }, typeof cell === "number" ? figure(cell) : cell ?? "–"));
    const names = [verdict === "pass" ? "" : "fail", row === this.chosen ? "chosen" : ""];
    return make("tr", { class: names.join(" ").trim(), onclick: () => this.choose(row) },
      ...cells, make("td", {}, this.link(row, "open") ?? "–"));
  }

  link(row, text) {
    const page = row[this.data.columns.length];
    return page ? make("a", { href: page }, text) : null;
  }

  choose(row) {
    this.chosen = this.scatter.chosen = row;
    const told = this.data.columns.map((name, i) => [name, row[i]]).filter(([, value]) => value !== null)
      .map(([name, value]) => `${name} ${typeof value === "number" ? figure(value) : value}`).join(", ");
    this.picked.replaceChildren(...[this.link(row, `Page of gait ${row[0]}`), ` ${told}`].filter(Boolean));
    this.refresh();
  }
}

function select(label, options, onchange, value = options[0]) {
  const element = make("select", { "aria-label": label, onchange },
    ...options.map((option) => make("option", { value: option }, option)));
  element.value = value;
  return element;
}

function summaryPanel(data) {
  const rows = data.facts.flatMap(([label, text]) => [make("dt", {}, label), make("dd", {}, text)]);
  return make("section", { class: "panel" }, make("h2", {}, "Summary"), make("dl", {}, ...rows));
}

function startLibrary(data) {
  const library = new Library(data);
  document.getElementById("app").append(
    make("header", {}, make("h1", {}, data.title), make("span", { class: "faint" }, `mgs ${data.mgs}`), themeButton()),
    make("main", { class: "library" }, summaryPanel(data),
      make("section", { class: "panel" },
        make("div", { class: "row" }, make("label", {}, "Horizontal ", library.x), make("label", {}, "Vertical ", library.y)),
        library.scatter.element, library.picked),
      make("section", { class: "panel" },
        make("div", { class: "row" }, library.search, library.verdict, library.count),
        make("div", { class: "scroll" }, make("table", {}, make("thead", {}, library.head), library.body)),
        library.more)));
  repaint();
  window.mgsLibrary = library;
}

startLibrary(JSON.parse(document.getElementById("data").textContent));
