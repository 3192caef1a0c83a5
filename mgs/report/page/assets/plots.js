// Plots over time and from above, each with a cursor at the time of the clock.
"use strict";

const NEAR = 10; // [s] time span of a plot that does not show the whole motion
const SOFTWARE = { willReadFrequently: true }; // faster for small drawings than to use the GPU
const EDGE = { left: 52, right: 10, top: 26, bottom: 22 };

function ticks(low, high, most) {
  const span = high - low || 1, raw = span / most, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= raw);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * span; k++) found.push(k * step);
  return found;
}

/** Canvas with a drawing that stays and a cursor that moves. */
class Plot {
  constructor(title, clock) {
    this.clock = clock;
    this.title = title;
    this.still = document.createElement("canvas");
    this.canvas = make("canvas", { role: "img", "aria-label": title });
    this.element = make("div", { class: "panel plot" }, this.canvas);
    new ResizeObserver(() => this.redraw()).observe(this.canvas);
    new IntersectionObserver((entries) => { // what is out of sight is not drawn
      this.visible = entries.at(-1).isIntersecting;
      this.redraw();
    }, { rootMargin: "30%" }).observe(this.canvas);
    clock.onChange(() => this.refresh());
    window.addEventListener("repaint", () => this.redraw());
    const scrub = (event) => {
      const t = this.timeAt(event.offsetX, event.offsetY);
      if (t !== null) clock.set(t);
    };
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      scrub(event);
    });
    this.canvas.addEventListener("pointermove", (event) => { if (event.buttons & 1) scrub(event); });
  }

  redraw() {
    const ratio = window.devicePixelRatio || 1;
    this.width = this.canvas.clientWidth;
    this.height = this.canvas.clientHeight;
    if (!this.visible || !this.width || !this.height) return;
    for (const canvas of [this.canvas, this.still]) {
      canvas.width = Math.round(this.width * ratio);
      canvas.height = Math.round(this.height * ratio);
    }
    const pen = this.still.getContext("2d", SOFTWARE);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, this.width, this.height);
    pen.font = "12px system-ui, sans-serif";
    this.frame = this.frameNow();
    this.draw(pen);
    this.cursor();
  }

  refresh() {
    if (!this.visible || !this.width) return;
    const frame = this.frameNow();
    if (this.frame && Object.keys(frame).every((key) => frame[key] === this.frame[key])) this.cursor();
    else this.redraw();
  }

  cursor() {
    const pen = this.canvas.getContext("2d", SOFTWARE), ratio = window.devicePixelRatio || 1;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, this.canvas.width, this.canvas.height);
    pen.drawImage(this.still, 0, 0);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.font = "12px system-ui, sans-serif";
    this.drawCursor(pen);
  }

  axes(pen, xTicks, yTicks, xLabel) {
    const { left, top } = EDGE, right = this.width - EDGE.right, bottom = this.height - EDGE.bottom;
    pen.fillStyle = colourOf("faint");
    pen.strokeStyle = colourOf("line");
    pen.lineWidth = 1;
    pen.beginPath();
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (const value of yTicks) {
      const y = this.yOf(value);
      pen.moveTo(left, y);
      pen.lineTo(right, y);
      if (y > top + 5) pen.fillText(figure(Math.abs(value) < 1e-12 ? 0 : value), left - 5, y);
    }
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (const value of xTicks) {
      const x = this.xOf(value);
      pen.moveTo(x, top);
      pen.lineTo(x, bottom);
      if (x < right - 34) pen.fillText(figure(Math.abs(value) < 1e-12 ? 0 : value), x, bottom + 5);
    }
    pen.stroke();
    pen.textAlign = "right";
    pen.fillText(xLabel, right, bottom + 5);
    pen.textAlign = "left";
    pen.textBaseline = "top";
    pen.fillStyle = colourOf("ink");
    pen.font = "600 12.5px system-ui, sans-serif";
    pen.fillText(this.title, 4, 4);
    pen.font = "12px system-ui, sans-serif";
  }
}

/** Lines over time: {times, values, colour, name, dashed, scale}; limits: [{value, colour}]. */
class TimePlot extends Plot {
  constructor(title, clock, span, lines, limits = [], support = null) {
    super(title, clock);
    Object.assign(this, { span, lines, limits, support });
  }

  set(title, lines, limits) {
    Object.assign(this, { title, lines, limits });
    this.canvas.setAttribute("aria-label", title);
    this.redraw();
  }

  frameNow() {
    const { duration, time } = this.clock;
    if (!this.span.near || duration <= NEAR) return { from: 0, to: duration || 1 };
    const from = Math.min(Math.max(NEAR * Math.floor(time / NEAR), 0), duration - NEAR);
    return { from, to: from + NEAR };
  }

  xOf(t) {
    const { from, to } = this.frame;
    return EDGE.left + (t - from) / (to - from) * (this.width - EDGE.left - EDGE.right);
  }

  yOf(value) {
    const [low, high] = this.range;
    return this.height - EDGE.bottom - (value - low) / (high - low) * (this.height - EDGE.top - EDGE.bottom);
  }

