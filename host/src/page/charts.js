// Strip charts: the last ten seconds, drawn from the columns of history.js.

import { COLUMNS } from "./history.js";
import { Paper, colour } from "./paper.js";

const NICE = [1, 1.2, 1.6, 2, 3, 4, 6, 8];
/** Room for the numbers of the scale. */
const SCALE = 34;

/** The nice number at or above a value, whose half is nice too. */
function nice(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return (NICE.find((step) => step * power >= value) ?? 10) * power;
}

export class Chart {
  /**
   * `lines` are `{ track, colour }`, the colour the name of a CSS variable; `least` is how much the
   * scale shows at any rate; `signed` puts zero in the middle, `bars` draws from zero upwards.
   */
  constructor(canvas, lines, { least, most = Infinity, signed = false, bars = false }) {
    Object.assign(this, { lines, least, most, signed, bars });
    this.paper = new Paper(canvas, SCALE);
    this.restyle();
  }

  restyle() {
    this.paper.restyle();
    this.colours = this.lines.map((line) => colour(line.colour));
  }

  draw(history) {
    const { paper } = this;
    if (!paper.begin()) return;
    const top = this.range();
    this.unit = (paper.base - paper.top) / (this.signed ? 2 * top : top);
    this.zero = this.signed ? (paper.base + paper.top) / 2 : paper.base;
    const values = this.signed ? [-top, 0, top] : [0, top / 2, top];
    paper.ruled(values.map((value) => [this.zero - value * this.unit, label(value)]));
    for (let i = 0; i < this.lines.length; i += 1) this.drawLine(history, this.lines[i].track, this.colours[i]);
  }

  /** What the scale goes up to. */
  range() {
    let largest = 0;
    for (let i = 0; i < this.lines.length; i += 1) {
      const { least, most } = this.lines[i].track;
      for (let at = 0; at < COLUMNS; at += 1) {
        if (most[at] > largest) largest = most[at];
        if (-least[at] > largest) largest = -least[at];
      }
    }
    if (this.signed) {
      for (const step of [15, 30, 45, 90]) if (largest <= step) return step;
      return this.most;
    }
    return Math.min(this.most, nice(Math.max(1.05 * largest, this.least)));
  }

  drawLine(history, { least, most }, colour) {
    const { paper } = this;
    const { pen } = paper;
    const step = paper.place(1) - paper.place(0);
    pen.strokeStyle = colour;
    pen.lineWidth = this.bars ? Math.max(step, 1.5) : 1.4;
    pen.lineJoin = "round";
    pen.beginPath();
    let [down, before] = [false, 0];
    for (let i = 0; i < COLUMNS; i += 1) {
      const column = history.column - COLUMNS + 1 + i;
      if (column < 0) continue;
      const at = column % COLUMNS;
      if (history.broken[at]) down = false;
      const [low, high] = [least[at], most[at]];
      if (!(low <= high)) continue;
      const x = paper.place(i);
      if (this.bars) {
        if (high <= 0) continue;
        pen.moveTo(x, this.zero);
        pen.lineTo(x, this.zero - Math.max(high * this.unit, 2));
        continue;
      }
      // From 180° to −180° is no way at all.
      if (this.signed && (high - low > 180 || Math.abs(high - before) > 180)) down = false;
      before = high;
      if (this.signed && high - low > 180) continue;
      const [from, to] = [this.zero - low * this.unit, this.zero - high * this.unit];
      if (down) pen.lineTo(x, from);
      else pen.moveTo(x, from);
      // A column of one value is still a dot where the line begins.
      pen.lineTo(x, to === from ? to + 0.01 : to);
      down = true;
    }
    pen.stroke();
  }
}

function label(value) {
  if (value >= 10000) return `${value / 1000}k`;
  return String(Number(value.toPrecision(3))).replace("-", "−");
}
