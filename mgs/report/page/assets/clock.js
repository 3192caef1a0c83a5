// The one clock of a page: play, pause, scrub, speed, keyboard.
"use strict";

class Clock {
  constructor(duration) {
    this.duration = duration;
    this.time = 0;
    this.speed = 1;
    this.playing = false;
    this.listeners = [];
    this.last = null;
  }

  onChange(listener) {
    this.listeners.push(listener);
  }

  tell() {
    for (const listener of this.listeners) listener(this);
  }

  set(time) {
    this.time = Math.min(Math.max(time, 0), this.duration);
    this.tell();
  }

  pause() {
    this.playing = false;
    this.last = null;
    this.tell();
  }

  play() {
    if (this.time >= this.duration) this.time = 0;
    this.playing = true;
    this.last = null;
    this.tell();
    requestAnimationFrame((now) => this.advance(now));
  }

  toggle() {
    if (this.playing) this.pause(); else this.play();
  }

  advance(now) {
    if (!this.playing) return;
    if (this.last !== null) this.time += this.speed * (now - this.last) / 1000;
    this.last = now;
    if (this.time >= this.duration) {
      this.time = this.duration;
      this.playing = false;
    }
    this.tell();
    if (this.playing) requestAnimationFrame((next) => this.advance(next));
  }
}

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 10];

/** Bar at the bottom of the page. */
function transport(clock) {
  const play = make("button", { class: "play", onclick: () => clock.toggle() }, "Play");
  const range = make("input", {
    type: "range", min: 0, max: clock.duration, step: "any", value: 0, "aria-label": "Time [s]",
    oninput: () => clock.set(Number(range.value)),
  });
  const time = make("span", { class: "time" });
  const speed = make("select", {
    "aria-label": "Speed", title: "Speed ([ and ])",
    onchange: () => { clock.speed = Number(speed.value); clock.tell(); },
  }, ...SPEEDS.map((value) => make("option", { value }, `${value}×`)));
  clock.onChange(() => {
    play.textContent = clock.playing ? "Pause" : "Play";
    range.value = clock.time;
    speed.value = String(clock.speed);
    time.textContent = `${clock.time.toFixed(2)} / ${clock.duration.toFixed(2)} s`;
  });
  return make("div", { class: "transport", role: "group", "aria-label": "Playback" },
    play, range, time, speed);
}

/** Keys of the whole page; those of form elements stay theirs. */
function bindKeys(clock, views) {
  const step = (sign, large) => clock.set(clock.time + sign * (large ? 1 : 0.05));
  const faster = (sign) => {
    const at = SPEEDS.indexOf(clock.speed) + sign;
    clock.speed = SPEEDS[Math.min(Math.max(at, 0), SPEEDS.length - 1)];
    clock.tell();
  };
  const keys = {
    " ": () => clock.toggle(),
    ArrowLeft: (event) => step(-1, event.shiftKey),
    ArrowRight: (event) => step(1, event.shiftKey),
    Home: () => clock.set(0),
    End: () => clock.set(clock.duration),
    "[": () => faster(-1),
    "]": () => faster(1),
    f: () => views.forEach((view) => view.setFollow(!view.follow)),
  };
  Object.keys(CAMERAS).forEach((name, i) => {
    keys[String(i + 1)] = () => views.forEach((view) => view.look(name));
  });
  document.addEventListener("keydown", (event) => {
    const busy = /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName);
    const pressed = event.target.tagName === "BUTTON" && event.key === " ";
    const action = keys[event.key];
    if (!action || busy || pressed || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    action(event);
  });
}

const KEYS_TEXT = "Space: play or pause. Left, right: 0.05 s, with Shift 1 s. Home, End: start, end. " +
  "[ and ]: slower, faster. 1 to 4: camera. F: follow the robot.";
