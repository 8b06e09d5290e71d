// SPDX-License-Identifier: GPL-3.0-or-later
// Quantities over time, each with a cursor at the page's time; dragging in a plot moves it.

import * as Plot from "@observablehq/plot";
import { HUES } from "./colour.js";
import { indexAt } from "./data.js";
import { format, h, raise, svg } from "./dom.js";

const MARGIN = { left: 52, right: 12, top: 10, bottom: 26 };
const MAX_FORCES = 5;
const DASH = "4 3"; // of run B where the hue says what the quantity is

const byRun = (run, theme) => HUES[theme][run.index];

// Each plot's series: [{run, label, hue: number | null (the run's), values, times}].
function forceSeries(runs) {
  const keys = [...new Set(runs.flatMap((run) => run.forces.map((force) => force.key)))].slice(0, MAX_FORCES);
  const isOne = keys.length === 1 && runs.length > 1;
  return keys.flatMap((key, hue) =>
    runs.flatMap((run) => {
      const force = run.forces.find((one) => one.key === key);
      return force ? [{ run, label: isOne ? run.label : force.label, hue: isOne ? null : hue, values: force.values, times: run.times }] : [];
    }),
  );
}

const ENERGIES = [
  ["kinetic_J", "kinetic"],
  ["elastic_J", "elastic"],
  ["contact_J", "contact"],
  ["gravity_J", "gravity"],
  ["dissipated_J", "dissipated"],
];

function energySeries(runs) {
  return ENERGIES.flatMap(([column, label], hue) =>
    runs.flatMap((run) => {
      const values = run.columns[column];
      if (!values || values.every((value) => Math.abs(value - values[0]) === 0)) return [];
      return [{ run, label, hue, values: values.map((value) => value - values[0]), times: run.times }];
    }),
  );
}

const positive = (values) => values.map((value) => (value > 0 ? value : NaN));

function stepSeries(runs) {
  return runs.flatMap((run) => {
    const values = run.columns.step_s;
    return values ? [{ run, label: run.label, hue: null, values: positive(values), times: run.times }] : [];
  });
}

// How far the audited total has left its first value, over the scene's energy.
function driftSeries(runs) {
  return runs.flatMap((run) => {
    const total = run.columns.total_J;
    const scale = run.summary?.energy_scale;
    if (!total || !(scale > 0)) return [];
    const values = positive(total.map((value) => Math.abs(value - total[0]) / scale));
    const label = runs.length > 1 ? `energy, ${run.label}` : "energy";
    return [{ run, label, hue: null, values, times: run.times }];
  });
}

// Forces of B against A, over A's largest; on A's lines where B has one at the same time.
function forceDifference([a, b]) {
  if (!b || a.forces.length === 0) return [];
  const most = a.forces[0].most;
  const values = Array.from(a.times, (time, i) => {
    const j = indexAt(b.times, time);
    let sum = 0;
    for (const key of new Set([...a.forces, ...b.forces].map((force) => force.key)))
      for (const axis of ["x", "y", "z"]) {
        const column = `force_${key}_${axis}_N`;
        sum += ((b.columns[column]?.[j] ?? 0) - (a.columns[column]?.[i] ?? 0)) ** 2;
      }
    return Math.sqrt(sum) / most;
  });
  return [{ run: a, label: "force, B − A", hue: 2, values: positive(values), times: a.times }];
}

function distance(difference, size) {
  if (!difference || !(size > 0)) return [];
  const values = positive(difference.rms_m.map((value) => value / size));
  return [{ run: null, label: "vertices, B − A", hue: 3, values, times: difference.time_s }];
}

// The plots that these runs have something for.
export function listPlots(data, size) {
  const { runs, difference } = data;
  const plots = [
    { id: "force", title: "Contact force", unit: "N", series: forceSeries(runs) },
    { id: "energy", title: "Energy, change since the start", unit: "J", series: energySeries(runs) },
    {
      id: "error",
      title: "Error",
      note: runs.length > 1 ? "drift of the total energy; B against A: force over the largest, vertices (rms) over the scene’s size" : "drift of the total energy over the scene’s energy",
      unit: "",
      isLog: true,
      series: [...driftSeries(runs), ...forceDifference(runs), ...distance(difference, size)],
    },
    { id: "step", title: "Step size", unit: "s", isLog: true, series: stepSeries(runs) },
  ];
  return plots.filter((plot) => plot.series.some((one) => one.values.some(Number.isFinite)));
}

// When runs differ most from the first: in their contact forces, else nothing is known.
export function momentOf(runs) {
  let [most, moment] = [0, undefined];
  for (const other of runs.slice(1))
    for (const { values, times } of forceDifference([runs[0], other]))
      values.forEach((value, i) => value > most && ([most, moment] = [value, times[i]]));
  return moment;
}

export class TimePlot {
  constructor(plot, runs, state, seek) {
    Object.assign(this, { plot, runs, state, seek });
    this.area = h(".area");
    this.rows = plot.series.map((one) => this.buildRow(one));
    this.element = h(
      "figure.plot",
      { id: `plot-${plot.id}` },
      h("figcaption", h("h3", plot.title, plot.unit && h("span.unit", plot.unit))),
      this.area,
      h(".readings", this.rows.map((row) => row.element)),
      ...(plot.note ? [h("p.note", plot.note)] : []),
    );
    state.on(["time"], () => this.showTime());
    state.on(["theme"], () => this.draw());
    new ResizeObserver(() => this.draw()).observe(this.area);
  }

