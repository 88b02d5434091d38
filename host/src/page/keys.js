// The keyboard. A key does what it says unless something is being typed.

/** In the order of the help: what is pressed, what is shown, what it does. */
const KEYS = [
  { key: "r", does: "Face ahead where the board points now", act: "recenter" },
  { key: "b", does: "Measure the gyro's bias again (keep the board still)", act: "bias" },
  { key: "v", does: "Board, or the view of two eyes", act: "view" },
  { key: "e", does: "The other estimator", act: "estimator" },
  { key: "m", does: "Board taped on turned round by 180°, or not", act: "mounting" },
  { key: "h", does: "Head and neck, or eyes alone", act: "neck" },
  { key: "[", does: "Eyes nearer together", act: "narrower" },
  { key: "]", does: "Eyes further apart", act: "wider" },
  { key: "o", does: "Look at the board from where we began", act: "orbit" },
  { key: "f", does: "The picture alone, on the whole screen", act: "full" },
  { key: "t", does: "Light or dark", act: "theme" },
  { key: ":", does: "Type a line to the board", act: "console" },
  { key: "?", does: "This help", act: "help" },
];

const WRITTEN = "input:not([type=range], [type=radio], [type=checkbox]), select, textarea";
const isTyping = (element) => element instanceof Element && element.matches(WRITTEN);

export class Keys {
  /** `acts` has a function for each `act` above. */
  constructor(acts, help) {
    this.acts = { ...acts, help: () => (help.open ? help.close() : help.showModal()) };
    const list = help.querySelector("dl");
    for (const { key, does } of KEYS) {
      const [term, meaning] = [document.createElement("dt"), document.createElement("dd")];
      term.append(Object.assign(document.createElement("kbd"), { textContent: key }));
      meaning.textContent = does;
      list.append(term, meaning);
    }
    document.addEventListener("keydown", (event) => this.press(event, help));
    // A click beside it closes it.
    help.addEventListener("click", ({ target }) => target === help && help.close());
  }

  press(event, help) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (isTyping(event.target)) {
      if (event.key === "Escape") event.target.blur();
      return;
    }
    const found = KEYS.find(({ key }) => key === event.key);
    if (!found || (help.open && found.act !== "help")) return;
    event.preventDefault(); // or the colon would be typed where it leads
    this.acts[found.act]();
  }
}
