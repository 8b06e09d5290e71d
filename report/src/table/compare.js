// SPDX-License-Identifier: GPL-3.0-or-later
// compare.json (docs/output.md) as tables: the audit, which compares the models with the reference in the same
// states, and their own runs. A run that did not reach the end is marked.

import { count, format, h, scrolled, swatchOf } from "../dom.js";

const AUDITS = [
  ["audit_volume_error", "Volumes V"],
  ["audit_gradient_error", "Gradients ∇V"],
  ["audit_force_error", "Nodal forces"],
  ["audit_total_force_error", "Total forces"],
];

const SUMS = "sum of differences over sum of sizes, over all audited states, which weigh by their size";
const WORST = "the largest relative error of a state, and its time; it may belong to a state with next to no force";

const percent = (share) => (share == null ? "–" : `${format(100 * share, "%", 3)}`);

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

function nameOf(row, runs) {
  const run = runs.find((one) => one.summary?.overlap === row.model) ?? runs.find((one) => one.name === row.model.replace(/^.*\//, ""));
  return [run ? swatchOf(run) : h("span.swatch"), row.model, row.model === row.reference ? " (reference)" : ""];
}

function table(caption, heads, rows, cells) {
  const head = h("tr", heads.map(([label, isText, help]) => h(isText ? "th" : "th.number", { scope: "col", title: help }, label)));
  return scrolled(caption, h("caption", caption), h("thead", head), h("tbody", rows.map((row) => h("tr", cells(row)))));
}

// Why there is no audit, or that it is of few states.
function auditNote(rows) {
  const row = rows.find((one) => one.audit_told);
  return row ? h("p.note", { id: "audit-told" }, `Audit: ${row.audits > 0 || rows.some((one) => one.audits > 0) ? "" : "–; "}${row.audit_told}.`) : null;
}

function auditTable(rows, runs) {
  const audited = rows.filter((row) => row.audits > 0);
  if (audited.length === 0) return null;
  const heads = [["Model", true], ...AUDITS.flatMap(([, label]) => [[label, false, SUMS], ["median", false, `${label}, the median state`], ["worst", false, `${label}: ${WORST}`]]), ["States", false]];
  return table(`Audit: errors of sums against ${audited[0].reference} in the same states of its run; median and worst state`, heads, audited, (row) => [
    h("th", { scope: "row" }, nameOf(row, runs)),
    AUDITS.flatMap(([key]) => [row[key], row[`${key}_median`], row[`${key}_worst`]].map((value, k) => h("td.number", k < 2 ? format(value) : `${format(value)} at ${format(row[`${key}_worst_time`], "s")}`))),
    h("td.number", count(row.audits)),
  ]);
}

function runTable(rows, runs) {
  const driven = rows.filter((row) => row.summary);
  const heads = [["Model", true], ["Outcome", true], ...RUNS.map(([label, , help]) => [label, false, help])];
  return table("Own runs: each model on its own trajectory", heads, driven, (row) => [
    h("th", { scope: "row" }, nameOf(row, runs)),
    h("td.outcome", { "data-outcome": row.outcome, title: row.message }, row.outcome),
    RUNS.map(([, value]) => h("td.number", value(row))),
  ]);
}

export function buildComparison({ comparison, runs }) {
  if (!Array.isArray(comparison) || comparison.length === 0) return null;
  return h(
    "section.block",
    { id: "compare" },
    h("h2", "The models side by side"),
    auditNote(comparison),
    auditTable(comparison, runs),
    runTable(comparison, runs),
  );
}
