// SPDX-License-Identifier: GPL-3.0-or-later
// Quantities over time, each with a cursor at the page's time; dragging in a plot moves it.

import * as Plot from "@observablehq/plot";
import { HUES } from "../view/colour.js";
import { indexAt, ownersOf } from "../data/data.js";
import { format, h, raise, svg } from "../dom.js";
import { groupsOf, stripe } from "./coincide.js";

const MARGIN = { left: 52, right: 12, top: 10, bottom: 26 };
const MAX_FORCES = 5; // of one run, in one plot
const MAX_FORCE_PLOTS = 3;
const DASH = "4 3"; // of run B where the hue says what the quantity is

const byRun = (run, theme) => HUES[theme][run.index % HUES.light.length];

// What rows a frame would miss: the largest force between any two after any step since the row before. Its maximum is
// the run's. Left out where every step has its row.
function peakSeries(runs, label = "largest since the last row") {
  return runs.flatMap((run) => {
    const values = run.columns.contact_force_peak_N;
    const known = run.forces.length > 0 && values ? run.times.map((_, i) => Math.max(...run.forces.map((force) => force.values[i]))) : [];
    if (!known.some((value, i) => values[i] > 1.001 * value)) return [];
    return [{ run, label, hue: MAX_FORCES, values, times: run.times }];
  });
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
    const label = runs.length === 2 ? `energy of ${run.label}` : runs.length > 2 ? run.label : "energy";
    return [{ run, label, hue: null, values, times: run.times }];
  });
}

// Forces of b against a, over a's largest; on a's lines, as far as both have come.
function forceDifference(a, b) {
  if (a.forces.length === 0 || b.times.length === 0) return null;
  const most = a.forces[0].most;
  const end = b.times[b.times.length - 1] * (1 + 1e-9);
  const keys = new Set([...a.forces, ...b.forces].map((force) => force.key));
  return Array.from(a.times, (time, i) => {
    if (time > end) return NaN;
    const j = indexAt(b.times, time);
    let sum = 0;
    for (const key of keys)
      for (const axis of ["x", "y", "z"]) {
        const column = `force_${key}_${axis}_N`;
        sum += ((b.columns[column]?.[j] ?? 0) - (a.columns[column]?.[i] ?? 0)) ** 2;
      }
    return Math.sqrt(sum) / most;
  });
}

// Each run but the reference with its differences in force.
function forceDifferences({ runs, reference = 0 }) {
  const first = runs[reference];
  return runs
    .filter((run) => run !== first)
    .map((run) => ({ run, times: first.times, values: forceDifference(first, run) }))
    .filter(({ values }) => values);
}

const isPair = (runs) => runs.length === 2;

function forceErrorSeries(data) {
  return forceDifferences(data).map(({ run, times, values }) => ({ run: isPair(data.runs) ? null : run, label: isPair(data.runs) ? "forces apart" : run.label, hue: isPair(data.runs) ? 2 : null, values: positive(values), times }));
}

// The band reaches from the root mean square to the farthest vertex.
function distanceSeries({ runs, differences = [] }, size) {
  if (!(size > 0)) return [];
  const over = (values) => positive(values.map((value) => value / size));
  return differences.map(({ run, time_s, rms_m, max_m }) => ({
    run: isPair(runs) ? null : runs[run],
    label: isPair(runs) ? "vertices apart" : runs[run].label,
    hue: isPair(runs) ? 3 : null,
    values: over(rms_m),
    upper: over(max_m),
    times: time_s,
  }));
}

// What compare's audit measured in single states of the reference's run, over the largest of its forces there: where a
// force begins, its relative error says nothing.
function auditSeries(data, kind) {
  const owners = ownersOf(data, HUES.light.length);
  const rows = (data.comparison ?? []).filter((row) => row.audit_series?.[kind]);
  return rows.map((row) => {
    const { time_s, force_N, [kind]: errors } = row.audit_series;
    const most = force_N?.reduce((a, b) => Math.max(a, b), 0);
    const values = positive(most > 0 ? errors.map((error, i) => (error * force_N[i]) / most) : errors);
    return { ...owners.get(row), label: row.model, values, times: time_s };
  });
}

// A plot's series: [{run, label, hue: number | null (the run's), values, times}]. Of one run all forces stand in one plot,
// in which the hue says between whom. Of several there is a plot for each two bodies, in which the hue says which run it is.
function forcePlots(runs) {
  const plot = { id: "force", title: "Contact force", unit: "N" };
  const seriesOf = (run, { values }, label, hue) => ({ run, label, hue, values, times: run.times });
  if (runs.length <= 1) {
    const series = runs.flatMap((run) => run.forces.slice(0, MAX_FORCES).map((force, hue) => seriesOf(run, force, force.label, hue)));
    return [{ ...plot, series: [...series, ...peakSeries(runs)] }];
  }
  const keys = [...new Set(runs.flatMap((run) => run.forces).sort((a, b) => b.most - a.most).map((force) => force.key))];
  const peaks = isPair(runs) ? peakSeries(runs, keys.length > 1 ? "largest since the last row, of any two" : undefined) : [];
  return keys.slice(0, MAX_FORCE_PLOTS).map((key, k) => {
    const owners = runs.flatMap((run) => run.forces.filter((force) => force.key === key).map((force) => ({ run, force })));
    const series = owners.map(({ run, force }) => seriesOf(run, force, run.label, null));
    return { ...plot, id: k ? `force-${k}` : "force", title: `Contact force, ${owners[0].force.label}`, series: k ? series : [...series, ...peaks] };
  });
}

