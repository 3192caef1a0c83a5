// Panels of a motion: 3D view with its tools, verdict, plots, joints, origin.
"use strict";

const PART_COLOURS = {
  CoM: "com", ZMP: "zmp", "Contact force": "force", "Support polygon": "zmp", Footsteps: "left",
  Balls: "ghost", Boxes: "faint", Paths: "ref", Robot: "ink",
};

/** The 3D view, or a message where the browser has no WebGL. */
function stagePanel(motion, clock, views) {
  const panel = make("div", { class: "panel stage" });
  let view;
  try {
    view = new View(motion);
  } catch (error) {
    panel.append(make("p", { class: "message" },
      `No 3D view: this browser offers no WebGL (${error.message}). Verdict and plots work without.`));
    return panel;
  }
  views.push(view);
  const readout = make("div", { class: "readout" });
  clock.onChange(() => {
    view.setTime(clock.time);
    readout.textContent = readoutText(motion, clock.time);
    readout.hidden = !readout.textContent;
  });
  panel.append(view.canvas, readout, cameraTools(view, views), partTools(view));
  return panel;
}

function readoutText(motion, t) {
  const parts = [];
  if (motion.decoded.zmp) {
    const support = ["both soles", "left sole", "right sole"];
    parts.push(support[motion.decoded.support.values[locate(motion.decoded.t, t)[0]]]);
  }
  if (t > motion.duration) parts.push("after the end of the motion");
  for (const replay of motion.replays) {
    const [tilt] = between(replay.decoded.tilt, locate(replay.decoded.t, t));
    parts.push(`${replay.engine}: tilt ${tilt.toFixed(1)}°`);
  }
  return parts.join(" · ");
}

function cameraTools(view, views) {
  const buttons = Object.keys(CAMERAS).map((name, i) => make("button", {
    title: `Camera (${i + 1})`, onclick: () => view.look(name),
  }, name));
  const follow = make("button", { "aria-pressed": "true", title: "Camera goes with the robot (F)",
    onclick: () => view.setFollow(!view.follow) }, "Follow");
  view.onFollow = (on) => follow.setAttribute("aria-pressed", String(on));
  const tools = make("div", { class: "tools", role: "group", "aria-label": "Camera" }, ...buttons, follow);
  view.controls.addEventListener("change", () => { // side by side, all cameras move together
    if (views.length < 2 || View.copying) return;
    View.copying = true;
    views.forEach((other) => { if (other !== view) other.copyCamera(view); });
    View.copying = false;
  });
  return tools;
}

/** One check box for each kind of part that the scene has. */
function partTools(view) {
  const names = [...new Set(view.parts.map((part) => part.name))]
    .filter((name) => !["light", "ground"].includes(name));
  const boxes = names.map((name) => {
    const replay = view.motion.replays.find((each) => each.engine === name);
    const colour = replay ? replay.colour : PART_COLOURS[name];
    const box = make("input", { type: "checkbox", onchange: () => view.show(name, box.checked) });
    box.checked = name !== "Paths" || view.motion.ground.footsteps.length < 200;
    if (!box.checked) view.show(name, false);
    const text = replay ? `Replay in ${name}` : name;
    return make("label", {}, box, make("span", { class: "dot", "data-colour": colour }), text);
  });
  return make("div", { class: "tools", role: "group", "aria-label": "Shown parts" }, ...boxes);
}

/** Every check with value, limit and worst moment; a click goes there. */
function verdictPanel(motion, clock, joints) {
  const { verdict } = motion;
  const head = ["", "Check", "Worst at", "Value", "Limit", "Unit", "Where"];
  const rows = verdict.checks.map((check) => {
    const go = check.time === null ? null : make("button", {
      "data-check": check.name, title: "Go to this time",
      onclick: () => {
        clock.pause();
        clock.set(check.time);
        if (joints) joints.choose(check.where);
      },
    }, `${check.time.toFixed(2)} s`);
    return make("tr", { class: check.ok ? "" : "fail" },
      make("td", {}, make("span", { class: "mark" }, check.ok ? "✓" : "✗")),
      make("td", {}, check.name.replaceAll("_", " ")),
      make("td", {}, ...(go ? [go] : [])),
      make("td", { class: "number" }, figure(check.value)),
      make("td", { class: "number" }, figure(check.limit)),
      make("td", {}, check.unit), make("td", {}, check.where.replaceAll("_", " ")));
  });
  const failed = verdict.checks.filter((check) => !check.ok);
  const words = failed.length
    ? `${failed.length} of ${verdict.checks.length} checks fail: ${failed.map((c) => c.name).join(", ")}`
    : `all ${verdict.checks.length} checks pass`;
  const physics = verdict.engines.length
    ? motion.replays.map((replay) => `${replay.name}: ${replay.fate}`).join("; ")
    : "No replay in physics: falling was not checked.";
  return make("section", { class: "panel verdict" }, make("h2", {}, "Verdict"),
    make("p", {}, badge(verdict.passed), ` ${words}`), make("p", { class: "faint" }, physics),
    ...motion.notes.map((note) => make("p", { class: "faint" }, `Note: ${note}.`)),
    make("div", { class: "scroll" }, make("table", {},
      make("thead", {}, make("tr", {}, ...head.map((text) => make("th", {}, text)))),
      make("tbody", {}, ...rows))));
}

