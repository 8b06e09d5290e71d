// SPDX-License-Identifier: GPL-3.0-or-later
// Where a run's time went: a bar of phases, and the seconds beside their names.

import { count, format, h, nameCell, scrolled, swatchOf } from "../dom.js";
import { buildEffects } from "./effects.js";

const PHASES = [
  ["overlap", "Overlap volumes", "contact"],
  ["broad_phase", "Broad phase", "contact"],
  ["contact", "Other contact", "contact"],
  ["layout", "Layout of the matrix", "solver"],
  ["assembly", "Assembly", "solver"],
  ["analysis", "Analysis", "solver"],
  ["factorisation", "Factorisation", "solver"],
  ["solve", "Solve", "solver"],
  ["products", "Products with the matrix", "solver"],
  ["forces", "Other forces", "rest"],
  ["integration", "Integrator, Newton's method", "rest"],
  ["measures", "Audits", "rest"],
  ["start", "Start", "rest"],
  ["output", "Output", "rest"],
  ["other", "Other", "rest"],
];

// "1,444 steps", and whether the run got to its end.
function stepsOf({ summary }) {
  const ended = summary.outcome && summary.outcome !== "finished" ? `, ${summary.outcome}` : "";
  return `${count(summary.steps)} steps${ended}`;
}

function listed(phases) {
  const known = new Set(PHASES.map(([key]) => key));
  const others = Object.keys(phases).filter((key) => !known.has(key));
  return [...PHASES, ...others.map((key) => [key, key.replaceAll("_", " "), "rest"])].filter(([key]) => key in phases);
}

function bar(run, most) {
  const phases = run.summary.phases;
  const total = Object.values(phases).reduce((a, b) => a + b, 0);
  const counts = {};
  const pieces = listed(phases).map(([key, label, group]) => {
    counts[group] = (counts[group] ?? 0) + 1;
    const share = phases[key] / total;
    const piece = h(`span.piece.${group}`, {
      style: `flex-grow:${Math.max(phases[key], 0)};--shade:${counts[group] - 1}`,
      title: `${label}: ${format(phases[key], "s")}, ${format(100 * share, "%")}`,
      "data-phase": key,
    });
    if (share > 0.11) piece.append(h("span", label));
    return piece;
  });
  return h(".bar", { style: `width:${(100 * total) / most}%` }, pieces);
}

export function buildPhases(runs) {
  const known = runs.filter((run) => run.summary?.phases);
  if (known.length === 0) return null;
  const totals = known.map((run) => Object.values(run.summary.phases).reduce((a, b) => a + b, 0));
  const most = Math.max(...totals);
  const isMany = known.length > 2; // then the bars show the shares
  const keys = listed(Object.assign({}, ...known.map((run) => run.summary.phases)));
  const header = h(
    "tr",
    h("th", { scope: "col" }, "Phase"),
    known.map((run) => h("th.number", { scope: "col" }, known.length > 1 ? nameCell(run.label) : "Wall time")),
    !isMany && known.map((run) => h("th.number", { scope: "col" }, known.length > 1 ? nameCell(`${run.label}, share`) : "Share")),
  );
  const row = ([key, label, group]) =>
    h(
      "tr",
      h("th", { scope: "row" }, h(`span.swatch.${group}`), label),
      known.map((run) => h("td.number", format(run.summary.phases[key], "s"))),
      !isMany && known.map((run, k) => h("td.number", format((100 * run.summary.phases[key]) / totals[k], "%", 2))),
    );
  const sum = h("tr.sum", h("th", { scope: "row" }, "Total"), totals.map((total) => h("td.number", format(total, "s"))), !isMany && totals.map(() => h("td.number", "100\u2009%")));
  return h(
    "section.block",
    { id: "phases" },
    h("h2", "Where the time went"),
    h(
      ".bars",
      known.map((run) => h(".row", known.length > 1 && h(".name", swatchOf(run), run.label, h("span.steps", stepsOf(run))), bar(run, most))),
    ),
    h("details.more", { open: true }, h("summary", "In numbers"), scrolled("Wall time by phase", h("thead", header), h("tbody", keys.map(row), sum))),
    buildEffects(known),
  );
}
