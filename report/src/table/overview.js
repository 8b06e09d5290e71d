// SPDX-License-Identifier: GPL-3.0-or-later
// The most important figures, of one run or of several.

import { count, format, h, nameCell, scrolled, swatchOf } from "../dom.js";

const hasEnded = (summary) => summary.outcome === "finished";

const FIGURES = [
  ["Outcome", (s, all) => (all.every(hasEnded) ? null : hasEnded(s) ? "finished" : s.outcome), "how far each run came"],
  ["Wall time", (s) => format(s.wall_s, "s")],
  ["Steps", (s) => count(s.steps)],
  ["Largest contact force", (s) => s.overlap && format(s.contact_force_max, "N")],
  ["Deepest overlap", (s) => s.overlap && format(100 * s.deepest_overlap_max, "%"), "largest share of an element that another body covers"],
  ["Overlapping pairs", (s) => s.overlap && count(s.pairs_max), "largest number after a step"],
  ["Forces against motion", (s) => s.momentum_gap != null && format(100 * s.momentum_gap, "%", 2), "difference of the impulse of all written forces from the change of momentum, of the worst body"],
  ["Energy gained", (s) => format(s.energy_gain_relative), "largest rise of the audited total energy, over the scene’s energy"],
];

// More than two runs: a line each.
function buildTable(runs) {
  const all = runs.map((run) => run.summary);
  const shown = FIGURES.filter(([, value]) => runs.some((run) => value(run.summary, all)));
  const head = h("tr", h("th", { scope: "col" }, "Run"), shown.map(([label, , help]) => h("th.number", { scope: "col", title: help }, label)));
  const line = (run) => h("tr", h("th", { scope: "row" }, swatchOf(run), nameCell(run.label)), shown.map(([, value]) => h("td.number", value(run.summary, all) || "–")));
  const table = scrolled("Figures of the runs", h("thead", head), h("tbody", runs.map(line)));
  table.classList.add("overview");
  return table;
}

export function buildOverview(runs) {
  const known = runs.filter((run) => run.summary);
  if (known.length === 0) return null;
  if (known.length > 2) return buildTable(known);
  const tiles = FIGURES.map(([label, value, help]) => {
    const values = known.map((run) => value(run.summary, known.map((one) => one.summary)));
    if (!values.some(Boolean)) return null;
    return h(
      ".figure",
      { title: help },
      h("dt", label),
      known.map((run, k) => h(hasEnded(run.summary) || label !== "Outcome" ? "dd" : "dd.failed", known.length > 1 && swatchOf(run), values[k] || "–")),
    );
  });
  const key = known.length > 1 && h("p.key-line", known.map((run) => h("span", swatchOf(run), run.label)));
  return h(".overview", key, h("dl.figures", tiles));
}

// "failed at t = 0.1 s: …", "interrupted at t = …"
function whatHappened({ outcome, message = "" }) {
  return message.startsWith(outcome) ? message : `${outcome}${message.startsWith("at t") ? "" : "."} ${message}`;
}

// `isLive`: a bar beside it says how the run ended.
export function buildHeader(runs, title, isLive) {
  const { summary } = runs[0] ?? {};
  const models = [...new Set(runs.map((run) => run.overlap).filter(Boolean))];
  const facts = summary
    ? [summary.scene?.replace(/^.*\//, ""), `${count(summary.tetrahedra)} tetrahedra`, `${count(summary.vertices)} vertices`, models.length && `overlap: ${models.join(", ")}`]
    : [];
  const trouble = runs
    .filter((run) => !isLive && run.summary && run.summary.outcome !== "finished")
    .map((run) => h(runs.length > 1 ? "p.warning" : "p.warning.sentence", { role: "note" }, `${runs.length > 1 ? `${run.label}: ` : ""}${whatHappened(run.summary)}`));
  return h(".title", h("h1", title), facts.length > 0 && h("p.facts", facts.filter(Boolean).map((fact) => h("span", fact))), trouble);
}
