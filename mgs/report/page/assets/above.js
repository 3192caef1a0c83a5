// The motion from above: footsteps, boxes, balls, CoM and ZMP; a click goes to the nearest time.
"use strict";

class AbovePlot extends Plot {
  constructor(clock, span, motion) {
    super("From above [m]", clock);
    Object.assign(this, { span, motion, arrays: motion.decoded });
    this.bounds = this.findBounds();
  }

  findBounds() {
    const xs = [], ys = [];
    const add = (points) => points.forEach(([x, y]) => { xs.push(x); ys.push(y); });
    const { footsteps, soles, boxes, balls } = this.motion.ground;
    balls.forEach(([x, y, r]) => add([[x - r, y - r], [x + r, y + r]]));
    footsteps.forEach(([side, x, y, , yaw]) => add(rectangle(x, y, yaw, ...soles[side])));
    boxes.forEach(([x, y, yaw, length, width]) => add(rectangle(x, y, yaw, length, width)));
    const { com } = this.arrays;
    for (let i = 0; i < com.rows; i++) { xs.push(com.values[3 * i]); ys.push(com.values[3 * i + 1]); }
    const least = (values) => values.reduce((a, b) => Math.min(a, b));
    const most = (values) => values.reduce((a, b) => Math.max(a, b));
    return { x: [least(xs), most(xs)], y: [least(ys), most(ys)] };
  }

  frameNow() {
    const { x, y } = this.bounds, width = this.width - EDGE.left - EDGE.right;
    const height = this.height - EDGE.top - EDGE.bottom, reach = 8 * this.motion.height;
    const scale = Math.min(width / (1.08 * (x[1] - x[0]) || 1), height / (1.12 * (y[1] - y[0]) || 1));
    if (!this.span.near || x[1] - x[0] + y[1] - y[0] < reach) {
      return { scale, x: 0.5 * (x[0] + x[1]), y: 0.5 * (y[0] + y[1]) };
    }
    const [cx, cy] = between(this.arrays.com, locate(this.arrays.t, this.clock.time));
    const snap = 0.5 * reach; // a moving frame would be drawn anew at every instant
    return { scale: width / reach, x: snap * Math.round(cx / snap), y: snap * Math.round(cy / snap) };
  }

  xOf(x) {
    return 0.5 * (EDGE.left + this.width - EDGE.right) + this.frame.scale * (x - this.frame.x);
  }

  yOf(y) {
    return 0.5 * (EDGE.top + this.height - EDGE.bottom) - this.frame.scale * (y - this.frame.y);
  }

  timeAt(px, py) {
    const { com, t } = this.arrays;
    let best = null, least = Infinity;
    for (let i = 0; i < com.rows; i++) {
      const dx = this.xOf(com.values[3 * i]) - px, dy = this.yOf(com.values[3 * i + 1]) - py;
      const far = dx * dx + dy * dy + 1e-3 * Math.abs(t.values[i] - this.clock.time);
      if (far < least) [best, least] = [t.values[i], far];
    }
    return best;
  }

  outline(pen, corners) {
    pen.beginPath();
    corners.forEach(([x, y], i) => pen[i ? "lineTo" : "moveTo"](this.xOf(x), this.yOf(y)));
    pen.closePath();
  }

  draw(pen) {
    const halfX = 0.5 * (this.width - EDGE.left - EDGE.right) / this.frame.scale;
    const halfY = 0.5 * (this.height - EDGE.top - EDGE.bottom) / this.frame.scale;
    this.axes(pen, ticks(this.frame.x - halfX, this.frame.x + halfX, this.width / 90),
      ticks(this.frame.y - halfY, this.frame.y + halfY, 4), "x");
    pen.save();
    pen.beginPath();
    pen.rect(EDGE.left, EDGE.top, this.width - EDGE.left - EDGE.right, this.height - EDGE.top - EDGE.bottom);
    pen.clip();
    const { footsteps, soles, boxes, balls } = this.motion.ground;
    pen.lineWidth = 1;
    for (const [x, y, yaw, length, width] of boxes) {
      this.outline(pen, rectangle(x, y, yaw, length, width));
      pen.fillStyle = colourOf("box");
      pen.strokeStyle = colourOf("faint");
      pen.fill();
      pen.stroke();
    }
    for (const [side, x, y, , yaw] of footsteps) {
      this.outline(pen, rectangle(x, y, yaw, ...soles[side]));
      pen.strokeStyle = pen.fillStyle = colourOf(side === 0 ? "left" : "right");
      pen.globalAlpha = 0.15;
      pen.fill();
      pen.globalAlpha = 1;
      pen.stroke();
    }
    for (const [x, y, radius] of balls) {
      pen.beginPath();
      pen.arc(this.xOf(x), this.yOf(y), this.frame.scale * radius, 0, 7);
      pen.fillStyle = colourOf("ghost");
      pen.fill();
    }
    this.path(pen, this.arrays.com, "com", 2.4);
    if (this.arrays.zmp_ref) this.path(pen, this.arrays.zmp_ref, "ref", 1, [4, 3]);
    if (this.arrays.zmp) this.path(pen, this.arrays.zmp, "zmp", 1.5);
    pen.restore();
  }

  path(pen, array, colour, width, dash = []) {
    pen.strokeStyle = colourOf(colour);
    pen.lineWidth = width;
    pen.setLineDash(dash);
    pen.beginPath();
    let last = [Infinity, Infinity];
    for (let i = 0; i < array.rows; i++) {
      const x = this.xOf(array.values[array.columns * i]), y = this.yOf(array.values[array.columns * i + 1]);
      if (i && Math.abs(x - last[0]) + Math.abs(y - last[1]) < 0.7 && i < array.rows - 1) continue;
      pen[i ? "lineTo" : "moveTo"](x, y);
      last = [x, y];
    }
    pen.stroke();
    pen.setLineDash([]);
  }

  drawCursor(pen) {
    const where = locate(this.arrays.t, this.clock.time);
    for (const [name, label] of [["com", "CoM"], ["zmp", "ZMP"]]) {
      if (!this.arrays[name]) continue;
      const [x, y] = between(this.arrays[name], where);
      pen.fillStyle = colourOf(name);
      pen.strokeStyle = colourOf("paper");
      pen.beginPath();
      pen.arc(this.xOf(x), this.yOf(y), 5, 0, 7);
      pen.fill();
      pen.stroke();
      pen.textAlign = "right";
      pen.textBaseline = "top";
      pen.fillText(label, this.width - EDGE.right - (name === "com" ? 40 : 0), 5);
    }
  }
}
