// Scatter of the gaits of a library: any figure over any other one.
"use strict";

const VERDICT_COLOURS = { pass: "zmp", fail: "right", infeasible: "faint", lost: "faint" };

class Scatter extends Plot {
  /** `choose` is called with the row that is clicked. */
  constructor(library, choose) {
    super("", { onChange: () => {} });
    Object.assign(this, { library, choose, rows: [], x: null, y: null, chosen: null });
    this.canvas.addEventListener("click", (event) => {
      const row = this.nearest(event.offsetX, event.offsetY);
      if (row) this.choose(row);
    });
  }

  set(rows, x, y) {
    Object.assign(this, { rows, x, y });
    this.title = `${this.library.label(y)} over ${this.library.label(x)}`;
    this.canvas.setAttribute("aria-label", `Scatter: ${this.title}`);
    this.redraw();
  }

  frameNow() {
    return {};
  }

  timeAt() {
    return null;
  }

  points() {
    const { index } = this.library, i = index(this.x), j = index(this.y);
    return this.rows.filter((row) => Number.isFinite(row[i]) && Number.isFinite(row[j]))
      .map((row) => ({ row, x: row[i], y: row[j] }));
  }

  bounds(values) {
    let low = Infinity, high = -Infinity;
    for (const value of values) {
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
    if (low > high) return [0, 1];
    const margin = 0.05 * (high - low) || 0.05 * Math.abs(high) || 1;
    return [low - margin, high + margin];
  }

  xOf(value) {
    const [low, high] = this.xRange;
    return EDGE.left + (value - low) / (high - low) * (this.width - EDGE.left - EDGE.right);
  }

  yOf(value) {
    const [low, high] = this.yRange;
    return this.height - EDGE.bottom - (value - low) / (high - low) * (this.height - EDGE.top - EDGE.bottom);
  }

  draw(pen) {
    this.drawn = this.points();
    this.xRange = this.bounds(this.drawn.map((point) => point.x));
    this.yRange = this.bounds(this.drawn.map((point) => point.y));
    this.axes(pen, ticks(...this.xRange, this.width / 90), ticks(...this.yRange, 5), "");
    const verdict = this.library.index("verdict");
    pen.globalAlpha = 0.75;
    for (const { row, x, y } of this.drawn) {
      pen.fillStyle = colourOf(VERDICT_COLOURS[row[verdict]] || "faint");
      pen.beginPath();
      pen.arc(this.xOf(x), this.yOf(y), this.drawn.length > 2000 ? 2 : 4, 0, 7);
      pen.fill();
    }
    pen.globalAlpha = 1;
  }

  drawCursor(pen) {
    const point = (this.drawn || []).find(({ row }) => row === this.chosen);
    pen.textAlign = "right";
    pen.textBaseline = "top";
    pen.fillStyle = colourOf("faint");
    pen.fillText(`${(this.drawn || []).length} gaits`, this.width - EDGE.right, 5);
    if (!point) return;
    pen.strokeStyle = colourOf("ink");
    pen.lineWidth = 2;
    pen.beginPath();
    pen.arc(this.xOf(point.x), this.yOf(point.y), 7, 0, 7);
    pen.stroke();
  }

  nearest(px, py) {
    let best = null, least = 30 ** 2;
    for (const { row, x, y } of this.drawn || []) {
      const far = (this.xOf(x) - px) ** 2 + (this.yOf(y) - py) ** 2;
      if (far < least) [best, least] = [row, far];
    }
    return best;
  }
}
