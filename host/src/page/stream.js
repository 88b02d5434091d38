// The program's end of the page: a WebSocket that brings samples in batches and takes commands, and
// is opened again for as long as the page is there.

/** Of a batch: kind, version, count; then the records. */
const HEADER = 4;
const RECORD = 40;
const [SAMPLES, VERSION] = [1, 1];

/** Seconds to wait before the next attempt, and at most. */
const [FIRST_WAIT, LONGEST_WAIT] = [0.25, 4];

/** Takes a batch apart. False, and nothing taken, if it is none. */
export function takeBatch(buffer, sample) {
  if (buffer.byteLength < HEADER) return false;
  const view = new DataView(buffer);
  const count = view.getUint16(2, true);
  const whole = buffer.byteLength === HEADER + count * RECORD;
  if (view.getUint8(0) !== SAMPLES || view.getUint8(1) !== VERSION || !whole) return false;
  for (let at = HEADER; at < buffer.byteLength; at += RECORD) {
    sample(
      view.getFloat64(at, true),
      view.getFloat32(at + 8, true),
      view.getFloat32(at + 12, true),
      view.getFloat32(at + 16, true),
      view.getFloat32(at + 20, true),
      view.getFloat32(at + 24, true),
      view.getUint32(at + 28, true),
      view.getUint32(at + 32, true),
    );
  }
  return true;
}

export class Stream {
  /** `intake` has `sample`, `status`, `line` and `truth`. */
  constructor(intake) {
    this.intake = intake;
    this.socket = null;
    this.wait = FIRST_WAIT;
    this.timer = 0;
    this.wanted = false;
  }

  open() {
    this.wanted = true;
    if (this.socket) return;
    clearTimeout(this.timer);
    const url = new URL("/stream", location.href);
    url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(url);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.wait = FIRST_WAIT;
    };
    socket.onmessage = ({ data }) => this.take(data);
    socket.onclose = () => this.closed(socket);
    this.socket = socket;
  }

  /** Until `open` is called again: another source has the page. */
  close() {
    this.wanted = false;
    clearTimeout(this.timer);
    this.socket?.close();
    this.socket = null;
  }

  closed(socket) {
    if (socket !== this.socket) return;
    this.socket = null;
    if (!this.wanted) return;
    this.intake.status({
      type: "status", kind: "none", source: "", state: "gone", motions: [],
      message: "The program behind this page has ended. Start `vrduino view` again; the page goes on by itself.",
    });
    this.timer = setTimeout(() => this.open(), this.wait * 1000);
    this.wait = Math.min(2 * this.wait, LONGEST_WAIT);
  }

  take(data) {
    if (typeof data !== "string") {
      const known = takeBatch(data, this.intake.sample);
      if (!known) this.intake.line("warning: samples in a form that this page does not know: load it again");
      return;
    }
    let message;
    try {
      message = JSON.parse(data);
    } catch {
      return;
    }
    if (message.type === "status") this.intake.status(message);
    else if (message.type === "line") this.intake.line(String(message.text));
    else if (message.type === "truth") this.intake.truth(message);
  }

  /** A key as it is, or a line that begins with a colon. */
  send(text) {
    this.ask({ send: text });
  }

  ask(request) {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(request));
    else this.intake.line("error: not sent, nothing is connected");
  }
}
