// What the board said of itself over the last ten seconds: a lane for each thing, coloured as its word is.

import { COLUMNS } from "./history.js";
import { Paper, colour } from "./paper.js";
import * as flag from "./samples.js";

/** Room for the names. */
const NAMES = 58;
/** How thick a bar is in pixels, and one that says no. */
const [THICK, THIN] = [7, 1.5];

const [NO, GOOD, WARN, BAD] = ["--faint", "--good", "--warn", "--bad"];
const COMPASS = [NO, NO, GOOD, WARN];

/** From top to bottom: the name, and the colour of these flags. */
const LANES = [
  ["bias", (flags) => (flags & flag.BIAS_MEASURED ? GOOD : WARN)],
  ["at rest", (flags) => (flags & flag.STILL ? GOOD : NO)],
  ["compass", (flags) => COMPASS[(flags >> flag.COMPASS_SHIFT) & 3]],
  ["clipped", (flags) => (flags & flag.CLIPPED ? BAD : NO)],
];

export class Lanes {
  constructor(canvas) {
    this.paper = new Paper(canvas, NAMES);
    this.restyle();
  }

  restyle() {
    this.paper.restyle();
    this.colours = new Map([NO, GOOD, WARN, BAD].map((name) => [name, colour(name)]));
  }

  draw(history) {
    const { paper } = this;
    if (!paper.begin()) return;
    const height = (paper.base - paper.top) / LANES.length;
    const middle = (lane) => paper.top + (lane + 0.5) * height;
    paper.ruled(LANES.map(([name], lane) => [middle(lane), name]));
    LANES.forEach(([, mood], lane) => this.drawLane(history, mood, Math.round(middle(lane))));
  }

  /** A bar for as long as it stays what it is. What no sample tells is as it was. */
  drawLane(history, mood, y) {
    let [from, shown, flags] = [0, null, 0];
    const end = (to) => {
      if (shown !== null) this.bar(from, to, y, shown);
    };
    for (let i = 0; i < COLUMNS; i += 1) {
      const column = history.column - COLUMNS + 1 + i;
      const at = ((column % COLUMNS) + COLUMNS) % COLUMNS;
      if (column < 0 || history.broken[at]) flags = 0;
      if (column >= 0) flags = history.flags[at] || flags;
      const next = flags & flag.STATUS_KNOWN ? mood(flags) : null;
      if (next === shown) continue;
      end(i);
      [from, shown] = [i, next];
    }
    end(COLUMNS - 1);
  }

  bar(from, to, y, shown) {
    const { paper } = this;
    const thick = shown === NO ? THIN : THICK;
    const [left, right] = [paper.place(from), paper.place(to)];
    paper.pen.fillStyle = this.colours.get(shown);
    paper.pen.fillRect(left, y - thick / 2, Math.max(right - left, 1), thick);
  }
}
