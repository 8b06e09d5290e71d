// SPDX-License-Identifier: GPL-3.0-or-later
// Time: play, step, scrub. One for all views and plots.

import { indexAt } from "../data/data.js";
import { format, h, svg } from "../dom.js";

const SECONDS = 8; // that a whole run takes at speed 1
const SPEEDS = [0.25, 0.5, 1, 2];

const icon = (path) => svg("svg", { viewBox: "0 0 16 16", "aria-hidden": "true" }, svg("path", { d: path }));
const PLAY = "M4 2.5v11l9.5-5.5z";
const PAUSE = "M3.5 2.5h3v11h-3zM9.5 2.5h3v11h-3z";

// The largest force of each run over time, drawn faintly behind the scrubber: where contact is.
function trace(runs, times) {
  const [first, last] = [times[0], times[times.length - 1]];
  const most = Math.max(...runs.flatMap((run) => run.forces.map((force) => force.most)));
  if (!(most > 0) || !(last > first)) return null;
  const paths = runs.map((run) => {
    const points = Array.from(run.times, (time, i) => {
      const force = Math.max(...run.forces.map((one) => one.values[i]), 0);
      return `${(((time - first) / (last - first)) * 1000).toFixed(1)},${(30 - 28 * Math.sqrt(force / most)).toFixed(2)}`;
    });
    return svg("polyline", { points: points.join(" "), style: `stroke:var(--run-${run.letter})` });
  });
  return svg("svg", { class: "trace", viewBox: "0 0 1000 30", preserveAspectRatio: "none", "aria-hidden": "true" }, ...paths);
}

export class Transport {
  constructor(runs, times, state) {
    Object.assign(this, { times, state });
    this.element = this.build(runs);
    state.on(["time"], () => this.show());
    this.show();
  }

  build(runs) {
    const last = this.times.length - 1;
    this.button = h("button.play", { type: "button", "data-place": "play", "aria-label": "Play", click: () => this.toggle() }, icon(PLAY));
    this.range = h("input.scrub", {
      type: "range",
      "data-place": "time",
      min: 0,
      max: last,
      step: 1,
      "aria-label": "Time",
      input: () => this.seek(this.range.valueAsNumber),
    });
    this.readout = h("output.time", { "aria-live": "off" });
    const speed = h(
      "select.speed",
      { "aria-label": "Speed", change: () => (this.speed = Number(speed.value)) },
      SPEEDS.map((value) => h("option", { value, selected: value === 1 }, `${value}×`)),
    );
    this.speed = 1;
    return h(".transport", { role: "group", "aria-label": "Time" }, this.button, h(".track", trace(runs, this.times), this.range), this.readout, speed);
  }

  get index() {
    return indexAt(this.times, this.state.time);
  }

  seek(index) {
    const last = this.times.length - 1;
    this.state.set({ time: this.times[Math.min(Math.max(index, 0), last)] });
  }

  step(by) {
    this.pause();
    this.seek(this.index + by);
  }

  toggle() {
    if (this.state.isPlaying) this.pause();
    else this.play();
  }

  play() {
    const last = this.times.length - 1;
    if (last < 1) return;
    if (this.index === last) this.seek(0);
    this.place = this.index;
    this.before = performance.now();
    this.state.set({ isPlaying: true });
    this.showButton(PAUSE, "Pause");
    const tick = (now) => {
      if (!this.state.isPlaying) return;
      this.place += ((now - this.before) / 1000) * this.speed * (last / SECONDS);
      this.before = now;
      this.seek(Math.floor(this.place));
      if (this.place >= last) this.pause();
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  pause() {
    this.state.set({ isPlaying: false });
    this.showButton(PLAY, "Play");
  }

  showButton(path, label) {
    this.button.setAttribute("aria-label", label);
    this.button.replaceChildren(icon(path));
  }

  show() {
    const { index, times } = this;
    const last = times.length - 1;
    this.range.value = index;
    this.range.style.setProperty("--done", `${last ? (100 * index) / last : 0}%`);
    this.range.setAttribute("aria-valuetext", format(times[index], "s"));
    this.readout.value = `${times[index].toFixed(decimalsOf(times))} s`;
  }
}

// As many decimals as tell two neighbouring times apart.
function decimalsOf(times) {
  const step = times.length > 1 ? (times[times.length - 1] - times[0]) / (times.length - 1) : 1;
  return Math.min(Math.max(Math.ceil(-Math.log10(step)) + 1, 1), 9);
}