function badge(passed) {
  return make("span", { class: `badge${passed ? "" : " fail"}` }, passed ? "PASS" : "FAIL");
}

function line(arrays, name, index, colour, label, scale = 1, dashed = false) {
  const values = column(arrays[name], index);
  if (scale !== 1) for (let i = 0; i < values.length; i++) values[i] *= scale;
  return { times: arrays.t.values, values, colour, name: label, dashed };
}

/** Plots of the whole motion. */
function motionPlots(motion, clock, span) {
  const arrays = motion.decoded;
  const support = { times: arrays.t.values, values: arrays.support.values };
  const plots = [new AbovePlot(clock, span, motion)];
  if (arrays.margin) {
    plots.push(new TimePlot("ZMP margin [mm]", clock, span,
      [line(arrays, "margin", 0, "zmp", "", 1e3)], [{ value: 0 }], support));
    ["x", "y"].forEach((axis, i) => plots.push(new TimePlot(`${axis} [m]`, clock, span, [
      line(arrays, "com", i, "com", "CoM"), line(arrays, "zmp", i, "zmp", "ZMP"),
      line(arrays, "zmp_ref", i, "ref", "plan", 1, true),
    ], [], support)));
  }
  for (const [name, title] of [["power", "Power of the joints [W]"], ["energy", "Energy given by the joints [J]"]]) {
    if (!arrays[name]) continue;
    plots.push(new TimePlot(title, clock, span, [line(arrays, name, 0, "accent", "")], [], support));
  }
  const tilts = motion.replays.map((replay) =>
    line(replay.decoded, "tilt", 0, replay.colour, replay.engine));
  if (tilts.length) plots.push(new TimePlot("Tilt [deg]", clock, span, tilts, [], support));
  return plots;
}

const DEG = 180 / Math.PI;

/** Angle, speed and torque of one joint against its limits; one click for each joint. */
class JointPanel {
  constructor(motion, clock, span) {
    this.motion = motion;
    this.joints = motion.tree.joints;
    const plot = () => new TimePlot("", clock, span, [], [], {
      times: motion.decoded.t.values, values: motion.decoded.support.values,
    });
    this.plots = [plot(), plot(), plot()];
    this.buttons = this.joints.map((joint, i) => make("button", {
      "aria-pressed": "false", onclick: () => this.select(i),
    }, joint.name.replaceAll("_", " ")));
    this.heading = make("h2");
    this.element = make("section", { class: "panel" }, this.heading,
      make("div", { class: "chips", role: "group", "aria-label": "Joint" }, ...this.buttons),
      make("div", { class: "plots" }, ...this.plots.map((each) => each.element)));
    this.select(this.nearestToLimit());
  }

  nearestToLimit() {
    const { q } = this.motion.decoded;
    let best = 0, least = Infinity;
    for (let i = 0; i < q.values.length; i++) {
      const joint = this.joints[i % q.columns];
      const margin = Math.min(q.values[i] - joint.lower, joint.upper - q.values[i]);
      if (margin < least) [best, least] = [i % q.columns, margin];
    }
    return best;
  }

  choose(name) {
    const index = this.joints.findIndex((joint) => joint.name === name);
    if (index >= 0) this.select(index);
  }

  select(index) {
    const joint = this.joints[index], { decoded, replays } = this.motion;
    this.buttons.forEach((button, i) => button.setAttribute("aria-pressed", String(i === index)));
    const lines = (name, scale) => [
      ...(decoded[name] ? [line(decoded, name, index, "accent", replays.length ? "plan" : "", scale)] : []),
      ...replays.filter((replay) => replay.decoded[name]).map((replay) =>
        line(replay.decoded, name, index, replay.colour, replay.engine, scale, true)),
    ];
    const both = (limit) => [{ value: limit }, { value: -limit }];
    const name = joint.name.replaceAll("_", " ");
    const range = (low, high) => `limits ${figure(low)} to ${figure(high)}`;
    const [low, high, speed] = [joint.lower, joint.upper, joint.speed].map((x) => Math.round(10 * DEG * x) / 10);
    this.plots[0].set(`Angle [deg], ${range(low, high)}`, lines("q", DEG),
      [{ value: DEG * joint.lower }, { value: DEG * joint.upper }]);
    this.plots[1].set(`Speed [deg/s], ${range(-speed, speed)}`, lines("v", DEG), both(DEG * joint.speed));
    this.plots[2].element.hidden = !decoded.torque && !replays.length; // it is not known
    this.plots[2].set(`Torque [N m], ${range(-joint.torque, joint.torque)}`, lines("torque", 1), both(joint.torque));
    this.heading.textContent = `Joints against their limits: ${name}`;
  }
}

function originPanel(motion) {
  const rows = motion.facts.flatMap(([label, text]) => [make("dt", {}, label), make("dd", {}, text)]);
  const fold = (title, text) => make("details", {}, make("summary", {}, title), make("pre", {}, text));
  return make("section", { class: "panel" }, make("h2", {}, "Motion and origin"),
    make("dl", {}, ...rows), fold("Gait file with all defaults", motion.gait_yaml),
    fold("Provenance: solver, settings and what they achieved", motion.provenance));
}
