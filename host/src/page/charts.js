// Strip charts: the last ten seconds, drawn from the columns of history.js.

import { COLUMN, COLUMNS } from "./history.js";

const NICE = [1, 1.2, 1.6, 2, 3, 4, 6, 8];
const MARGIN = { left: 34, right: 6, top: 6, bottom: 6 };

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
    Object.assign(this, { canvas, lines, least, most, signed, bars });
    this.pen = canvas.getContext("2d");
    this.restyle();
  }

  /** Colours are looked up when the theme changes, not with every picture. */
  restyle() {
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue(name).trim();
    this.colours = this.lines.map((line) => colour(line.colour));
    this.grid = colour("--rule");
    this.ink = colour("--faint");
    this.face = `10px ${colour("--text-face")}`;
  }

  draw(history) {
    const { canvas, pen } = this;
    const scale = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (width === 0 || height === 0) return;
    const [across, down] = [Math.round(width * scale), Math.round(height * scale)];
    if (canvas.width !== across) canvas.width = across;
    if (canvas.height !== down) canvas.height = down;
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, width, height);
    const top = this.range();
    this.left = MARGIN.left;
    this.span = width - MARGIN.left - MARGIN.right;
    this.base = height - MARGIN.bottom;
    this.unit = (this.base - MARGIN.top) / (this.signed ? 2 * top : top);
    this.zero = this.signed ? (this.base + MARGIN.top) / 2 : this.base;
    this.drawGrid(top);
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

  drawGrid(top) {
    const { pen } = this;
    pen.strokeStyle = this.grid;
    pen.fillStyle = this.ink;
    pen.font = this.face;
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    pen.lineWidth = 1;
    pen.beginPath();
    const values = this.signed ? [-top, 0, top] : [0, top / 2, top];
    for (const value of values) {
      const y = Math.round(this.zero - value * this.unit) + 0.5;
      pen.moveTo(this.left, y);
      pen.lineTo(this.left + this.span, y);
      pen.fillText(label(value), this.left - 5, y);
    }
    // A second each.
    const second = (this.span * 1) / (COLUMN * COLUMNS);
    for (let x = this.left + this.span; x >= this.left - 1; x -= second) {
      pen.moveTo(Math.round(x) + 0.5, MARGIN.top);
      pen.lineTo(Math.round(x) + 0.5, this.base);
    }
    pen.stroke();
  }

  drawLine(history, { least, most }, colour) {
    const { pen } = this;
    const step = this.span / (COLUMNS - 1);
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
      const x = this.left + i * step;
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
