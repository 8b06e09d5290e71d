// SPDX-License-Identifier: GPL-3.0-or-later
// verdict.json (docs/verdict.md) as tables: what each model is fit for and by which condition, and what was
// measured of it on hard pairs, on pairs that no training saw, and in place.

import { count, format, h, nameCell, scrolled, swatchOfHue } from "../dom.js";
import { buildPlace } from "../plot/place.js";
import { HUES } from "../view/colour.js";

const USES = {
  detect: "Fit to detect overlaps",
  forces: "Fit for forces at given states",
  motion: "Fit to drive a motion",
};

const percent = (share) => format(100 * share, "%");
const share = (value) => (value == null ? "–" : percent(value));

const CONTRACT = [
  ["balance", "Forces of a pair that do not balance", format],
  ["order", "Change with the order of vertices and of tetrahedra", format],
  ["motion", "Change with rotation and translation", format],
  ["bounds", "V below 0, or above the smaller tetrahedron", format],
  ["gradient", "∇V against differences of V", format],
  ["missed", "Overlaps taken for none", format],
  ["volume_jump", "Jump of V along paths", format],
  ["gradient_jump", "Jump of ∇V along paths", format],
  ["refused", "Classes that could not be asked", count],
];

const PAIRS = [
  ["pairs", "paper_status", "The paper’s pairs, right: mean of the kinds", share],
  ["pairs", "paper_mae", "The paper’s pairs, mean |ΔV|", format],
  ["pairs", "status_overlapping", "Overlapping pairs of scenes, found", share],
  ["pairs", "status_apart", "Disjoint pairs whose boxes overlap, found disjoint", share],
  ["pairs", "volume_error", "V of scenes’ pairs, Σ|ΔV| / ΣV", share],
  ["pairs", "moment_error", "First moments of scenes’ pairs", share],
  ["pairs", "gradient_error", "∇V of scenes’ pairs", share],
  ["unseen", "nodal_force_error", "Nodal forces on unseen bodies, worst body", share],
  ["unseen", "total_force_error", "Total forces on unseen bodies, worst body", share],
  ["unseen", "false_friction", "False friction on unseen bodies, worst body", share],
  ["unseen", "path_work", "Work round a closed path, worst body", share],
];

const PLACE = [
  ["share_reached", "Reached", share, "of the scene’s time"],
  ["nodal_force_error", "Nodal forces", share, "in the same states as the reference"],
  ["total_force_error", "Total forces", share, "in the same states as the reference"],
  ["run_force_error", "Forces over time", share, "each run along its own path"],
  ["path_error", "Path", share, "largest distance from the reference’s path, over the scene’s size"],
  ["energy_gain", "Energy gained", share, "over the scene’s energy"],
  ["momentum_gap", "Impulse missing", share, "in the motion, of all forces written; none in static scenes"],
  ["steps_ratio", "Steps", (value) => format(value), "over those of the reference"],
  ["time_ratio", "Time", (value) => format(value), "of the processor, over that of the reference"],
];

const mark = (models, k) => models.length > 1 && swatchOfHue(k % HUES.light.length);
const nameOf = (models, k) => [mark(models, k), nameCell(models[k].model)];

function table(caption, heads, bodies) {
  const head = h("tr", heads.map(([label, isNumber, help]) => h(isNumber ? "th.number" : "th", { scope: "col", title: help }, label)));
  return scrolled(caption, h("caption", caption), h("thead", head), bodies.map((rows) => h("tbody", rows.map((cells) => h("tr", cells)))));
}

const modelHeads = (models) => models.map((model, k) => [nameOf(models, k), true]);

// "Of the time reached" stands behind a figure; alone it is "Time reached".
function headOf(what) {
  const words = what.replace(/^of (the )?/, "");
  return words[0].toUpperCase() + words.slice(1);
}

const boundOf = (row) => `${row.least ? "≥" : "≤"}\u2009${format(row.bound)}`;

