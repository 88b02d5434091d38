// The page of `vrduino view`: a source of samples on one side, pictures and words on the other.
//
//   stream.js (the program) ─┐                ┌─ picture.js (board, two eyes)
//                            ├─ intake ─ ─ ─ ─┼─ charts.js, lanes.js over history.js
//   serial.js over wire.js  ─┘  samples.js    └─ status.js, console.js, controls.js
//
// Samples are taken in as they come, into arrays that never grow; all else waits for the next
// animation frame, of which a hidden page has none.

import { Stream } from "./stream.js";
import { SerialBoard } from "./serial.js";
import { NOTES, Samples, STATUS_KNOWN } from "./samples.js";
import { History } from "./history.js";
import { Picture } from "./picture.js";
import { Orbit } from "./orbit.js";
import { Hand, isInHand } from "./hand.js";
import { Labels } from "./labels.js";
import { Chart } from "./charts.js";
import { Lanes } from "./lanes.js";
import { Words } from "./status.js";
import { Notice } from "./notice.js";
import { Console } from "./console.js";
import { BoardControls, EmulatedControls, WearerControls } from "./controls.js";
import { Keys } from "./keys.js";
import { Theme } from "./theme.js";
import { expose } from "./hook.js";

/** Words and numbers are written so often, in milliseconds. */
const WORDS_EVERY = 200;

const byId = (id) => document.getElementById(id);

const samples = new Samples();
const history = new History();
const words = new Words();
const shown = { status: { kind: "none", state: "opening", message: "" }, truth: null };
let dirty = true;
const redraw = () => {
  dirty = true;
};

/** Where every source brings what it has. */
export const intake = {
  sample(time, w, x, y, z, latency, sequence, flags) {
    samples.take(time, w, x, y, z, latency, sequence, flags);
    history.take(time, w, x, y, z, latency, sequence, flags);
    words.take(flags);
    dirty = true;
  },
  status(status) {
    shown.status = status;
    notice.show(status, samples.count > 0);
    emulated.show(status);
    dirty = true;
  },
  line(text) {
    terminal.take(text);
    board.answer(text);
    dirty = true;
  },
  truth(truth) {
    shown.truth = truth;
  },
};

const stream = new Stream(intake);
const serial = new SerialBoard(intake);
let source = stream;

function send(text) {
  if (shown.status.kind === "replay") intake.line("error: not sent: a recording takes no commands");
  else source.send(text);
}

async function openSerial() {
  try {
    // Before the program lets go, so that a person who changes their mind keeps what there was.
    await serial.choose();
    stream.close();
    source = serial;
  } catch (error) {
    if (error.name !== "NotFoundError") {
      const advice = "A port has one reader: end `vrduino view` or whatever else holds it.";
      intake.line(`error: ${error.message} ${advice}`);
    }
  }
}

async function closeSerial() {
  await serial.close();
  source = stream;
  stream.open();
}

const notice = new Notice({
  startEmulated: () => stream.ask({ start: "emulated" }),
  replug: () => stream.ask({ unplug: false }),
  openSerial,
  closeSerial,
});
const terminal = new Console(byId("lines"), byId("type"), send);
const picture = new Picture(byId("picture"));
picture.restored = redraw;
const hand = new Hand((request) => source.ask(request));
const orbit = new Orbit(picture.canvas, redraw, () => hand.begin(), (across, down, event) => {
  const inHand = isInHand(shown.status);
  const stereo = picture.mode === "stereo";
  // The camera of the board view goes round with shift; that of the eyes is the head itself.
  if (inHand && (stereo || !event.shiftKey)) hand.drag(across, down, picture.right(), shown.truth);
  return stereo || (inHand && !event.shiftKey);
});
const labels = new Labels(byId("labels"));
const board = new BoardControls(send);
const emulated = new EmulatedControls((request) => source.ask(request));
const wearer = new WearerControls(picture, redraw);
byId("no-webgl").hidden = Boolean(picture.gl);

const charts = [
  new Chart(byId("chart-angles"), [
    { track: history.yaw, colour: "--y" },
    { track: history.pitch, colour: "--x" },
    { track: history.roll, colour: "--z" },
  ], { signed: true, least: 15, most: 180 }),
  new Chart(byId("chart-rate"), [{ track: history.rate, colour: "--accent" }], { least: 10 }),
  new Chart(byId("chart-latency"), [{ track: history.latency, colour: "--violet" }], { least: 1 }),
  new Chart(byId("chart-losses"), [{ track: history.missing, colour: "--bad" }], { least: 4, bars: true }),
  new Lanes(byId("chart-status")),
];

const theme = new Theme((dark) => {
  picture.dark = dark;
  for (const chart of charts) chart.restyle();
  redraw();
});

function show(mode) {
  picture.mode = mode;
  document.body.dataset.view = mode;
  byId(`view-${mode}`).checked = true;
  redraw();
}

function full() {
  if (document.fullscreenElement) document.exitFullscreen();
  else byId("stage").requestFullscreen?.().catch(() => {});
}

/** What is of the wearer is seen by two eyes only: unseen it is not changed. */
const worn = (act) => () => picture.mode === "stereo" && act();

const acts = {
  recenter: () => send("r"),
  bias: () => send("b"),
  view: () => show(picture.mode === "board" ? "stereo" : "board"),
  estimator: () => board.toggle(),
  mounting: worn(() => wearer.mounting(!picture.viewer.turnedAround)),
  neck: worn(() => wearer.neck(!picture.neckOn)),
  narrower: worn(() => wearer.ipd(picture.viewer.ipd - 1)),
  wider: worn(() => wearer.ipd(picture.viewer.ipd + 1)),
  orbit: () => orbit.reset(),
  theme: () => theme.toggle(),
  console() {
    byId("typed").value = ":";
    byId("typed").focus();
  },
  full,
};
const keys = new Keys(acts, byId("help"));
for (const button of document.querySelectorAll("button[data-act]")) {
  button.addEventListener("click", () => keys.acts[button.dataset.act]());
}
for (const mode of ["board", "stereo"]) byId(`view-${mode}`).addEventListener("change", () => show(mode));
new ResizeObserver(redraw).observe(document.body);
document.addEventListener("fullscreenchange", redraw);

let wordsAt = -Infinity;
/** A truth that was there when the words were written before. */
let compared = null;

function frame(now) {
  requestAnimationFrame(frame);
  hand.move();
  if (now - wordsAt >= WORDS_EVERY) {
    wordsAt = now;
    const { flags } = samples.latest;
    if (compared) words.compare(samples, compared);
    compared = shown.truth;
    words.show(samples, history, shown.status);
    words.hint(shown.status, picture.mode, samples.count);
    board.show(shown.status, { known: Boolean(flags & STATUS_KNOWN), notes: Boolean(flags & NOTES) });
  }
  if (!dirty) return;
  dirty = false;
  picture.draw(samples.quaternion, orbit);
  labels.draw(picture);
  for (const chart of charts) chart.draw(history);
  terminal.draw();
}

expose({ samples, history, picture, terminal, shown });
byId("starting").remove();
stream.open();
requestAnimationFrame(frame);
