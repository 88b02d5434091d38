// The VRduino as a person sees it: a Teensy 3.2 and the sensor on a board with four photodiodes,
// and the axes of its frame: x to the right, y up, z out of the board. In millimetres.

import { Shapes } from "./shapes.js";

/** Red, green, blue for x, y, z, here as in the charts. */
export const AXES = { x: "#ff5d6e", y: "#3ddc84", z: "#4f9dff" };
export const AXIS_LENGTH = 70;

const BOARD = { width: 100, height: 62, depth: 1.6 };
const TEENSY = { width: 35.6, height: 17.8, depth: 1.6, x: -8, y: 0, z: 5.4 };
const SENSOR = { width: 15, height: 20, depth: 1.4, x: 29, y: 0, z: 3 };
/** The photodiodes of the VRduino stand this far from its middle. */
const PHOTODIODE = { x: 42, y: 25 };

const GOLD = "#e3b95c";
const STEEL = "#c9ced6";
const BLACK = "#17181c";

/** Where the three printed faces are on one canvas, in pixels: 12 to the millimetre. */
const SCALE = 12;
const SHEET = { width: 1216, height: 1024 };
const PRINTS = {
  board: { ...BOARD, x: 8, y: 8 },
  teensy: { ...TEENSY, x: 8, y: 776 },
  sensor: { ...SENSOR, x: 480, y: 776 },
};

/** From a place on a face, 0 to 1 from its upper left corner, to one on the canvas. */
const placesOn = ({ x, y, width, height }) => (u, v) => [
  (x + u * width * SCALE) / SHEET.width, (y + v * height * SCALE) / SHEET.height,
];

/** All but the printed faces. */
export function solids() {
  const shapes = new Shapes();
  shapes.paint("#16284a", 0.35).put(0, 0, 0).plate(BOARD.width, BOARD.height, BOARD.depth, 4);
  teensy(shapes);
  sensor(shapes);
  for (const [sx, sy] of [[1, 1], [-1, 1], [-1, -1], [1, -1]]) {
    const [x, y] = [sx * PHOTODIODE.x, sy * PHOTODIODE.y];
    shapes.paint("#101216", 0.9).put(x, y, 1.9).box(6.4, 6.4, 2.2);
    shapes.paint("#3a2238", 1).put(x, y, 3.1).box(4.4, 4.4, 0.3);
    shapes.paint(STEEL, 0.8).put(x, y - 4, 1.1).box(5, 1.2, 0.6);
  }
  return shapes;
}

function teensy(shapes) {
  const { width, height, depth, x, y, z } = TEENSY;
  shapes.paint("#0f5c3c", 0.4).put(x, y, z).plate(width, height, depth, 0.8);
  const [left, top] = [x - width / 2, z + depth / 2];
  for (let pin = 0; pin < 14; pin += 1) {
    for (const side of [-1, 1]) {
      const [px, py] = [left + 1.3 + 2.54 * pin, y + side * 7.6];
      shapes.paint(BLACK).put(px, py, 2.6).box(2.5, 2.4, 2.6);
      shapes.paint(GOLD, 0.9).put(px, py, 4.2).box(0.64, 0.64, 6.2);
    }
  }
  shapes.paint(BLACK, 0.6).put(x + 1.5, y, top + 0.7).box(9, 9, 1.4);
  shapes.paint(STEEL, 1).put(left + 1.6, y, top + 1.3).box(5.6, 7.6, 2.6);
  shapes.paint("#2a2c31").put(left - 1.25, y, top + 1.3).box(0.1, 6.6, 1.8);
  shapes.paint(STEEL, 0.8).put(x + 14, y, top + 0.6).box(4.4, 3.2, 1.2);
  shapes.paint("#f2f3f5", 0.3).put(x + 14, y, top + 1, "z").rod(0.9, 0.7, 12);
  shapes.paint(STEEL, 0.8).put(x - 7.5, y - 4, top + 0.5).box(3.2, 2, 1);
  shapes.paint("#ff9d3c", 2).put(x - 9, y + 4.4, top + 0.3).box(1.2, 0.7, 0.6);
}

function sensor(shapes) {
  const { width, height, depth, x, y, z } = SENSOR;
  shapes.paint("#25318c", 0.4).put(x, y, z).plate(width, height, depth, 0.8);
  const top = z + depth / 2;
  shapes.paint(BLACK, 0.7).put(x + 1, y, top + 0.5).box(3.4, 3.4, 1);
  for (let pin = 0; pin < 7; pin += 1) {
    shapes.paint(GOLD, 0.9).put(x - 5.8, y + 2.54 * (pin - 3), z).box(0.64, 0.64, 4.6);
  }
  for (const [dx, dy] of [[4.6, 4.4], [4.6, -4.4], [1, -5.4], [1, 5.4]]) {
    shapes.paint("#b79a6a", 0.2).put(x + dx, y + dy, top + 0.3).box(1.8, 1, 0.6);
  }
}

/** The three faces with what is printed on them, a hair above what they cover. */
export function faces() {
  const shapes = new Shapes().paint("#ffffff", 0.25);
  shapes.put(0, 0, 0.02).plate(BOARD.width, BOARD.height, BOARD.depth, 4, placesOn(PRINTS.board));
  for (const [part, print] of [[TEENSY, PRINTS.teensy], [SENSOR, PRINTS.sensor]]) {
    shapes.put(part.x, part.y, part.z + 0.02).plate(part.width, part.height, part.depth, 0.8, placesOn(print));
  }
  return shapes;
}

