// The last samples, in arrays that are as long from the start as they will ever be.

import { unit } from "./view.js";

/** Bits of a sample's flags, of which 0 to 7 are the frame's status (docs/wire-format.md). */
export const CLIPPED = 1 << 1;
export const STILL = 1 << 2;
export const COMPASS_SHIFT = 3;
export const NOTES = 1 << 5;
export const BIAS_MEASURED = 1 << 6;
/** The bits above were said. */
export const STATUS_KNOWN = 1 << 8;
/** Time and sequence number are the device's. */
export const DEVICE_TIME = 1 << 9;
/** The board has started again, or another has come: time starts anew. */
export const RESTART = 1 << 10;

/** Four seconds at a kilohertz, which is what `at` can look back. */
const KEPT = 4096;

export class Samples {
  constructor() {
    this.times = new Float64Array(KEPT);
    this.components = new Float32Array(4 * KEPT);
    /** How many have come since the page was opened. */
    this.count = 0;
    /** How many of these since time started anew. */
    this.since = 0;
    this.latest = { time: NaN, latency: NaN, sequence: 0, flags: 0 };
    this.quaternion = new Float64Array([1, 0, 0, 0]);
  }

  take(time, w, x, y, z, latency, sequence, flags) {
    const at = this.count % KEPT;
    this.times[at] = time;
    this.components[4 * at] = w;
    this.components[4 * at + 1] = x;
    this.components[4 * at + 2] = y;
    this.components[4 * at + 3] = z;
    this.count += 1;
    this.since = flags & RESTART ? 1 : this.since + 1;
    unit(this.quaternion, w, x, y, z); // single precision leaves it a little off
    this.latest.time = time;
    this.latest.latency = latency;
    this.latest.sequence = sequence;
    this.latest.flags = flags;
  }

  /** The orientation at a moment between two samples that are kept, or null. */
  at(time) {
    const kept = Math.min(this.since, KEPT);
    for (let back = 1; back < kept; back += 1) {
      const before = (this.count - back - 1) % KEPT;
      const after = (this.count - back) % KEPT;
      const [t0, t1] = [this.times[before], this.times[after]];
      if (t0 <= time && time <= t1 && t0 < t1) {
        return this.between(before, after, (time - t0) / (t1 - t0));
      }
    }
    return null;
  }

  /** A step is so small that a straight line between two quaternions is as good as an arc. */
  between(before, after, part) {
    const p = this.components.subarray(4 * before, 4 * before + 4);
    const q = this.components.subarray(4 * after, 4 * after + 4);
    const dot = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3];
    const sign = dot < 0 ? -1 : 1;
    const mean = Array.from(p, (value, i) => (1 - part) * value + part * sign * q[i]);
    const length = Math.hypot(...mean);
    return mean.map((value) => value / length);
  }
}
