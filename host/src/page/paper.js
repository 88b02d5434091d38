// What the charts are drawn on: the last ten seconds on a canvas, as sharp as the screen is.

import { COLUMN, COLUMNS } from "./history.js";

const MARGIN = { right: 6, top: 6, bottom: 6 };

/** The value of a CSS variable, as the theme has it now. */
export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export class Paper {
  /** `left` is the room for what stands beside it, in pixels. */
  constructor(canvas, left) {
    Object.assign(this, { canvas, left, top: MARGIN.top });
    this.pen = canvas.getContext("2d");
    this.restyle();
  }

  /** Colours are looked up when the theme changes, not with every picture. */
  restyle() {
    this.rule = colour("--rule");
    this.ink = colour("--faint");
    this.face = `10px ${colour("--text-face")}`;
  }

  /** Blank, as wide and high as it is shown; false if it is not. */
  begin() {
    const { canvas, pen } = this;
    const scale = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (width === 0 || height === 0) return false;
    const [across, down] = [Math.round(width * scale), Math.round(height * scale)];
    if (canvas.width !== across) canvas.width = across;
    if (canvas.height !== down) canvas.height = down;
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, width, height);
    this.span = width - this.left - MARGIN.right;
    this.base = height - MARGIN.bottom;
    return true;
  }

  /** Where a column stands, of those that are shown. */
  place(column) {
    return this.left + (column * this.span) / (COLUMNS - 1);
  }

  /** Lines at these heights, each with its label, and one for every second. */
  ruled(rows) {
    const { pen } = this;
    pen.strokeStyle = this.rule;
    pen.fillStyle = this.ink;
    pen.font = this.face;
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    pen.lineWidth = 1;
    pen.beginPath();
    for (const [height, label] of rows) {
      const y = Math.round(height) + 0.5;
      pen.moveTo(this.left, y);
      pen.lineTo(this.left + this.span, y);
      pen.fillText(label, this.left - 5, y);
    }
    const second = this.span / (COLUMN * COLUMNS);
    for (let x = this.left + this.span; x >= this.left - 1; x -= second) {
      pen.moveTo(Math.round(x) + 0.5, this.top);
      pen.lineTo(Math.round(x) + 0.5, this.base);
    }
    pen.stroke();
  }
}
