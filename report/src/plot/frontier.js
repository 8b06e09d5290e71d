// SPDX-License-Identifier: GPL-3.0-or-later
// Error against time: every model a labelled point, and the frontier of those that none beats in both.

import { HUES } from "../view/colour.js";
import { format, h } from "../dom.js";
import { panelsOf } from "./pareto.js";
import { Points } from "./points.js";

const timeOf = (seconds) => format(seconds, "s", 1);

const perSecond = (rate) => (rate == null ? "–" : rate >= 1e6 ? `${format(rate / 1e6)}\u2009M/s` : rate >= 1e4 ? `${format(rate / 1e3)}\u2009k/s` : `${format(rate)}\u2009/s`);

// Learned models beside their peers.
function buildComparisons(rows) {
  if (!rows?.length) return null;
  const head = ["What", "Quantity", "Peer", "pairs", "error", "Learned", "pairs", "error", "Times faster", "In the paper"];
  const isText = [0, 1, 2, 5];
  const cells = (row) => [
    row.name,
    `${row.quantity}, ${row.set}`,
    row.slow,
    perSecond(row.slow_pairs_per_second),
    format(row.slow_error),
    row.fast,
    perSecond(row.fast_pairs_per_second),
    format(row.fast_error),
    `${format(row.ratio)} (${format(row.ratio_min)} … ${format(row.ratio_max)})`,
    format(row.paper_ratio),
  ];
  const line = (tag, texts) => h("tr", texts.map((text, k) => h(isText.includes(k) ? tag : `${tag}.number`, text)));
  return h("details.more", { open: true }, h("summary", "Learned models beside their peers"), h(".scroll", h("table", h("thead", line("th", head)), h("tbody", rows.map((row) => line("td", cells(row)))))));
}

export function buildFrontier(pareto, state) {
  const panels = panelsOf(pareto);
  if (panels.length === 0) return null;
  const key = panels[0].families.length > 1 ? h("p.key-line", panels[0].families.map((family) => h("span", h("span.dot", { "data-family": panels[0].families.indexOf(family) }), family))) : null;
  const paint = () => key?.querySelectorAll(".dot").forEach((dot) => (dot.style.background = HUES[state.theme][dot.dataset.family % HUES.light.length]));
  state.on(["theme"], paint);
  paint();
  return h(
    "section.block",
    { id: "frontier" },
    h("h2", "What accuracy costs"),
    h("p.lead", "Down is more accurate, left is faster. Filled points are on the frontier: nothing else measured is both faster and more accurate."),
    key,
    h(".plots", panels.map((panel) => new Points({ ...panel, hasFrontier: true, xTick: timeOf }, state).element)),
    buildComparisons(pareto.comparisons),
  );
}
