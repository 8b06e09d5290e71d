// SPDX-License-Identifier: GPL-3.0-or-later
// A verdict's models: what each is off on pairs against what it is off in place.

import { format, h } from "../dom.js";
import { Points } from "./points.js";
import { powerOf } from "./plots.js";

const percent = (share) => format(100 * share, "%");

const PANELS = [
  ["Errors on pairs against errors in place: forces in the states of runs", "volume_error", "V of scenes’ pairs", "nodal_force_error", "nodal forces"],
  ["Errors on pairs against errors in place: paths", "gradient_error", "∇V of scenes’ pairs", "path_error", "path"],
];

// The run that is farthest off; null: none has that figure.
function worstOf(runs, key) {
  const known = (runs ?? []).filter((run) => run[key] != null);
  return known.length === 0 ? null : known.reduce((worst, run) => (run[key] > worst[key] ? run : worst));
}

function pointOf(model, k, [, xKey, xWords, yKey, yWords]) {
  const worst = worstOf(model.runs, yKey), x = model.pairs?.[xKey];
  if (!worst || !(x > 0)) return null;
  const details = [[xWords, percent(x)], [`${yWords}, worst`, percent(worst[yKey])], ["scene", worst.scene], ["runs that ended", `${model.runs.filter((run) => run.outcome === "finished").length} of ${model.runs.length}`]];
  return { name: model.model, family: k, x, y: worst[yKey], xText: percent(x), yText: percent(worst[yKey]), details };
}

// Null: fewer than two models have both figures.
export function buildPlace(models, state) {
  const panels = PANELS.map((panel) => ({
    title: panel[0],
    xLabel: `error of ${panel[2]} →`,
    yLabel: `↑ error of ${panel[4]}, worst scene`,
    xTick: powerOf,
    families: models.map((_, k) => k),
    points: models.map((model, k) => pointOf(model, k, panel)).filter(Boolean),
  })).filter((panel) => panel.points.length > 1);
  if (panels.length === 0) return null;
  return h(".plots", panels.map((panel) => new Points(panel, state).element));
}
