// SPDX-License-Identifier: GPL-3.0-or-later
// A sweep (`tetlap sweep`): what was measured against one key, a line for each combination of the others; runs
// that failed as crosses at the foot; and the whole table.

import * as Plot from "@observablehq/plot";
import { HUES } from "../view/colour.js";
import { format, h, raise } from "../dom.js";
import { powerOf } from "./plots.js";

const MARGIN = { left: 56, right: 16, top: 12, bottom: 42 };

// The quantity of which three values in one ratio give an order of convergence.
const ORDERED = "contact_force_last_N";

// What is plotted, if any run has it: key, title, unit, logarithmic.
const QUANTITIES = [
  ["contact_force_max_N", "Largest contact force", "N", false],
  [ORDERED, "Contact force at the end, with its observed order", "N", false],
  ["deepest_overlap_max", "Deepest overlap of an element", "", true],
  ["energy_gain_relative", "Gain of energy, over the scene’s", "", true],
  ["steps", "Steps", "", true],
  ["newton_iterations", "Newton iterations", "", true],
  ["wall_s", "Wall time", "s", true],
];

const COLUMNS = [
  ["outcome", "Outcome", null],
  ["contact_force_max_N", "Force", "N"],
  ["deepest_overlap_max", "Deepest", ""],
  ["energy_gain_relative", "Energy gain", ""],
  ["min_det_F", "Least det F", ""],
  ["steps", "Steps", ""],
  ["newton_failures", "Newton failed", ""],
  ["wall_s", "Wall time", "s"],
];

const isNumber = (value) => typeof value === "number" && Number.isFinite(value);
const shorten = (number) => (Math.abs(number) >= 1e5 ? number.toExponential() : String(number)).replace("e+", "e");
const textOf = (value) => (isNumber(value) ? shorten(Number(value.toPrecision(6))) : String(value));
const shortOf = (key) => key.replace(/^.*\./, "");

// The keys by what tells them apart: their last words, unless two have the same.
export function labelsOf(keys) {
  return keys.map((key) => (keys.filter((other) => shortOf(other) === shortOf(key)).length > 1 ? key : shortOf(key)));
}

// A line for each combination of the keys other than `along`: [{label, runs}], the runs in order of `along`.
export function linesOf(runs, keys, along) {
  const others = keys.filter((key) => key !== along);
  const labels = labelsOf(keys);
  const lines = new Map();
  for (const run of runs) {
    const label = others.map((key) => `${labels[keys.indexOf(key)]} ${textOf(run.set[key])}`).join(", ");
    lines.set(label, [...(lines.get(label) ?? []), run]);
  }
  return [...lines].map(([label, list]) => ({ label, runs: list.every((run) => isNumber(run.set[along])) ? [...list].sort((a, b) => a.set[along] - b.set[along]) : list }));
}

// Values over more than two powers of ten stand on a logarithmic axis.
const isWide = (values) => values.every((value) => value > 0) && Math.max(...values) >= 50 * Math.min(...values);

// Whole powers of ten where there are two of them, else the values themselves.
function ticksOf(places, width) {
  const distinct = [...new Set(places)].sort((a, b) => a - b);
  const most = Math.max(3, Math.round(width / 70));
  if (!isWide(places)) return distinct.filter((_, k) => k % Math.ceil(distinct.length / most) === 0);
  const [low, high] = [Math.ceil(Math.log10(distinct[0]) - 1e-9), Math.floor(Math.log10(distinct.at(-1)) + 1e-9)];
  return high > low ? Array.from({ length: high - low + 1 }, (_, k) => 10 ** (low + k)) : distinct.slice(0, most);
}

function tick(value) {
  const power = Math.log10(Math.abs(value));
  if (value > 0 && (power >= 4 || power < -2) && Math.abs(power - Math.round(power)) < 1e-9) return `10${raise(Math.round(power))}`;
  return format(value, "", 3);
}

// The observed orders at their dots, beside the line that comes from the neighbour.
function ordersOf(points, along, key, hue) {
  return points.map((run, k) => {
    const neighbour = points[k === 0 ? 1 : k - 1];
    const dy = neighbour && run[key] < neighbour[key] ? 13 : -11;
    return isNumber(run.order) ? Plot.text([run], { x: () => run.set[along], y: key, text: [`order ${run.order.toFixed(2)}`], fill: hue, dy, textAnchor: k === 0 ? "start" : "end", className: "order" }) : null;
  });
}

