// SPDX-License-Identifier: GPL-3.0-or-later
// A page that follows a run (`tetlap view`): a bar that says how far it is, asked every second, and a newer page
// whenever there is something new to see, but so rarely that making it costs a fifth of the time at most.

import { count, format, h } from "./dom.js";

const PERIOD_MS = 1000;
const PATIENCE = 4; // times as long as the last newer page took

const WORDS = {
  waiting: "Waiting for the run to begin",
  running: "Running",
  gone: "The run was killed. `tetlap resume` continues from its last checkpoint",
  finished: "Finished",
  failed: "Failed",
  interrupted: "Interrupted; `tetlap resume` continues from its last checkpoint",
  lost: "The server has ended; this is the last state that it sent",
};

export const durationOf = (seconds) => {
  if (!(seconds >= 0)) return "";
  if (seconds < 100) return `${Math.round(seconds)}\u2009s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} minutes`;
  return `${format(seconds / 3600, "", 2)} hours`;
};

export class LiveBar {
  constructor() {
    this.word = h("strong", { role: "status" });
    this.facts = h("span.facts");
    this.meter = h("progress", { max: 1, "aria-label": "Share of the scene’s time that is done" });
    this.trouble = h("ul.trouble");
    this.element = h("section.live", { "aria-label": "The run" }, h("p", this.word, this.facts), this.meter, this.trouble);
  }

  show(state) {
    const { outcome, time, end, steps, step_s, pairs, left_s, message, trouble = [] } = state;
    const isRunning = outcome === "running";
    const word = WORDS[outcome] ?? outcome;
    if (this.word.textContent !== word) this.word.textContent = word; // told anew only when it changes
    this.element.dataset.outcome = outcome;
    const facts = isRunning && time != null ? [`t = ${format(time, "", 4)} of ${format(end, "s")}`, `${count(steps)} steps, the last of ${format(step_s, "s")}`, pairs > 0 && `${count(pairs)} pairs overlap`, left_s != null && `about ${durationOf(left_s)} left`] : [message];
    this.facts.replaceChildren(...facts.filter(Boolean).map((text) => h("span", text)));
    this.meter.hidden = !isRunning || time == null;
    if (end > 0) this.meter.value = time / end;
    this.trouble.replaceChildren(...trouble.map((text) => h("li", text)));
  }
}

const sleep = (ms) => new Promise((wake) => setTimeout(wake, ms));

async function ask(path) {
  const reply = await fetch(path, { cache: "no-store" });
  if (!reply.ok) throw new Error(await reply.text());
  return reply;
}

// Calls `tell` with each state, and `renew` with a newer document when there is something new in it.
export async function follow(first, tell, renew) {
  let { stamp } = first;
  let notBefore = 0;
  for (let misses = 0; ; await sleep(PERIOD_MS)) {
    try {
      const state = await (await ask("state")).json();
      misses = 0;
      tell(state);
      const isLast = state.outcome !== "running" && state.outcome !== "waiting";
      if (state.stamp === stamp || (performance.now() < notBefore && !isLast)) continue;
      const began = performance.now();
      await renew(new DOMParser().parseFromString(await (await ask("./")).text(), "text/html"));
      stamp = state.stamp;
      notBefore = performance.now() + PATIENCE * (performance.now() - began);
    } catch (error) {
      if (++misses >= 3) tell({ outcome: "lost", message: error instanceof TypeError ? "" : error.message });
    }
  }
}