function energyPlots(runs) {
  if (runs.length <= 2) return [{ id: "energy", title: "Energy, change since the start", unit: "J", series: energySeries(runs) }];
  return ENERGIES.slice(0, 2).map(([column, label]) => ({
    id: `energy-${label}`,
    title: `Energy, ${label}`,
    unit: "J",
    series: runs.filter((run) => run.columns[column]).map((run) => ({ run, label: run.label, hue: null, values: run.columns[column], times: run.times })),
  }));
}

function errorPlots(data, size) {
  const { runs, reference = 0 } = data;
  const log = { unit: "", isLog: true, isError: true };
  const drift = { ...log, id: "drift", title: "Drift of the total energy", note: "over the scene’s energy", series: driftSeries(runs) };
  if (runs.length < 2) return [{ ...drift, id: "error", title: "Error", note: "drift of the total energy over the scene’s energy" }];
  if (isPair(runs)) {
    const [first, other] = [runs[reference], runs[1 - reference]];
    const note = `drift of the total energy over the scene’s; ${other.label} against ${first.label}: forces over the largest, vertices (root mean square; the band reaches to the farthest) over the scene’s size`;
    return [{ ...log, id: "error", title: "Error", note, series: [...driftSeries(runs), ...forceErrorSeries(data), ...distanceSeries(data, size)] }];
  }
  const than = runs[reference].label;
  return [
    { ...log, id: "error", title: `Forces against ${than}`, note: "each model on its own trajectory; over the largest force of the reference", series: forceErrorSeries(data) },
    { ...log, id: "distance", title: `Vertices against ${than}`, note: "root mean square over the scene’s size; the band reaches to the farthest vertex", series: distanceSeries(data, size) },
    drift,
  ];
}

// The plots that these runs have something for.
export function listPlots(data, size) {
  const { runs } = data;
  const plots = [
    ...forcePlots(runs),
    ...energyPlots(runs),
    ...errorPlots(data, size),
    { id: "audit", title: "Audit: nodal forces", note: "difference in the same states, those of the reference’s run, over its largest force in them", unit: "", isLog: true, isError: true, series: auditSeries(data, "force") },
    { id: "step", title: "Step size", unit: "s", isLog: true, series: stepSeries(runs) },
  ];
  return plots.filter((plot) => plot.series.some((one) => one.values.some(Number.isFinite)));
}

// When runs differ most from the reference: in their contact forces, else in their vertices.
export function momentOf(data) {
  let [most, moment] = [0, undefined];
  const look = (values, times) => values.forEach((value, i) => value > most && ([most, moment] = [value, times[i]]));
  for (const { values, times } of forceDifferences(data)) look(values, times);
  if (moment === undefined) for (const { rms_m, time_s } of data.differences ?? []) look(rms_m, time_s);
  return moment;
}

export class TimePlot {
  constructor(plot, runs, state, seek) {
    Object.assign(this, { plot, runs, state, seek });
    const times = [...runs, ...plot.series].flatMap((one) => [one.times[0], one.times.at(-1)]).filter(Number.isFinite);
    this.extent = [Math.min(...times), Math.max(...times)]; // the same for all plots of the page
    this.area = h(".area");
    this.together = h("p.note.together", { hidden: true });
    this.rows = plot.series.map((one) => this.buildRow(one));
    this.element = h(
      "figure.plot",
      { id: `plot-${plot.id}` },
      h("figcaption", h("h3", plot.title, plot.unit && [" ", h("span.unit", plot.unit)])),
      this.area,
      h(".readings", this.rows.map((row) => row.element)),
      this.together,
      ...(plot.note ? [h("p.note", plot.note)] : []),
    );
    state.on(["time"], () => this.showTime());
    state.on(["theme"], () => this.draw());
    new ResizeObserver(() => this.draw()).observe(this.area);
  }

  hueOf(one) {
    return one.hue === null ? byRun(one.run, this.state.theme) : HUES[this.state.theme][one.hue % HUES.light.length];
  }

  // Run B where the hue says what the quantity is; runs beyond the hues that there are.
  isDashed(one) {
    return one.hue !== null ? one.run?.index === 1 : one.run.index >= HUES.light.length;
  }

