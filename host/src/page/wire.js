// The board's stream, byte for byte, as docs/wire-format.md has it: lines and frames in, in
// whatever chunks they come, orientations and texts out. The page needs it where it talks to a
// board without the program between them (Web Serial); it does what the library's
// `wire::decoder::Decoder` does, and is tested against it.

/** The longest line. */
const LINE = 160;
/** The longest message, stuffed, without the zeros around it. */
const STUFFED = 31;
/** A byte below begins a frame; no line has one, but tabs and its end. */
const FIRST_LETTER = 32;
/** How far the length of a quaternion may be from 1. */
const TOLERANCE = 0.01;
const [NEWLINE, RETURN, TAB] = [10, 13, 9];
const [ORIENTATION, COUNTS, COUNTS_WITH_FIELD] = [1, 2, 3];

// Where the next byte belongs: in a line, behind a zero, in a frame, in what is thrown away.
const [IN_LINE, OPEN, IN_FRAME, NOISE] = [0, 1, 2, 3];

/** CRC-16/IBM-3740 of the bytes up to `end`. */
export function crc16(bytes, end) {
  let crc = 0xffff;
  for (let at = 0; at < end; at += 1) {
    let top = (crc >> 8) ^ bytes[at];
    top ^= top >> 4;
    crc = ((crc << 8) ^ (top << 12) ^ (top << 5) ^ top) & 0xffff;
  }
  return crc;
}

export class Decoder {
  /**
   * `on.orientation(w, x, y, z, sequence, micros, status)`: of unit length; the last three are −1
   * where the line does not say. `on.text(line)`. `on.counts(sequence, micros)` and
   * `on.unknown(kind)` need not be there.
   */
  constructor(on) {
    this.on = on;
    this.losses = { bytes: 0, damaged: 0, malformed: 0, missing: 0, restarts: 0 };
    this.place = IN_LINE;
    this.bytes = new Uint8Array(LINE);
    this.length = 0;
    this.message = new DataView(this.bytes.buffer);
    this.text = new TextDecoder("utf-8", { fatal: true, ignoreBOM: true });
    this.stamped = false;
    this.last = -1;
  }

  push(bytes) {
    for (let at = 0; at < bytes.length; at += 1) this.take(bytes[at]);
  }

  take(byte) {
    switch (this.place) {
      case IN_LINE:
        if (byte === NEWLINE) this.endOfLine();
        else if (byte === 0) {
          // A line that finds no end.
          if (this.length > 0) this.refuse("malformed");
          this.place = OPEN;
        } else if (byte < FIRST_LETTER && byte !== RETURN && byte !== TAB) this.giveUp();
        else this.keep(byte, LINE);
        break;
      case OPEN:
        if (byte === 0) break;
        this.place = byte < FIRST_LETTER ? IN_FRAME : IN_LINE;
        this.keep(byte, LINE);
        break;
      case IN_FRAME:
        if (byte === 0) {
          this.place = OPEN;
          this.endOfFrame();
        } else this.keep(byte, STUFFED);
        break;
      default:
        if (byte === 0) this.place = OPEN;
        else if (byte === NEWLINE) this.place = IN_LINE;
        else this.losses.bytes += 1;
    }
  }

  keep(byte, most) {
    if (this.length === most) {
      this.giveUp();
      return;
    }
    this.bytes[this.length] = byte;
    this.length += 1;
  }

  /** Neither line nor frame goes on like this. */
  giveUp() {
    this.length += 1; // with the byte that makes it so
    this.refuse("malformed");
    this.place = NOISE;
  }

  refuse(damage) {
    this.losses.bytes += this.length;
    this.losses[damage] += 1;
    this.length = 0;
  }

  endOfFrame() {
    const damage = this.frame();
    if (damage) this.refuse(damage);
    this.length = 0;
  }