/** An arrow for each axis. */
export function axes() {
  const shapes = new Shapes();
  for (const axis of ["x", "y", "z"]) {
    const from = (distance) => ["x", "y", "z"].map((name) => (name === axis ? distance : 0));
    shapes.paint(AXES[axis], 0.4);
    shapes.put(...from(0), axis).rod(1.1, AXIS_LENGTH - 9, 16);
    shapes.put(...from(AXIS_LENGTH - 9), axis).rod(3.2, 9, 24, 0);
  }
  return shapes;
}

/** Solder mask, traces, pads and lettering. */
export function prints() {
  const canvas = document.createElement("canvas");
  canvas.width = SHEET.width;
  canvas.height = SHEET.height;
  const pen = canvas.getContext("2d");
  const onto = ({ x, y, width, height }, draw) => {
    pen.save();
    pen.translate(x + (width / 2) * SCALE, y + (height / 2) * SCALE);
    pen.scale(SCALE, SCALE);
    draw(pen);
    pen.restore();
  };
  onto(PRINTS.board, printBoard);
  onto(PRINTS.teensy, printTeensy);
  onto(PRINTS.sensor, printSensor);
  return canvas;
}

// On the canvas y goes down; the origin is the middle of the face.

function printBoard(pen) {
  cover(pen, "#16284a", BOARD);
  pen.strokeStyle = "#24427a";
  pen.lineWidth = 0.7;
  pen.lineJoin = "round";
  // From every photodiode to the Teensy, two wires each; and from the sensor to pins 18 and 19.
  for (const [sx, sy] of [[1, 1], [-1, 1], [-1, -1], [1, -1]]) {
    for (const aside of [0, 1.6]) {
      line(pen, [[sx * 42, sy * (19 - aside)], [sx * (30 - aside), sy * (19 - aside)],
        [sx * 16 - 8, sy * (12 - aside)], [sx * 12 - 8 + aside, sy * 8]]);
    }
  }
  for (const y of [-1.3, 1.3]) line(pen, [[23, y], [18, y * 2], [14, y * 4], [9.5, y * 5.6]]);
  for (const [x, y] of [[-46, 0], [46, 0]]) hole(pen, x, y, 1.6);
  for (const [x, y] of [[-20, -14], [0, -14], [20, -14], [-20, 14], [0, 14], [34, -13], [34, 13]]) {
    pad(pen, x, y, 0.55);
  }
  letters(pen, "VRduino", 0, -24.5, 7, "600");
  letters(pen, "Teensy 3.2  +  MPU-9250", 0, 25.5, 2.6);
  [["S0", -34, -25], ["S1", 34, -25], ["S2", -34, 25], ["S3", 34, 25]].forEach(([name, x, y]) => {
    letters(pen, name, x, y, 2.4);
  });
  pen.strokeStyle = "#e8edf7";
  pen.lineWidth = 0.3;
  for (const [x, y] of [[-42, -25], [42, -25], [-42, 25], [42, 25]]) {
    pen.strokeRect(x - 4.4, y - 4.4, 8.8, 8.8);
  }
  pen.strokeRect(TEENSY.x - 19.4, -10.2, 38.4, 20.4);
  pen.strokeRect(SENSOR.x - 8.4, -11, 16.8, 22);
}

function printTeensy(pen) {
  cover(pen, "#0f5c3c", TEENSY);
  for (let pin = 0; pin < 14; pin += 1) {
    for (const y of [-7.6, 7.6]) pad(pen, -16.5 + 2.54 * pin, y, 0.75);
  }
  letters(pen, "Teensy 3.2", -9.2, 4.6, 1.7, "600");
  letters(pen, "PJRC", 8.9, -4.6, 1.5);
  pen.strokeStyle = "#1b7c53";
  pen.lineWidth = 0.25;
  for (let i = -4; i <= 4; i += 1) {
    line(pen, [[1.5 + i, -5], [1.5 + i * 1.7, -6.6]]);
    line(pen, [[1.5 + i, 5], [1.5 + i * 1.7, 6.6]]);
  }
}

function printSensor(pen) {
  cover(pen, "#25318c", SENSOR);
  for (let pin = 0; pin < 7; pin += 1) pad(pen, -5.8, 2.54 * (pin - 3), 0.8);
  letters(pen, "MPU-9250", 1.4, -8.4, 1.9, "600");
  letters(pen, "x →  y ↑", 1.4, 8.4, 1.8);
}

function cover(pen, colour, { width, height }) {
  pen.fillStyle = colour;
  pen.fillRect(-width / 2 - 0.6, -height / 2 - 0.6, width + 1.2, height + 1.2);
}

function line(pen, [first, ...rest]) {
  pen.beginPath();
  pen.moveTo(...first);
  rest.forEach((point) => pen.lineTo(...point));
  pen.stroke();
}

function pad(pen, x, y, radius) {
  pen.fillStyle = GOLD;
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fill();
}

function hole(pen, x, y, radius) {
  pad(pen, x, y, radius * 1.5);
  pen.fillStyle = "#0a0d14";
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fill();
}

function letters(pen, text, x, y, size, weight = "400") {
  pen.fillStyle = "#e8edf7";
  pen.font = `${weight} ${size}px system-ui, sans-serif`;
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.fillText(text, x, y);
}