class SweepPlot {
  constructor(sweep, [key, title, unit, isLog], choice, state) {
    Object.assign(this, { sweep, key, title, unit, isLog, choice, state, isOrdered: key === ORDERED });
    this.area = h(".area");
    this.element = h("figure.plot", { id: `sweep-${key}` }, h("figcaption", h("h3", title, unit && h("span.unit", unit))), this.area);
    state.on(["theme"], () => this.draw());
    choice.on(["along"], () => this.draw());
    new ResizeObserver(() => this.draw()).observe(this.area);
  }

  draw() {
    const width = Math.round(this.area.clientWidth);
    if (width < 50) return;
    const { key, sweep, isLog } = this;
    const { along } = this.choice;
    const hues = HUES[this.state.theme];
    const lines = linesOf(sweep.runs, sweep.keys, along);
    const places = sweep.runs.map((run) => run.set[along]);
    const isNumeric = places.every(isNumber);
    const known = lines.map(({ label, runs }, k) => ({ label, hue: hues[k % hues.length], points: runs.filter((run) => isNumber(run[key]) && run.outcome === "finished" && !(isLog && !(run[key] > 0))) }));
    const failed = lines.flatMap(({ label, runs }) => runs.filter((run) => run.outcome === "failed").map((run) => ({ run, label })));
    const tell = (run, label) => `${shortOf(along)} ${textOf(run.set[along])}${label ? `, ${label}` : ""}: ${run.outcome === "failed" ? `failed: ${run.message ?? ""}` : format(run[key], this.unit)}`;
    const chart = Plot.plot({
      width,
      height: Math.round(Math.min(Math.max(width * 0.5, 200), 270)),
      marginLeft: MARGIN.left,
      marginRight: MARGIN.right,
      marginTop: MARGIN.top,
      marginBottom: MARGIN.bottom,
      style: { background: "transparent", fontFamily: "inherit", fontSize: "11px", overflow: "visible" },
      x: isNumeric
        ? { type: isWide(places) ? "log" : "linear", label: along, labelAnchor: "right", labelArrow: "right", inset: 8, tickSize: 0, ticks: ticksOf(places, width), tickFormat: tick }
        : { type: "point", domain: [...new Set(places.map(String))], label: along, tickSize: 0 },
      y: { type: isLog ? "log" : "linear", label: null, grid: true, nice: true, zero: !isLog, ticks: 5, tickSize: 0, tickFormat: isLog ? (value) => powerOf(value) || "" : (value) => format(value, "", 3) },
      marks: [
        ...known.map(({ points, hue }) => Plot.line(points, { x: (run) => (isNumeric ? run.set[along] : String(run.set[along])), y: key, stroke: hue, strokeWidth: 1.6 })),
        ...known.map(({ points, hue, label }) => Plot.dot(points, { x: (run) => (isNumeric ? run.set[along] : String(run.set[along])), y: key, fill: hue, r: 3.6, title: (run) => tell(run, label) })),
        ...(this.isOrdered && along === sweep.orderAlong ? known.flatMap(({ points, hue }) => ordersOf(points, along, key, hue)) : []),
        Plot.dot(failed, { x: ({ run }) => (isNumeric ? run.set[along] : String(run.set[along])), frameAnchor: "bottom", symbol: "times", stroke: "currentColor", r: 5, strokeWidth: 1.6, title: ({ run, label }) => tell(run, label) }),
      ],
    });
    chart.setAttribute("role", "img");
    chart.setAttribute("aria-label", `${this.title} against ${along}; the numbers are in the table below`);
    this.area.replaceChildren(chart);
  }
}

// The courses of forces, a line a run, coloured by its value of the key that is chosen.
class HistoryPlot {
  constructor(sweep, choice, state) {
    Object.assign(this, { sweep, choice, state, runs: sweep.runs.filter((run) => run.history) });
    this.area = h(".area");
    this.key = h("p.key-line");
    this.element = h("figure.plot", { id: "sweep-history" }, h("figcaption", h("h3", "Contact force over time", h("span.unit", "N"))), this.area, this.key);
    state.on(["theme"], () => this.draw());
    choice.on(["along"], () => this.draw());
    new ResizeObserver(() => this.draw()).observe(this.area);
  }

