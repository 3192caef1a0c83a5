// Assembly of the page from its data.
"use strict";

const GHOSTS = ["ghost", "left"];

function decode(motion) {
  motion.decoded = unpackAll(motion.arrays);
  motion.weight = motion.mass * 9.81;
  motion.replays.forEach((replay, i) => {
    replay.decoded = unpackAll(replay.arrays);
    replay.colour = GHOSTS[i % GHOSTS.length];
  });
}

function lastTime(motion) {
  const ends = motion.replays.map((replay) => replay.decoded.t.values.at(-1));
  return Math.max(motion.duration, ...ends);
}

/** Table of several motions side by side. */
function comparison(motions) {
  const labels = [...new Set(motions.flatMap((motion) => motion.facts.map(([label]) => label)))];
  const names = [...new Set(motions.flatMap((motion) => motion.verdict.checks.map((c) => c.name)))];
  const row = (label, cells) => make("tr", {}, make("th", {}, label), ...cells);
  const facts = labels.map((label) => row(label, motions.map((motion) =>
    make("td", {}, (motion.facts.find(([name]) => name === label) || ["", "–"])[1]))));
  const checks = names.map((name) => row(name.replaceAll("_", " "), motions.map((motion) => {
    const check = motion.verdict.checks.find((each) => each.name === name);
    const text = check ? `${check.ok ? "✓" : "✗"} ${figure(check.value)} ${check.unit} (limit ${figure(check.limit)})` : "–";
    return make("td", {}, check && !check.ok ? make("strong", {}, text) : text);
  })));
  return make("details", { class: "panel", open: "" }, make("summary", {}, "Comparison"),
    make("div", { class: "scroll" }, make("table", {}, make("tbody", {},
      row("Motion", motions.map((motion) => make("td", {}, motion.file || motion.gait, " ", badge(motion.verdict.passed)))),
      ...facts, ...checks))));
}

function motionElement(motion, clock, span, views, single) {
  const joints = new JointPanel(motion, clock, span);
  const stage = stagePanel(motion, clock, views);
  const verdict = verdictPanel(motion, clock, joints);
  const plots = motionPlots(motion, clock, span);
  const title = make("h2", {}, `${motion.file || motion.gait} `, badge(motion.verdict.passed));
  return make("article", { class: "motion" }, single ? null : title,
    make("div", { class: "top" }, stage, verdict),
    make("div", { class: "plots" }, ...plots.map((plot) => plot.element)),
    joints.element, originPanel(motion));
}

function start(data) {
  const { motions } = data, single = motions.length === 1;
  motions.forEach(decode);
  const duration = Math.max(...motions.map(lastTime));
  const clock = new Clock(duration), span = { near: duration > 60 }, views = [];
  const theme = themeButton();
  window.addEventListener("repaint", () => views.forEach((view) => view.paint()));
  const articles = motions.map((motion) => motionElement(motion, clock, span, views, single));
  const near = make("button", { "aria-pressed": String(span.near), title: "Time span of the plots",
    onclick: () => {
      span.near = !span.near;
      near.setAttribute("aria-pressed", String(span.near));
      window.dispatchEvent(new Event("repaint"));
    } }, `Plots: ${NEAR} s only`);
  const heading = single ? `${motions[0].gait} of ${motions[0].robot}` : `${motions.length} motions with one clock`;
  document.getElementById("app").append(
    make("header", {}, make("h1", {}, heading), ...(single ? [badge(motions[0].verdict.passed)] : []),
      make("span", { class: "faint" }, `mgs ${data.mgs}`), theme, ...(duration > NEAR ? [near] : [])),
    make("main", { class: `motions ${single ? "one" : "many"}` }, ...articles),
    ...(single ? [] : [make("div", { class: "motions" }, comparison(motions))]),
    make("p", { class: "message faint" }, `Keys: ${KEYS_TEXT}`),
    transport(clock));
  bindKeys(clock, views);
  repaint();
  const asked = /^#t=([\d.]+)$/.exec(location.hash);
  clock.set(asked ? Number(asked[1]) : 0);
  window.mgsPage = { clock, views, motions };
}

start(JSON.parse(document.getElementById("data").textContent));