  /** What is wrong with it, or nothing, and it has been told. */
  frame() {
    if (!this.unstuff() || this.length < 3) return "malformed";
    // The message begins behind the first distance.
    const view = this.message;
    const end = this.length - 2;
    for (let at = 0; at < this.length - 1; at += 1) this.bytes[at] = this.bytes[at + 1];
    const body = end - 1;
    if (crc16(this.bytes, body) !== view.getUint16(body, true)) return "damaged";
    if (body < 8) return "malformed";
    const sequence = view.getUint16(2, true);
    const micros = view.getUint32(4, true);
    const kind = this.bytes[0];
    if (kind === ORIENTATION) {
      if (body !== 24) return "malformed";
      const one = 2 ** 30;
      const w = view.getInt32(8, true) / one;
      const x = view.getInt32(12, true) / one;
      const y = view.getInt32(16, true) / one;
      const z = view.getInt32(20, true) / one;
      return this.orientation(w, x, y, z, sequence, micros, this.bytes[1]);
    }
    if (kind === COUNTS || kind === COUNTS_WITH_FIELD) {
      if (body !== (kind === COUNTS ? 22 : 28)) return "malformed";
      this.on.counts?.(sequence, micros);
    } else this.on.unknown?.(kind);
    return null;
  }

  /** In place: every distance becomes the zero that it stands for. */
  unstuff() {
    let at = 0;
    while (at < this.length) {
      const distance = this.bytes[at];
      if (distance === 0) return false;
      this.bytes[at] = 0;
      at += distance;
    }
    return at === this.length;
  }

  endOfLine() {
    if (this.length > 0 && this.bytes[this.length - 1] === RETURN) this.length -= 1;
    if (this.length === 0) return;
    const damage = this.line();
    if (damage) this.refuse(damage);
    this.length = 0;
  }

  line() {
    let line;
    try {
      line = this.text.decode(this.bytes.subarray(0, this.length));
    } catch {
      return "malformed";
    }
    if (!line.startsWith("QC ")) {
      this.on.text(line);
      return null;
    }
    const star = line.indexOf("*");
    if (star < 0) return this.words(line, false);
    const crc = line.slice(star + 1);
    if (!/^[0-9A-F]{4}$/.test(crc)) return "malformed";
    if (crc16(this.bytes, this.bytes.indexOf(0x2a)) !== parseInt(crc, 16)) return "damaged";
    // The space before the asterisk is the checksum's.
    return line[star - 1] === " " ? this.words(line.slice(0, star - 1), true) : "malformed";
  }

  words(body, stamped) {
    const words = body.split(" ");
    if (words.length !== (stamped ? 7 : 5)) return "malformed";
    const [w, x, y, z] = words.slice(1, 5).map(number);
    if (!stamped) return this.orientation(w, x, y, z, -1, -1, -1);
    const sequence = whole(words[5], 0xffff);
    const micros = whole(words[6], 0xffffffff);
    if (sequence < 0 || micros < 0) return "malformed";
    return this.orientation(w, x, y, z, sequence, micros, -1);
  }

  orientation(w, x, y, z, sequence, micros, status) {
    const length = Math.hypot(w, x, y, z);
    // Written so that what is not a number fails.
    if (!(Math.abs(length - 1) <= TOLERANCE)) return "malformed";
    // A plain line behind one with a stamp is rather the beginning of a damaged one.
    const before = this.stamped;
    this.stamped = sequence >= 0;
    if (this.stamped) this.follow(sequence);
    else if (before) return "malformed";
    this.on.orientation(w / length, x / length, y / length, z / length, sequence, micros, status);
    return null;
  }

  /** Up to half of the numbers may be missing between two. */
  follow(sequence) {
    if (this.last >= 0) {
      const ahead = (sequence - this.last) & 0xffff;
      if (ahead >= 1 && ahead <= 0x7fff) this.losses.missing += ahead - 1;
      else this.losses.restarts += 1;
    }
    this.last = sequence;
  }
}

/** No exponent, no sign but minus; NaN if it is none. */
function number(word) {
  return /^-?(\d+\.?\d*|\.\d+)$/.test(word) ? Number(word) : NaN;
}

function whole(word, most) {
  return /^\d+$/.test(word) && Number(word) <= most ? Number(word) : -1;
}
