// What the board says in lines, and what a person says to it.

/** Lines that are kept on the page. */
const KEPT = 200;
/** Lines that may wait for the next picture; more in so short a time nobody reads. */
const WAITING = 100;
const KEYS = /^[0-5rb]$/;

export class Console {
  /** `send(text)` takes a key, or a line that begins with a colon. */
  constructor(list, form, send) {
    this.list = list;
    this.input = form.querySelector("input");
    this.waiting = [];
    this.latest = [];
    this.typed = [];
    this.back = 0;
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.enter(this.input.value.trim(), send);
    });
    this.input.addEventListener("keydown", (event) => this.recall(event));
  }

  enter(text, send) {
    if (text === "") return;
    if (text.startsWith(":") || KEYS.test(text)) {
      this.take(`› ${text}`, "sent");
      send(text);
      this.typed.push(text);
      if (this.typed.length > 50) this.typed.shift();
      this.input.value = "";
    } else {
      this.take(`error: “${text}” is neither a key (0 to 5, r, b) nor a line: begin it with a colon, as :help`);
    }
    this.back = 0;
  }

  /** Up and down go through what was typed. */
  recall(event) {
    if (event.key !== "ArrowUp" && event.key !== "ArrowDown") return;
    event.preventDefault();
    this.back += event.key === "ArrowUp" ? 1 : -1;
    this.back = Math.max(0, Math.min(this.typed.length, this.back));
    this.input.value = this.back ? this.typed[this.typed.length - this.back] : "";
  }

  take(text, kind = kindOf(text)) {
    if (this.waiting.length === WAITING) this.waiting.shift();
    this.waiting.push({ text, kind });
    this.latest.push(text);
    if (this.latest.length > KEPT) this.latest.shift();
  }

  /** With the next picture; the last line stays in sight unless a person has scrolled up. */
  draw() {
    if (this.waiting.length === 0) return;
    const { list } = this;
    const following = list.scrollHeight - list.scrollTop - list.clientHeight < 24;
    for (const { text, kind } of this.waiting) {
      // The oldest element is used again.
      const line = list.childElementCount >= KEPT ? list.firstElementChild : document.createElement("li");
      line.textContent = text;
      line.dataset.kind = kind;
      list.append(line);
    }
    this.waiting.length = 0;
    if (following) list.scrollTop = list.scrollHeight;
  }
}

function kindOf(text) {
  if (text.startsWith("OK ")) return "ok";
  if (text.startsWith("ERR ") || text.startsWith("error:")) return "bad";
  return text.startsWith("warning:") ? "warn" : "line";
}