  hueOf(one) {
    return one.hue === null ? byRun(one.run, this.state.theme) : HUES[this.state.theme][one.hue];
  }

  isDashed(one) {
    return one.hue !== null && one.run?.index === 1;
  }

  buildRow(one) {
    const line = svg("svg", { class: "key", viewBox: "0 0 18 8", "aria-hidden": "true" }, svg("line", { x1: 1, x2: 17, y1: 4, y2: 4 }));
    const value = h("output");
    const owner = one.hue !== null && this.runs.length > 1 && one.run && !one.label.includes("−") ? h("span.owner", one.run.label) : null;
    return { one, line, value, element: h("span.reading", line, h("span", one.label), owner, value) };
  }

  draw() {
    const width = Math.round(this.area.clientWidth);
    if (width < 50) return;
    const { plot } = this;
    const marks = plot.series.map((one) =>
      Plot.lineY(one.values, {
        x: one.times,
        y: one.values,
        stroke: this.hueOf(one),
        strokeWidth: 1.6,
        strokeDasharray: this.isDashed(one) ? DASH : null,
        strokeLinejoin: "round",
      }),
    );
    const height = Math.round(Math.min(Math.max(width * 0.42, 170), 250));
    const chart = Plot.plot({
      width,
      height,
      marginLeft: MARGIN.left,
      marginRight: MARGIN.right,
      marginTop: MARGIN.top,
      marginBottom: MARGIN.bottom,
      style: { background: "transparent", fontFamily: "inherit", fontSize: "11px", overflow: "visible" },
      x: { label: null, ticks: Math.max(3, Math.round(width / 110)), tickSize: 0, tickPadding: 8, tickFormat: (t) => format(t, "", 4) },
      y: {
        label: null,
        type: plot.isLog ? "log" : "linear",
        grid: true,
        ...(plot.isLog ? logScale(plot.series) : { ticks: 5, nice: true }),
        tickSize: 0,
        tickFormat: plot.isLog ? powerOf : (value) => format(value, "", 3),
      },
      marks: [plot.isLog ? null : Plot.ruleY([0], { strokeOpacity: 0.35 }), ...marks],
    });
    chart.setAttribute("role", "img");
    chart.setAttribute("aria-label", `${plot.title} over time`);
    this.x = chart.scale("x");
    this.y = chart.scale("y");
    this.addCursor(chart, width, height);
    this.area.replaceChildren(chart);
    for (const { one, line } of this.rows) {
      line.firstChild.setAttribute("stroke", this.hueOf(one));
      line.firstChild.setAttribute("stroke-dasharray", this.isDashed(one) ? DASH : "none");
    }
    this.showTime();
  }

  addCursor(chart, width, height) {
    this.line = svg("line", { class: "cursor", y1: MARGIN.top, y2: height - MARGIN.bottom });
    this.dots = this.plot.series.map((one) => svg("circle", { class: "dot", r: 3.2, fill: this.hueOf(one) }));
    const field = svg("rect", {
      class: "field",
      x: MARGIN.left,
      y: 0,
      width: width - MARGIN.left - MARGIN.right,
      height,
      fill: "transparent",
    });
    const move = (event) => this.seek(this.x.invert(event.clientX - chart.getBoundingClientRect().left));
    field.addEventListener("pointerdown", (event) => {
      field.setPointerCapture(event.pointerId);
      move(event);
    });
    field.addEventListener("pointermove", (event) => event.buttons && move(event));
    chart.append(this.line, ...this.dots, field);
  }

  showTime() {
    if (!this.line) return;
    const { time } = this.state;
    const x = this.x.apply(time);
    this.line.setAttribute("x1", x);
    this.line.setAttribute("x2", x);
    this.rows.forEach(({ one, value }, k) => {
      const i = indexAt(one.times, time);
      const number = one.values[i];
      const isShown = Number.isFinite(number);
      value.value = format(number, this.plot.unit);
      this.dots[k].style.display = isShown ? "" : "none";
      if (!isShown) return;
      this.dots[k].setAttribute("cx", this.x.apply(one.times[i]));
      this.dots[k].setAttribute("cy", this.y.apply(number));
    });
  }
}

// From a power of ten to a power of ten, with at most six of them labelled.
function logScale(series) {
  const values = series.flatMap((one) => Array.from(one.values)).filter((value) => value > 0);
  const low = Math.floor(Math.log10(Math.min(...values)));
  const high = Math.max(Math.ceil(Math.log10(Math.max(...values))), low + 1);
  const step = Math.max(1, Math.ceil((high - low) / 5));
  const ticks = [];
  for (let power = high; power >= low; power -= step) ticks.unshift(10 ** power);
  return { domain: [10 ** low, 10 ** high], ticks };
}

export function powerOf(value) {
  const power = Math.round(Math.log10(value));
  if (Math.abs(value / 10 ** power - 1) > 1e-6) return "";
  return power >= 0 && power <= 3 ? String(10 ** power) : `10${raise(power)}`;
}
