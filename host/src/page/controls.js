// What can be set: the board's estimator and its settings, the emulated board, the wearer.

import { write } from "./status.js";

/** A slider that is being moved waits so long before it speaks, in milliseconds. */
const PATIENCE = 150;
/** And is left alone for so long before the board's value moves it. */
const SETTLED = 1500;

const byId = (id) => document.getElementById(id);

/** From a slider's place to the value, and back: evenly spaced by factors, not by differences. */
const SETTINGS = {
  "tilt-time": {
    value: (place) => 10 ** place, place: (value) => Math.log10(value),
    typed: (value) => value.toPrecision(3), shown: (value) => `${Number(value.toPrecision(3))} s`,
  },
  // How much the accelerometer has in a sample, 1 − α, goes by factors.
  "notes-alpha": {
    value: (place) => 1 - 10 ** -place, place: (value) => -Math.log10(Math.max(1 - value, 1e-6)),
    typed: (value) => value.toFixed(6), shown: (value) => String(Number(value.toFixed(6))),
  },
};

/** The sliders and the switch of the estimator. */
export class BoardControls {
  constructor(send) {
    this.send = send;
    this.moved = {};
    this.timers = {};
    for (const name of Object.keys(SETTINGS)) {
      byId(name).addEventListener("input", () => this.move(name));
    }
    for (const radio of document.getElementsByName("estimator")) {
      radio.addEventListener("change", () => this.send(`:estimator ${radio.value}`));
    }
    byId("defaults").addEventListener("click", () => this.defaults());
    byId("bias-again").addEventListener("click", () => this.send("b"));
  }

  move(name) {
    const { value, typed } = SETTINGS[name];
    const wanted = value(Number(byId(name).value));
    this.moved[name] = performance.now();
    this.shown(name, wanted);
    clearTimeout(this.timers[name]);
    this.timers[name] = setTimeout(() => this.send(`:set ${name} ${typed(wanted)}`), PATIENCE);
  }

  /** All of the board's are as after power-on, the stream too, which the page wants otherwise. */
  defaults() {
    this.moved = {};
    this.send(":defaults");
    this.send(":stream binary");
  }

  /** The other of the two estimators. */
  toggle() {
    const notes = byId("estimator-notes").checked;
    this.send(`:estimator ${notes ? "default" : "notes"}`);
  }

  shown(name, value) {
    const text = SETTINGS[name].shown(value);
    write(`${name}-value`, text);
    byId(name).setAttribute("aria-valuetext", text);
  }

  show({ kind, state, estimator, settings = {} }, flags) {
    const there = state === "connected";
    // A recording takes no commands.
    byId("board-controls").disabled = !there || kind === "replay";
    // The samples say it sooner than the board's answer does.
    const now = flags.known ? (flags.notes ? "notes" : "default") : estimator;
    byId("estimator-default").checked = now === "default";
    byId("estimator-notes").checked = now === "notes";
    if (there && now) write("estimator", now === "notes" ? "course notes, eq. 24" : "default", "");
    else write("estimator", "not said", "quiet");
    for (const [name, { place }] of Object.entries(SETTINGS)) {
      const value = settings[name];
      const touched = performance.now() - (this.moved[name] ?? -Infinity) < SETTLED;
      if (!Number.isFinite(value) || touched) continue;
      byId(name).value = place(value);
      this.shown(name, value);
    }
  }

  /** The board's answers are shown where its controls are. */
  answer(line) {
    if (!/^(OK|ERR|error:) /.test(line)) return;
    write("answer", line, line.startsWith("OK") ? "good" : "bad");
  }
}

/** The emulated board: how it moves, and its cable. */
export class EmulatedControls {
  constructor(ask) {
    this.unplugged = false;
    byId("motion-choice").addEventListener("change", ({ target }) => ask({ motion: target.value }));
    byId("cable").addEventListener("click", () => ask({ unplug: !this.unplugged }));
    byId("leave").addEventListener("click", () => ask({ stop: true }));
  }

  show({ kind, state, motions = [], motion }) {
    const emulated = kind === "emulated";
    byId("emulated").hidden = !emulated;
    if (!emulated) return;
    this.unplugged = state === "lost";
    write("cable", this.unplugged ? "Plug it in" : "Pull the cable");
    const choice = byId("motion-choice");
    if (choice.options.length !== motions.length) {
      choice.replaceChildren(...motions.map((name) => new Option(name, name)));
    }
    if (motion && document.activeElement !== choice) choice.value = motion;
  }
}

/** The wearer of the headset: nothing of it goes to the board. */
export class WearerControls {
  constructor(picture, changed) {
    this.picture = picture;
    this.changed = changed;
    byId("ipd").addEventListener("input", ({ target }) => this.ipd(Number(target.value)));
    byId("mounting").addEventListener("change", ({ target }) => this.mounting(target.checked));
    byId("neck").addEventListener("change", ({ target }) => this.neck(target.checked));
  }

  ipd(millimetres) {
    const ipd = Math.min(75, Math.max(50, millimetres));
    this.picture.viewer.ipd = ipd;
    byId("ipd").value = ipd;
    write("ipd-value", `${ipd} mm`);
    this.changed();
  }

  mounting(turnedAround) {
    this.picture.viewer.turnedAround = turnedAround;
    byId("mounting").checked = turnedAround;
    this.changed();
  }

  neck(on) {
    this.picture.neckOn = on;
    byId("neck").checked = on;
    this.changed();
  }
}
