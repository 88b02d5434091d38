// A board without the program between: Web Serial, where the browser has it. To the rest of the page
// it is what the program is, samples and a status a second.

import { Decoder } from "./wire.js";
import { Latency } from "./latency.js";
import { DEVICE_TIME, RESTART, STATUS_KNOWN } from "./samples.js";

/** PJRC's boards; the emulated one never shows here. */
const TEENSY = { usbVendorId: 0x16c0 };
const MICROS = 2 ** 32;
/**
 * What a board is asked first. One whose program is another takes single letters for keys, and in
 * this there is none of them; it is asked so often, and goes on with what it sends.
 */
const WHO = "\n:help";
const ATTEMPTS = 5;
/** So long the board may take, in milliseconds, to hear the last that is said to it. */
const FAREWELL = 500;
const SETTINGS = [":estimator", ":get tilt-time", ":get notes-alpha"];

export const hasSerial = () => "serial" in navigator;

export class SerialBoard {
  constructor(intake) {
    this.intake = intake;
    this.port = null;
    this.writer = null;
    this.reader = null;
    this.ended = null;
    /** What the board streamed before it was asked for frames, as `timed every 7`. */
    this.before = null;
    this.latency = new Latency();
    this.latest = { message: "", state: "waiting" };
    if (!hasSerial()) return;
    navigator.serial.addEventListener("connect", ({ target }) => this.again(target));
    // A page that goes cannot wait: this reaches the board if the port takes it at once.
    addEventListener("pagehide", () => this.giveBack());
    setInterval(() => this.tick(), 1000);
  }

  /** Lets a person choose a port; needs a click. True once one is open. */
  async choose() {
    const port = await navigator.serial.requestPort({ filters: [TEENSY] });
    await this.open(port);
  }

  async open(port) {
    // The number is nothing to a board on USB, but one must be given.
    await port.open({ baudRate: 115200, bufferSize: 65536 });
    this.port = port;
    this.fresh();
    this.writer = port.writable.getWriter();
    this.tell("connected", "The board talks to this page directly (Web Serial).");
    this.send(WHO);
    this.read(port);
  }

  tick() {
    if (!this.port) return;
    this.tell();
    this.attempts += 1;
    if (this.writer && !this.known && this.attempts < ATTEMPTS) this.send(WHO);
  }

  fresh() {
    this.decoder = new Decoder({
      orientation: (w, x, y, z, sequence, micros, status) =>
        this.sample(w, x, y, z, sequence, micros, status),
      text: (line) => this.text(line),
    });
    this.latency.restart();
    this.known = false;
    this.attempts = 0;
    this.before = null;
    this.settings = {};
    this.estimator = null;
    this.restarts = 0;
    this.unwrapped = NaN;
    this.micros = 0;
    this.counted = 0;
    this.anew = true;
  }

  async read(port) {
    const reader = port.readable.getReader();
    this.reader = reader;
    try {
      for (;;) {
        const { value, done } = await reader.read();
        if (done) break;
        this.decoder.push(value);
      }
    } catch {
      // Unplugged: the same as its end.
    }
    reader.releaseLock();
    if (this.port === port) this.lost(port);
    else this.ended?.();
  }

  lost(port) {
    this.writer?.releaseLock();
    this.writer = null;
    port.close().catch(() => {});
    this.tell("lost", "The board was unplugged. Plug it in again; the page goes on by itself.");
  }

  /** A port that was allowed before has come back. */
  async again(port) {
    if (!this.port || this.writer) return;
    await this.open(port).catch((error) => this.intake.line(`error: ${error.message}`));
  }

  /** The board is left as it was found. */
  giveBack() {
    if (!this.writer || !this.before) return;
    const [format, , every] = this.before.split(" ");
    this.before = null;
    this.send(`\n:stream ${format}\n:every ${every}`);
  }

  async close() {
    const { port, writer, reader } = this;
    this.giveBack();
    this.port = null;
    this.writer = null;
    if (!writer) return;
    const over = new Promise((done) => {
      this.ended = done;
    });
    // A port that closes forgets what it has not sent yet; its stream, closed before, sends it.
    const late = new Promise((done) => {
      setTimeout(done, FAREWELL);
    });
    await Promise.race([writer.close().catch(() => {}), late]);
    writer.releaseLock();
    // A port that is being read does not close.
    await reader.cancel().catch(() => {});
    await over;
    await port.close().catch(() => {});
  }

  sample(w, x, y, z, sequence, micros, status) {
    const host = performance.now() / 1000;
    let flags = this.anew ? RESTART : 0;
    let late = NaN;
    let time = host;
    if (sequence >= 0) {
      flags |= this.follow(micros) | DEVICE_TIME;
      time = this.unwrapped;
      late = this.latency.take(time, host);
    }
    if (status >= 0) flags |= status | STATUS_KNOWN;
    this.anew = false;
    this.counted += 1;
    this.intake.sample(time, w, x, y, z, late, Math.max(sequence, 0), flags);
  }

  /** The device's time goes on where its 32 bits begin again, and anew where the board has. */
  follow(micros) {
    const anew = !(this.unwrapped >= 0) || this.decoder.losses.restarts > this.restarts;
    this.restarts = this.decoder.losses.restarts;
    if (anew) {
      this.unwrapped = micros / 1e6;
      this.latency.restart();
    } else this.unwrapped += ((micros - this.micros + MICROS) % MICROS) / 1e6;
    this.micros = micros;
    return anew ? RESTART : 0;
  }

  text(line) {
    if (!this.known && line.startsWith("OK verbs")) {
      this.known = true;
      [":stream", ":stream binary", ...SETTINGS].forEach((question) => this.send(question));
    } else if (this.known && !this.before) {
      // The first of these is the answer to the question.
      this.before = /^OK stream (\w+ every \d+)$/.exec(line)?.[1] ?? null;
    }
    if (line === "OK defaults") SETTINGS.forEach((question) => this.send(question));
    const estimator = /^OK estimator (\w+)/.exec(line);
    if (estimator) this.estimator = estimator[1];
    const setting = /^OK ([a-z]+-[a-z]+) (-?\d+(?:\.\d+)?)(?: |$)/.exec(line);
    if (setting) this.settings[setting[1]] = Number(setting[2]);
    this.intake.line(line);
    if (estimator || setting) this.tell();
  }

  tell(state = this.latest.state, message = this.latest.message) {
    this.latest = { state, message };
    const { bytes, damaged, malformed, missing, restarts } = this.decoder.losses;
    this.intake.status({
      type: "status", kind: "serial", source: "Web Serial", state, message,
      latency_ms: this.latency.percentiles(),
      gaps: missing, crc_errors: damaged, malformed, thrown_away: bytes, dropped: 0, restarts,
      estimator: this.estimator, settings: this.settings, motions: [], motion: null,
    });
  }

  send(text) {
    const bytes = new TextEncoder().encode(text.includes(":") ? `${text}\n` : text);
    if (this.writer) this.writer.write(bytes).catch(() => {});
    else this.intake.line("error: not sent, the board is not plugged in");
  }

  /** What only the program can do. */
  ask() {
    this.intake.line("error: only with the emulated board");
  }
}
