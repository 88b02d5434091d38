// Where the wearer of the headset stands: a round court with something to see wherever the head
// turns, up and down included, near and far, so that two eyes and a neck make a difference. In
// millimetres; the eyes are at (0, 1700, 0) and −z is ahead.

import { Shapes } from "./shapes.js";

export const EYES = [0, 1700, 0];

const COLUMNS = 12;
const RADIUS = 4200;
const WALLS = ["#d9674a", "#e8a54b", "#e3c65b", "#79ad5d", "#3f9c93", "#4586c4",
  "#6a68c9", "#a160b8", "#cf5f92", "#d9674a", "#e8a54b", "#3f9c93"];
const STONE = "#cfc8ba";

/** From straight ahead to the left, in turns, to x and z. */
const around = (turns, radius) => [
  -radius * Math.sin(2 * Math.PI * turns), -radius * Math.cos(2 * Math.PI * turns),
];

export function room() {
  const shapes = new Shapes();
  colonnade(shapes);
  for (let i = 0; i < COLUMNS; i += 1) exhibit(shapes, i);
  table(shapes);
  lanterns(shapes);
  hills(shapes);
  return shapes;
}

function colonnade(shapes) {
  for (let i = 0; i < COLUMNS; i += 1) {
    const [x, z] = around((i + 0.5) / COLUMNS, RADIUS);
    shapes.paint(STONE, 0.1).put(x, 0, z).rod(330, 140, 20);
    shapes.paint(WALLS[i], 0.25).put(x, 140, z).rod(210, 2760, 20, 170);
    shapes.paint(STONE, 0.1).put(x, 2900, z).rod(190, 200, 20, 330);
  }
  shapes.paint("#e2dccf", 0.1).put(0, 3100, 0).ring(RADIUS - 330, RADIUS + 330, 340, 48);
  shapes.paint("#c9674b", 0.1).put(0, 3440, 0).ring(RADIUS - 230, RADIUS + 430, 90, 48);
}

/** Between two columns stands something on a plinth. */
function exhibit(shapes, i) {
  const [x, z] = around(i / COLUMNS, 3100);
  const high = 650 + 220 * (i % 3);
  const turn = (2 * Math.PI * i) / COLUMNS;
  shapes.paint("#b9b2a5", 0.1).put(x, high / 2, z, "y", turn).box(460, high, 460);
  shapes.paint(WALLS[(i + 5) % COLUMNS], 0.7);
  const kind = i % 4;
  if (kind === 0) shapes.put(x, high + 230, z).ball(230, 24);
  else if (kind === 1) shapes.put(x, high + 190, z, "y", turn + 0.6).box(360, 380, 360);
  else if (kind === 2) shapes.put(x, high, z).rod(230, 520, 24, 0);
  else shapes.put(x, high + 40, z).rod(130, 460, 6).put(x, high, z).ring(170, 240, 60, 24);
}

/** Within reach, where the eyes differ most: a small table with bricks. */
function table(shapes) {
  shapes.paint("#8a5a3b", 0.3).put(0, 1120, -900).rod(330, 40, 32);
  shapes.put(0, 0, -900).rod(45, 1120, 12);
  shapes.put(0, 0, -900).rod(220, 30, 24);
  const bricks = [[-150, -860, "#e8574b"], [0, -1000, "#f1b83f"], [150, -850, "#3d8fe0"], [20, -790, "#3fae6a"]];
  bricks.forEach(([x, z, colour], i) => {
    shapes.paint(colour, 0.5).put(x, 1160 + 55, z, "y", i * 0.5).box(110, 110, 110);
  });
  shapes.paint("#f4efe4", 0.8).put(10, 1270 + 45, -800).ball(45, 16);
}

/** Over the head, and a mobile right above it. */
function lanterns(shapes) {
  for (let i = 0; i < 16; i += 1) {
    const [x, z] = around(i / 16 + 0.02, 1500 + 700 * (i % 3));
    const y = 2700 + 420 * (i % 4);
    shapes.paint(["#ffd27a", "#ffb18a", "#ffe9b0"][i % 3], 2).put(x, y, z).ball(85, 12);
    shapes.paint("#5b5348").put(x, y + 80, z).rod(4, 900, 4);
  }
  shapes.paint("#c9674b", 0.3).put(0, 4300, 0).ring(620, 700, 60, 32);
  shapes.paint("#e8a54b", 0.3).put(0, 4200, 0).ring(330, 400, 60, 32);
  shapes.paint("#ffd27a", 2).put(0, 4100, 0).ball(140, 16);
}

/** Far off, so that there is a horizon to hold on to. */
function hills(shapes) {
  for (let i = 0; i < 22; i += 1) {
    const turn = i / 22 + 0.013 * (i % 3);
    const [x, z] = around(turn, 26000 + 6000 * (i % 4));
    const height = 3500 + 1700 * ((i * 7) % 5);
    shapes.paint(["#56806a", "#668f74", "#4c7468"][i % 3]).put(x, -200, z).rod(6500 + 900 * (i % 3), height, 7, 0);
  }
  for (let i = 0; i < 30; i += 1) {
    const [x, z] = around(i / 30 + 0.01 * (i % 2), 8200 + 1700 * (i % 3));
    shapes.paint("#6b4a35").put(x, 0, z).rod(130, 700, 6);
    shapes.paint(["#4f9a5f", "#3f8a5c", "#6cab5c"][i % 3]).put(x, 600, z).rod(900, 2300 + 400 * (i % 4), 8, 0);
  }
}

const WORDS = ["ahead", "left", "behind", "right"];
const SIGN = { width: 512, height: 128 };

/** Signs on the four sides of the ring: which way the head has turned, in words. */
export function signs() {
  const shapes = new Shapes().paint("#ffffff", 0);
  WORDS.forEach((_, i) => {
    const angle = (Math.PI / 2) * i;
    const [s, c] = [Math.sin(angle), Math.cos(angle)];
    // Hung before the ring, which is round and they are flat, facing the middle: its left is where a person's left is.
    const [x, z] = [-s * (RADIUS - 400), -c * (RADIUS - 400)];
    const corner = (side, y) => [x + side * c * 620, y, z - side * s * 620];
    const [top, bottom] = [i / 4, (i + 1) / 4];
    shapes.quad(
      [corner(-1, 3115), corner(1, 3115), corner(1, 3425), corner(-1, 3425)],
      [s, 0, c], [[0, bottom], [1, bottom], [1, top], [0, top]],
    );
  });
  return shapes;
}

export function lettering() {
  const canvas = document.createElement("canvas");
  canvas.width = SIGN.width;
  canvas.height = SIGN.height * WORDS.length;
  const pen = canvas.getContext("2d");
  pen.fillStyle = "#2b3350";
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.fillStyle = "#fff6df";
  pen.font = "600 84px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  WORDS.forEach((word, i) => pen.fillText(word, SIGN.width / 2, SIGN.height * (i + 0.5)));
  return canvas;
}