function gradeOf(grade) {
  return h("td.grade", { "data-fit": String(grade.fit) }, h("b", grade.fit ? "yes" : "no"), !grade.fit && h("span.reason", grade.reason.replace(/\bnan\b/, "not measured:")));
}

function gradeTable(models) {
  const heads = [["Model"], ...Object.values(USES).map((words) => [words])];
  const rows = models.map((model, k) => [h("th", { scope: "row" }, nameOf(models, k)), Object.keys(USES).map((use) => gradeOf(model.grades[use]))]);
  return table("Three grades; a no tells what decided it", heads, [rows]);
}

function figureOf(row) {
  return h("td.number", { "data-met": row && String(row.met) }, row ? format(row.value) : "–", row?.scene && h("span.scene", row.scene));
}

// Every condition of a use with its bound, and what each model came to.
function conditionTable(models) {
  const bodies = Object.entries(USES).map(([use, words]) => {
    const known = models.map((model) => model.grades[use].conditions ?? []);
    const asked = new Map(known.flat().map((row) => [row.what, row]));
    return [...asked.values()].map((one, k) => [
      k === 0 && h("th", { scope: "rowgroup", rowspan: asked.size }, words),
      h("th", { scope: "row" }, headOf(one.what)),
      h("td.number", boundOf(one)),
      known.map((rows) => figureOf(rows.find((row) => row.what === one.what))),
    ]);
  });
  if (!bodies.some((rows) => rows.length > 0)) return null;
  return table("What is asked, and what was measured; of scenes the worst", [["Grade"], ["Condition"], ["Asked", true], ...modelHeads(models)], bodies);
}

function figureTable(caption, models, rows) {
  const bodies = [rows.map(([part, key, words, show]) => [h("th", { scope: "row" }, words), models.map((model) => h("td.number", show(model[part]?.[key])))])];
  return table(caption, [["Figure"], ...modelHeads(models)], bodies);
}

function runOf(models, k, run) {
  return [
    h("th", { scope: "row" }, nameOf(models, k)),
    h("td.outcome", { "data-outcome": run.outcome }, run.outcome),
    PLACE.map(([key, , show]) => h("td.number", show(run[key]))),
  ];
}

function placeTable(models) {
  const scenes = new Map(models.flatMap((model) => model.runs ?? []).map((run) => [run.scene, run.kind]));
  if (scenes.size === 0) return null;
  const bodies = [...scenes].map(([scene, kind]) => {
    const runs = models.flatMap((model, k) => (model.runs ?? []).filter((run) => run.scene === scene).map((run) => [k, run]));
    return runs.map(([k, run], row) => [row === 0 && h("th", { scope: "rowgroup", rowspan: runs.length }, scene, kind !== scene && h("span.kind", kind)), runOf(models, k, run)]);
  });
  const heads = [["Scene"], ["Model"], ["Outcome"], ...PLACE.map(([, label, , help]) => [label, true, help])];
  return table("In place: each scene with the model, beside the same scene with the reference", heads, bodies);
}

export const verdictTitle = ({ models }) => (models.length === 1 ? `What ${models[0].model} is fit for` : "What the models are fit for");

export function buildVerdict(verdict, state) {
  const { models } = verdict;
  const isQuick = Boolean(verdict.quick);
  return h(
    "section.block",
    { id: "verdict" },
    h("h2", "Verdict"),
    h("p.lead", "Each grade is yes, or no with the first condition that is not met. What could not be measured is not met. The reference is clip; of clip itself, clip-scalar.", isQuick && " A quick verdict: fewer pairs, and five of the twelve scenes."),
    gradeTable(models),
    buildPlace(models, state),
    conditionTable(models),
    figureTable("Contract: the worst of all classes of hard pairs", models, CONTRACT.map(([...row]) => ["contract", ...row])),
    figureTable("Pairs that no training saw", models, PAIRS),
    placeTable(models),
  );
}