  draw() {
    const width = Math.round(this.area.clientWidth);
    if (width < 50) return;
    const { along } = this.choice;
    const hues = HUES[this.state.theme];
    const values = [...new Set(this.runs.map((run) => textOf(run.set[along])))];
    const hueOf = (run) => hues[values.indexOf(textOf(run.set[along])) % hues.length];
    const name = (run) => this.sweep.keys.map((key) => `${shortOf(key)} ${textOf(run.set[key])}`).join(", ");
    const points = (run) => run.history.time_s.map((time, k) => [time, run.history.force_N[k]]);
    const chart = Plot.plot({
      width,
      height: Math.round(Math.min(Math.max(width * 0.5, 200), 270)),
      marginLeft: MARGIN.left,
      marginRight: MARGIN.right,
      marginTop: MARGIN.top,
      marginBottom: MARGIN.bottom,
      style: { background: "transparent", fontFamily: "inherit", fontSize: "11px", overflow: "visible" },
      x: { label: "time, s", labelAnchor: "right", labelArrow: "none", tickSize: 0, ticks: Math.max(3, Math.round(width / 90)) },
      y: { label: null, grid: true, nice: true, zero: true, ticks: 5, tickSize: 0, tickFormat: (value) => format(value, "", 3) },
      marks: this.runs.map((run) => Plot.line(points(run), { stroke: hueOf(run), strokeWidth: 1.3, strokeOpacity: 0.8, title: () => name(run) })),
    });
    chart.setAttribute("role", "img");
    chart.setAttribute("aria-label", `Contact force over time, a line a run, coloured by ${along}`);
    this.area.replaceChildren(chart);
    this.key.replaceChildren(...values.map((value, k) => h("span", h("span.dot", { style: `background:${hues[k % hues.length]}` }), `${shortOf(along)} ${value}`)));
  }
}

function buildKey(sweep, choice, state) {
  const key = h("p.key-line");
  const show = () => {
    const lines = linesOf(sweep.runs, sweep.keys, choice.along);
    const hues = HUES[state.theme];
    const entries = lines.length > 1 ? lines.map(({ label }, k) => h("span", h("span.dot", { style: `background:${hues[k % hues.length]}` }), label)) : [];
    const failed = sweep.runs.filter((run) => run.outcome === "failed").length;
    key.replaceChildren(...entries, ...(failed > 0 ? [h("span", "× failed")] : []));
  };
  state.on(["theme"], show);
  choice.on(["along"], show);
  show();
  return key;
}

function buildTable(sweep) {
  const labels = labelsOf(sweep.keys);
  const head = h("tr", labels.map((label) => h("th", { scope: "col" }, label)), COLUMNS.map(([, title, unit]) => h(unit === null ? "th" : "th.number", { scope: "col" }, title)), h("th", { scope: "col" }, "Message"));
  const line = (run) =>
    h(
      "tr",
      { "data-outcome": run.outcome },
      sweep.keys.map((key) => h("th", { scope: "row" }, textOf(run.set[key]))),
      COLUMNS.map(([key, , unit]) => (unit === null ? h("td", run[key]) : h("td.number", format(run[key], unit)))),
      h("td.message", run.message ?? ""),
    );
  return h(".scroll", { tabindex: 0, role: "region", "aria-label": "Table of all runs" }, h("table.sweep", h("thead", head), h("tbody", sweep.runs.map(line))));
}

export const sweepTitle = (sweep) => `Sweep of ${(sweep.scene ?? "a scene").replace(/^.*\//, "").replace(/\.ya?ml$/, "")}`;

function countsOf(runs) {
  const words = ["finished", "failed", "running", "interrupted", "waiting"];
  return words.map((word) => [runs.filter((run) => run.outcome === word).length, word]).filter(([count]) => count > 0).map(([count, word]) => `${count} ${word}`).join(", ");
}

export function buildSweep(given, state, createState) {
  const runs = given.runs ?? [];
  if (runs.length === 0) return null;
  const sweep = { runs, keys: (given.axes ?? []).map((axis) => axis.key), orderAlong: given.order_along };
  const longest = [...(given.axes ?? [])].sort((a, b) => b.values.length - a.values.length)[0];
  const choice = createState({ along: longest.key });
  const select = h("select", { id: "along", change: () => choice.set({ along: select.value }) }, sweep.keys.map((key) => h("option", { value: key, selected: key === choice.along }, key)));
  const shown = QUANTITIES.filter(([key]) => runs.some((run) => isNumber(run[key]) && run[key] > 0) && (key !== ORDERED || sweep.orderAlong));
  return h(
    "section.block",
    { id: "sweep" },
    h("h2", "Runs over a grid"),
    h("p.lead", `${runs.length} runs of ${given.scene}: ${countsOf(runs)}.`),
    sweep.keys.length > 1 && h(".controls", h(".control", h("label", { for: "along" }, "Against"), select)),
    buildKey(sweep, choice, state),
    h(".plots", shown.map((quantity) => new SweepPlot(sweep, quantity, choice, state).element), runs.some((run) => run.history) && new HistoryPlot(sweep, choice, state).element),
    h("h3.after", "All runs"),
    buildTable(sweep),
  );
}
