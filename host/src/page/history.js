// What the strip charts show: not samples but columns, each of which keeps the least and the
// greatest value of its fiftieth of a second. So a chart costs the same at any rate, and forgets.

import { angles } from "./view.js";
import { CLIPPED, DEVICE_TIME, RESTART } from "./samples.js";

/** How long a column is, in seconds. */
export const COLUMN = 1 / 50;
/** How many are shown: ten seconds. */
export const COLUMNS = 500;
/** A longer pause is a break in the line, and no longer on the paper than this. */
const PAUSE = 1.5;
/** The rate is counted over so many seconds. */
const COUNTED = 0.25;

/** One line of a chart. */
class Track {
  constructor() {
    this.least = new Float32Array(COLUMNS).fill(NaN);
    this.most = new Float32Array(COLUMNS).fill(NaN);
  }

  take(column, value) {
    const at = column % COLUMNS;
    // Written so that an empty column, which is not a number, takes anything.
    if (!(this.least[at] <= value)) this.least[at] = value;
    if (!(this.most[at] >= value)) this.most[at] = value;
  }

  add(column, value) {
    const at = column % COLUMNS;
    this.most[at] = (this.most[at] || 0) + value;
    this.least[at] = 0;
  }

  clear(column) {
    this.least[column % COLUMNS] = NaN;
    this.most[column % COLUMNS] = NaN;
  }
}

export class History {
  constructor() {
    this.yaw = new Track();
    this.pitch = new Track();
    this.roll = new Track();
    this.rate = new Track();
    this.latency = new Track();
    this.missing = new Track();
    this.tracks = [this.yaw, this.pitch, this.roll, this.rate, this.latency, this.missing];
    /** Set where a line must not be drawn through to the column before. */
    this.broken = new Uint8Array(COLUMNS).fill(1);
    /** Those of the latest sample of a column; clipped is one of which any sample was. */
    this.flags = new Uint16Array(COLUMNS);
    /** Seconds on the paper, and the column they are in. */
    this.time = 0;
    this.column = 0;
    this.angles = new Float64Array(3);
    this.hertz = 0;
    /** Samples that did not come, by their numbers, since the page was opened. */
    this.lost = 0;
    this.before = NaN;
    this.sequence = -1;
    this.counted = 0;
    this.countedSince = 0;
  }

  take(time, w, x, y, z, latency, sequence, flags) {
    this.move(time, flags);
    const column = this.column;
    angles(this.angles, w, x, y, z);
    this.yaw.take(column, this.angles[0]);
    this.pitch.take(column, this.angles[1]);
    this.roll.take(column, this.angles[2]);
    if (latency >= 0) this.latency.take(column, latency);
    const at = column % COLUMNS;
    this.flags[at] = flags | (this.flags[at] & CLIPPED);
    this.count(column);
    this.follow(column, sequence, flags);
  }

  /** The paper goes on by as much as the board's time, or a little where that jumped. */
  move(time, flags) {
    let step = time - this.before;
    const jumped = !(step >= 0 && step < PAUSE) || (flags & RESTART) !== 0;
    if (jumped) step = this.before === this.before ? 0.2 : 0;
    this.before = time;
    this.time += step;
    const column = Math.floor(this.time / COLUMN);
    for (let next = Math.max(this.column + 1, column - COLUMNS + 1); next <= column; next += 1) {
      for (let track = 0; track < this.tracks.length; track += 1) this.tracks[track].clear(next);
      this.broken[next % COLUMNS] = Number(jumped);
      this.flags[next % COLUMNS] = 0;
    }
    this.column = column;
    if (jumped) {
      this.broken[column % COLUMNS] = 1;
      this.counted = 0;
      this.countedSince = this.time;
      this.sequence = -1;
    }
  }

  count(column) {
    const seconds = this.time - this.countedSince;
    this.counted += 1;
    // Slow streams are counted over as long as it takes to see two.
    if (seconds >= COUNTED && this.counted > 1) {
      this.hertz = (this.counted - 1) / seconds;
      this.counted = 1;
      this.countedSince = this.time;
    }
    if (this.hertz > 0) this.rate.take(column, this.hertz);
  }

  follow(column, sequence, flags) {
    if (!(flags & DEVICE_TIME)) {
      this.sequence = -1;
      return;
    }
    const ahead = (sequence - this.sequence) & 0xffff;
    const missing = this.sequence >= 0 && ahead >= 1 && ahead <= 0x7fff ? ahead - 1 : 0;
    this.missing.add(column, missing);
    this.lost += missing;
    this.sequence = sequence;
  }
}
