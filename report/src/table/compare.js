// SPDX-License-Identifier: GPL-3.0-or-later
// compare.json (docs/summary.md) as tables: the audit, which compares the models with the reference in the same
// states, and their own runs. A run that did not reach the end is marked.

import { ownersOf } from "../data/data.js";
import { count, format, h, nameCell, scrolled, swatchOf, swatchOfHue } from "../dom.js";
import { HUES } from "../view/colour.js";

const AUDITS = [
  ["audit_volume_error", "Volumes V"],
  ["audit_gradient_error", "Forces of pairs"],
  ["audit_force_error", "Nodal forces"],
  ["audit_total_force_error", "Total forces"],
];

const SUMS = "sum of differences over sum of sizes, over all audited states, which weigh by their size";
const WORST = "the largest relative error of a state, and its time; it may belong to a state with next to no force";

const percent = (share) => (share == null ? "–" : `${format(100 * share, "%", 3)}`);

// Errors of two figures, which stand below each other.
function errorOf(share) {
  const value = 100 * share;
  return value >= 0.01 && value < 99.5 ? `${value.toPrecision(2)}\u2009%` : format(value, "%", 2);
}

const RUNS = [
  ["Reached", (row) => percent(row.share_reached)],
  ["Frames", (row) => count(row.frames_compared)],
  ["Force error", (row) => format(row.force_error_l2), "‖Δf‖ / ‖f‖ over these frames, each model on its own trajectory"],
  ["max", (row) => format(row.force_error_max), "largest difference over the largest force"],
  ["Path error", (row) => format(row.trajectory_error), "root mean square over vertices and frames, over the smallest body’s diagonal"],
  ["Energy gain", (row) => format(row.energy_gain_relative)],
  ["Steps", (row) => count(row.summary?.steps)],
  ["Wall time", (row) => format(row.wall_s, "s")],
  ["Overlap share", (row) => percent(row.summary?.phases && row.summary.phases.overlap / row.wall_s), "of the overlap model in the wall time"],
];

function nameOf(row, owners) {
  const { run, hue } = owners.get(row);
  return [run ? swatchOf(run) : swatchOfHue(hue), nameCell(row.model), row.model === row.reference ? " (reference)" : ""];
}

function table(caption, heads, bodies) {
  const head = h("tr", heads.map(([label, isText, help]) => h(isText ? "th" : "th.number", { scope: "col", title: help }, label)));
  return scrolled(caption, h("caption", caption), h("thead", head), bodies.map((rows) => h("tbody", rows.map((cells) => h("tr", cells)))));
}

// Why there is no audit, or that it is of few states.
function auditNote(rows) {
  const row = rows.find((one) => one.audit_told);
  return row ? h("p.note", { id: "audit-told" }, `Audit: ${row.audits > 0 || rows.some((one) => one.audits > 0) ? "" : "–; "}${row.audit_told}.`) : null;
}

const AUDIT_HEADS = [["Model", true], ["Errors of", true], ["Sums", false, SUMS], ["Median", false, "the median state"], ["Worst", false, WORST], ["at", false], ["States", false, "audited"]];

// A group of rows a model, a row a quantity.
function auditTable(rows, owners) {
  const audited = rows.filter((row) => row.audits > 0);
  if (audited.length === 0) return null;
  const cellsOf = (row) => AUDITS.map(([key, label], k) => [
    k === 0 && h("th", { scope: "rowgroup", rowspan: AUDITS.length }, nameOf(row, owners)),
    h("th", { scope: "row" }, label),
    [row[key], row[`${key}_median`], row[`${key}_worst`]].map((value) => h("td.number", errorOf(value))),
    h("td.number", format(row[`${key}_worst_time`], "s")),
    k === 0 && h("td.number", { rowspan: AUDITS.length }, count(row.audits)),
  ]);
  return table(`Audit: errors against ${audited[0].reference} in the same states of its run: of sums over them, of the median and of the worst state`, AUDIT_HEADS, audited.map(cellsOf));
}

function runTable(rows, owners) {
  const driven = rows.filter((row) => row.summary);
  const heads = [["Model", true], ["Outcome", true], ...RUNS.map(([label, , help]) => [label, false, help])];
  const cellsOf = (row) => [
    h("th", { scope: "row" }, nameOf(row, owners)),
    h("td.outcome", { "data-outcome": row.outcome, title: row.message }, row.outcome),
    RUNS.map(([, value]) => h("td.number", value(row))),
  ];
  return table("Own runs: each model on its own trajectory", heads, [driven.map(cellsOf)]);
}

export function buildComparison(data) {
  const { comparison } = data;
  if (!Array.isArray(comparison) || comparison.length === 0) return null;
  const owners = ownersOf(data, HUES.light.length);
  return h(
    "section.block",
    { id: "compare" },
    h("h2", "The models side by side"),
    auditNote(comparison),
    auditTable(comparison, owners),
    runTable(comparison, owners),
  );
}
