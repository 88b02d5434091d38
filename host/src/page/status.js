// What is going on, in words. Numbers are written a few times a second, and only where they differ.

import * as flag from "./samples.js";
import { isInHand } from "./hand.js";
import { apart, tiltApart } from "./view.js";

const COMPASS = [
  ["none", "quiet", "Nothing comes from the magnetometer: heading by gyro"],
  ["not followed", "quiet", "Not calibrated, switched off, or not for this estimator: heading by gyro"],
  ["heading followed", "good", "The heading does not drift"],
  ["disturbed", "warn", "Something magnetic is near: the gyro keeps the heading"],
];
/** Clipping is shown for so long after it was, in milliseconds. */
const LINGERS = 1500;

const byId = (id) => document.getElementById(id);

/** Text and mood of an element, touched only if they change. */
export function write(id, text, mood) {
  const element = byId(id);
  if (element.textContent !== text) element.textContent = text;
  if (mood !== undefined && element.dataset.mood !== mood) element.dataset.mood = mood;
}

export function number(value, decimals) {
  if (!Number.isFinite(value)) return "–";
  // Zero has no sign, and a minus is as wide as a digit.
  return (Math.round(value * 10 ** decimals) / 10 ** decimals + 0).toFixed(decimals).replace("-", "−");
}

export class Words {
  constructor() {
    this.clippedAt = -Infinity;
    this.off = null;
  }

  /** Of every sample: what would be over before it was read. */
  take(flags) {
    if (flags & flag.CLIPPED) this.clippedAt = performance.now();
  }

  /** How far the board is off the emulated sensor, whose truth comes before the sample of its moment. */
  compare(samples, { t, q }) {
    const estimate = samples.at(t);
    if (estimate) this.off = { all: apart(estimate, q), tilt: tiltApart(estimate, q) };
  }

  /** The numbers of now. */
  show(samples, history, status) {
    const flowing = status.state === "connected" && samples.count > 0;
    ["yaw", "pitch", "roll"].forEach((name, i) => {
      write(name, samples.count ? number(history.angles[i], 1) : "–");
    });
    write("rate", flowing ? number(history.hertz, history.hertz < 20 ? 1 : 0) : "–");
    const late = status.latency_ms;
    write("latency", flowing && late ? `${number(late.p50, 2)} / ${number(late.p99, 2)}` : "–");
    const missing = Math.max(status.gaps ?? 0, history.lost);
    write("losses-now", number(missing, 0), missing > 0 ? "warn" : "");
    this.flags(samples.latest.flags, flowing);
    this.losses(status, missing);
    const shown = this.off && status.kind === "emulated";
    byId("truth-row").hidden = !shown;
    if (shown) {
      const { all, tilt } = this.off;
      write("truth", `${number(all, 1)}°, tilt ${number(tilt, 1)}°`, tilt < 2 ? "good" : "warn");
    }
  }

  flags(flags, flowing) {
    const known = flowing && (flags & flag.STATUS_KNOWN) !== 0;
    const say = (id, text, mood) => write(id, known ? text : "not said", known ? mood : "quiet");
    const [compass, mood, why] = COMPASS[(flags >> flag.COMPASS_SHIFT) & 3];
    say("compass", compass, mood);
    byId("compass").title = known ? why : "Lines of text do not say; :stream binary does";
    const measured = (flags & flag.BIAS_MEASURED) !== 0;
    say("bias", measured ? "measured at rest" : "a guess: keep the board still", measured ? "good" : "warn");
    say("motion", flags & flag.STILL ? "at rest" : "moving", flags & flag.STILL ? "good" : "");
    const clipped = performance.now() - this.clippedAt < LINGERS;
    say("clipping", clipped ? "at the end of its range" : "within its range", clipped ? "bad" : "good");
  }

  /** What can be done with the picture. */
  hint(status, mode, count) {
    const board = mode === "board";
    if (count === 0 && status.state === "connected") {
      write("hint", "the board measures its gyro's bias: keep it still");
    } else if (isInHand(status)) {
      write("hint", board ? "drag to turn the board · shift and drag to go round it" : "drag to turn the head");
    } else write("hint", board ? "drag to go round it · scroll to go nearer" : "");
  }

  losses(status, missing) {
    const parts = [];
    const add = (count, what) => count > 0 && parts.push(`${count} ${what}`);
    add(missing, "missing");
    add(status.crc_errors, "with a wrong checksum");
    add(status.malformed, "malformed");
    add(status.thrown_away, "bytes thrown away");
    add(status.dropped, "too fast for this page");
    add(status.restarts, status.restarts === 1 ? "restart" : "restarts");
    write("losses", parts.join(", ") || "nothing", parts.length ? "warn" : "good");
  }
}
