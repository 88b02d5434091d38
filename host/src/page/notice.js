// What stands over the picture while there is nothing to see, with what can be done about it.

import { write } from "./status.js";
import { hasSerial } from "./serial.js";

const byId = (id) => document.getElementById(id);

/** Word and mood of each state. */
const STATES = {
  connected: ["connected", "good"],
  waiting: ["no board", "warn"],
  lost: ["lost", "bad"],
  ended: ["ended", "quiet"],
  gone: ["no program", "bad"],
  opening: ["connecting", "quiet"],
};

const TITLES = {
  waiting: "No board is plugged in",
  lost: "The board is gone",
  gone: "The program has ended",
  ended: "The board has stopped",
};

function wordAndMood(kind, state) {
  // Its image may have to be built first.
  if (kind === "emulated" && state === "waiting") return ["starting", "quiet"];
  return STATES[state] ?? [state, "quiet"];
}

function title(kind, state) {
  if (kind === "emulated" && state === "waiting") return "The emulated board is starting";
  if (kind === "replay" && state === "ended") return "The recording has ended";
  return TITLES[state] ?? "Nothing to see yet";
}

export class Notice {
  constructor({ startEmulated, openSerial, closeSerial, replug }) {
    byId("start-emulated").addEventListener("click", startEmulated);
    byId("replug").addEventListener("click", replug);
    for (const button of document.querySelectorAll(".open-serial")) {
      button.hidden = !hasSerial();
      button.addEventListener("click", openSerial);
    }
    byId("close-serial").addEventListener("click", closeSerial);
  }

  show({ kind, state, source, message }, hasSamples) {
    const [word, mood] = wordAndMood(kind, state);
    write("state", word, mood);
    write("source", source || "");
    // A recording that has ended leaves its last picture to look at.
    const watched = kind === "replay" && state === "ended" && hasSamples;
    const over = state !== "connected" && state !== "opening" && !watched;
    byId("notice").hidden = !over;
    write("notice-title", title(kind, state));
    write("notice-text", message ? message[0].toUpperCase() + message.slice(1) : "");
    const startable = kind === "none" || kind === "port" || (kind === "emulated" && state === "ended");
    byId("start-emulated").hidden = !startable || state === "gone";
    byId("open-port").hidden = !hasSerial() || kind === "emulated";
    byId("replug").hidden = !(kind === "emulated" && state === "lost");
    byId("close-serial").hidden = kind !== "serial";
    const opener = document.querySelector("#panel .open-serial");
    if (opener) opener.hidden = !hasSerial() || kind === "serial";
  }
}