  buildRow(one) {
    const line = svg("svg", { class: "key", viewBox: "0 0 18 8", "aria-hidden": "true" }, svg("line", { x1: 1, x2: 17, y1: 4, y2: 4 }));
    const value = h("output", { "aria-live": "off" }); // it changes with every frame
    const owner = one.hue !== null && this.runs.length > 1 && one.run ? h("span.owner", one.run.label) : null;
    return { one, line, value, element: h("span.reading", line, h("span.name", one.label, owner), value) };
  }

  draw() {
    const width = Math.round(this.area.clientWidth);
    if (width < 50) return;
    const { plot } = this;
    const bands = plot.series
      .filter((one) => one.upper)
      .map((one) => Plot.areaY(one.values, { x: one.times, y1: one.values, y2: one.upper, fill: this.hueOf(one), fillOpacity: 0.16 }));
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
      x: { domain: this.extent, label: null, ticks: Math.max(3, Math.round(width / 110)), tickSize: 0, tickPadding: 8, tickFormat: (t) => format(t, "", 4) },
      y: {
        label: null,
        type: plot.isLog ? "log" : "linear",
        grid: true,
        ...(plot.isLog ? logScale(plot.series, plot.isError) : { ticks: 5, nice: true }),
        tickSize: 0,
        tickFormat: plot.isLog ? powerOf : (value) => format(value, "", 3),
      },
      marks: [plot.isLog ? null : Plot.ruleY([0], { strokeOpacity: 0.35 }), ...bands, ...marks],
    });
    this.x = chart.scale("x");
    this.y = chart.scale("y");
    this.showTogether(chart);
    chart.setAttribute("role", "img");
    chart.setAttribute("aria-label", `${plot.title} over time: ${plot.series.map((one) => one.label).join(", ")}. ${this.together.textContent}`.trim());
    this.addCursor(chart, width, height);
    this.area.replaceChildren(chart);
    for (const { one, line } of this.rows) {
      line.firstChild.setAttribute("stroke", this.hueOf(one));
      line.firstChild.setAttribute("stroke-dasharray", this.isDashed(one) ? DASH : "none");
    }
    this.showTime();
  }

  nameOf(one) {
    return one.hue !== null && this.runs.length > 1 && one.run ? `${one.label} ${one.run.label}` : one.label;
  }

  // One quantity of both runs of a pair is named once for all such groups.
  describe(groups) {
    const { series } = this.plot;
    const isOfBoth = (group) => group.length === 2 && group.every((k) => series[k].hue !== null && series[k].label === series[group[0]].label);
    const both = groups.filter(isOfBoth).map(([k]) => series[k].label);
    const others = groups.filter((group) => !isOfBoth(group)).map((group) => `Curves that coincide: ${group.map((k) => this.nameOf(series[k])).join(", ")}.`);
    return [...(both.length ? [`The same curve for both runs: ${both.join(", ")}.`] : []), ...others].join(" ");
  }

  // Curves that would hide each other, in stripes where their hues differ, and in words.
  showTogether(chart) {
    const { series } = this.plot;
    const groups = groupsOf(series, (time) => this.x.apply(time), (value) => this.y.apply(value));
    const lines = [...chart.querySelectorAll("[aria-label=line]")].map((mark) => mark.querySelector("path") ?? mark);
    for (const group of groups) {
      const hues = [...new Set(group.map((k) => this.hueOf(series[k])))];
      if (hues.length < 2) continue;
      for (const k of group) {
        const { array, offset } = stripe(hues.indexOf(this.hueOf(series[k])), hues.length);
        lines[k].setAttribute("stroke-dasharray", array);
        lines[k].setAttribute("stroke-dashoffset", offset);
        lines[k].setAttribute("stroke-linecap", "butt");
      }
    }
    this.together.hidden = groups.length === 0;
    this.together.textContent = this.describe(groups);
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

// Errors are shares of a largest value: what is this small a share of the largest error, or rounding of that value, is
// drawn at the lower end.
const ERROR_DECADES = 8;
const ROUNDING_POWER = -16;

// From a power of ten to a power of ten, with at most six of them labelled.
export function logScale(series, isError) {
  const values = series.flatMap((one) => [...one.values, ...(one.upper ?? [])]).filter((value) => value > 0);
  const top = Math.ceil(Math.log10(values.reduce((a, b) => Math.max(a, b))));
  const bottom = Math.floor(Math.log10(values.reduce((a, b) => Math.min(a, b))));
  const low = isError ? Math.max(bottom, Math.min(Math.max(top - ERROR_DECADES, ROUNDING_POWER), top - 1)) : bottom;
  const high = Math.max(top, low + 1);
  const step = Math.max(1, Math.ceil((high - low) / 5));
  const ticks = [];
  for (let power = high; power >= low; power -= step) ticks.unshift(10 ** power);
  return { domain: [10 ** low, 10 ** high], ticks, clamp: isError };
}

export function powerOf(value) {
  const power = Math.round(Math.log10(value));
  if (Math.abs(value / 10 ** power - 1) > 1e-6) return "";
  return power >= 0 && power <= 3 ? String(10 ** power) : `10${raise(power)}`;
}