  timeAt(x) {
    const { from, to } = this.frame;
    return from + (x - EDGE.left) / (this.width - EDGE.left - EDGE.right) * (to - from);
  }

  findRange() {
    let low = Infinity, high = -Infinity;
    const { from, to } = this.frame;
    for (const { times, values } of this.lines) {
      for (let i = 0; i < times.length; i++) {
        if (times[i] < from - 0.5 || times[i] > to + 0.5) continue; // out of sight
        if (values[i] < low) low = values[i];
        if (values[i] > high) high = values[i];
      }
    }
    if (low > high) return [-1, 1];
    const reach = high - low || Math.abs(high) || 1;
    for (const limit of this.limits) { // limits far away would flatten the lines
      if (limit.value > low - 1.2 * reach && limit.value < high + 1.2 * reach) {
        low = Math.min(low, limit.value);
        high = Math.max(high, limit.value);
      }
    }
    const margin = 0.06 * (high - low || Math.abs(high) || 1);
    return [low - margin, high + margin];
  }

  draw(pen) {
    this.range = this.findRange();
    const right = this.width - EDGE.right;
    this.shade(pen);
    this.axes(pen, ticks(this.frame.from, this.frame.to, this.width / 90), ticks(...this.range, 4), "t [s]");
    pen.save();
    pen.beginPath();
    pen.rect(EDGE.left, EDGE.top, right - EDGE.left, this.height - EDGE.top - EDGE.bottom);
    pen.clip();
    for (const limit of this.limits) {
      pen.strokeStyle = colourOf("bad");
      pen.setLineDash([6, 4]);
      pen.beginPath();
      pen.moveTo(EDGE.left, this.yOf(limit.value));
      pen.lineTo(right, this.yOf(limit.value));
      pen.stroke();
    }
    for (const line of this.lines) this.drawLine(pen, line);
    pen.restore();
  }

  /** Backgrounds of single supports, in the colours of the sides. */
  shade(pen) {
    if (!this.support) return;
    const { times, values } = this.support, bottom = this.height - EDGE.bottom;
    pen.globalAlpha = 0.13;
    let start = 0;
    for (let i = 1; i <= values.length; i++) {
      if (i < values.length && values[i] === values[start]) continue;
      const end = times[Math.min(i, values.length - 1)];
      if (values[start] && end >= this.frame.from && times[start] <= this.frame.to) {
        const x0 = this.xOf(Math.max(times[start], this.frame.from));
        const x1 = this.xOf(Math.min(end, this.frame.to));
        pen.fillStyle = colourOf(values[start] === 1 ? "left" : "right");
        pen.fillRect(x0, EDGE.top, x1 - x0, bottom - EDGE.top);
      }
      start = i;
    }
    pen.globalAlpha = 1;
  }

  drawLine(pen, { times, values, colour, dashed }) {
    pen.strokeStyle = colourOf(colour);
    pen.lineWidth = dashed ? 1.3 : 1.8;
    pen.setLineDash(dashed ? [4, 3] : []);
    pen.beginPath();
    let at = null, low = 0, high = 0, drawing = false;
    const flush = () => { // one stroke per column of pixels, from the least to the largest value
      if (at === null) return;
      if (drawing) pen.lineTo(at, this.yOf(low)); else pen.moveTo(at, this.yOf(low));
      if (high !== low) pen.lineTo(at, this.yOf(high));
      drawing = true;
    };
    for (let i = 0; i < times.length; i++) {
      if (times[i] < this.frame.from - 1 || times[i] > this.frame.to + 1) continue;
      const value = values[i];
      if (Number.isNaN(value)) {
        flush();
        at = null;
        drawing = false;
        continue;
      }
      const x = this.xOf(times[i]);
      if (at !== null && x - at < 0.7) {
        low = Math.min(low, value);
        high = Math.max(high, value);
      } else {
        flush();
        [at, low, high] = [x, value, value];
      }
    }
    flush();
    pen.stroke();
    pen.setLineDash([]);
  }

  drawCursor(pen) {
    const { time } = this.clock, x = this.xOf(time);
    if (x < EDGE.left - 1 || x > this.width - EDGE.right + 1) return;
    pen.strokeStyle = colourOf("ink");
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(x, EDGE.top);
    pen.lineTo(x, this.height - EDGE.bottom);
    pen.stroke();
    let place = this.width - EDGE.right;
    pen.textAlign = "right";
    pen.textBaseline = "top";
    for (const line of [...this.lines].reverse()) {
      const where = locate({ values: line.times, rows: line.times.length }, time);
      const [value] = between({ values: line.values, columns: 1 }, where);
      const text = `${line.name} ${figure(Number(value.toPrecision(3)))}`;
      pen.fillStyle = colourOf(line.colour);
      if (place > pen.measureText(this.title).width + 40) pen.fillText(text, place, 5);
      place -= pen.measureText(text).width + 10;
      if (Number.isNaN(value)) continue;
      pen.beginPath();
      pen.arc(x, this.yOf(value), 3.5, 0, 7);
      pen.fill();
    }
  }
}
