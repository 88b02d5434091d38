// Names on the board view: of the axes, which turn with the board, and of straight ahead.

import { AXIS_LENGTH } from "./board.js";

const BEYOND = AXIS_LENGTH + 5;
const AXES = { x: [BEYOND, 0, 0], y: [0, BEYOND, 0], z: [0, 0, BEYOND] };
const AHEAD = [0, -78, -172];

export class Labels {
  constructor(layer) {
    this.layer = layer;
    this.names = Object.keys(AXES).map((name) => this.label(name, name));
    this.ahead = this.label("ahead", "ahead");
  }

  label(text, kind) {
    const element = document.createElement("span");
    element.textContent = text;
    element.dataset.axis = kind;
    this.layer.append(element);
    return element;
  }

  draw(picture) {
    const shown = picture.mode === "board" && picture.gl && !picture.lost;
    this.layer.hidden = !shown;
    if (!shown) return;
    for (const element of this.names) place(element, picture.project(AXES[element.dataset.axis], picture.model));
    place(this.ahead, picture.project(AHEAD));
  }
}

function place(element, at) {
  element.hidden = !at;
  if (at) element.style.transform = `translate(-50%, -50%) translate(${at[0].toFixed(1)}px, ${at[1].toFixed(1)}px)`;
}
