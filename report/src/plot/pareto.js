// SPDX-License-Identifier: GPL-3.0-or-later
// pareto.json (docs/summary.md) as panels of points.

import { format } from "../dom.js";

const QUANTITIES = {
  V: ["Volume", "error of V"],
  "V+grad": ["Volume and its gradient", "error of ∇V"],
  force: ["Contact forces", "error of the forces"],
};

const SETS = { near: "pairs near contact", uniform: "pairs strewn evenly" };

const sceneName = (set) => set.replace(/^.*\//, "").replace(/\.ya?ml$/, "");

// What the tip of a point tells, as far as it was measured.
const DETAILS = [
  ["error", "error", (v) => format(v)],
  ["error_median", "median", (v) => format(v)],
  ["error_p90", "of 90 % below", (v) => format(v)],
  ["seconds_per_pair", "time a pair", (v) => format(v, "s")],
  ["cpu_seconds_per_pair", "processor time a pair", (v) => format(v, "s")],
  ["seconds_per_step", "time a step", (v) => format(v, "s")],
  ["overlap_share", "overlap’s share", (v) => format(100 * v, "%")],
  ["parameters", "parameters", (v) => (v > 0 ? format(v, "", 6) : null)],
  ["fallback_share", "fallbacks", (v) => format(100 * v, "%")],
  ["steps", "steps", (v) => format(v, "", 6)],
  ["outcome", "run", (v) => v || null],
];

const detailsOf = (point) => DETAILS.filter(([key]) => point[key] != null).map(([key, name, text]) => [name, text(point[key])]).filter(([, text]) => text !== null);

function panelOf(points, quantity, set, time, families) {
  const [title, yLabel] = QUANTITIES[quantity] ?? [quantity, "error"];
  const place = SETS[set] ?? sceneName(set);
  const isStep = time === "seconds_per_step";
  const isProcessor = time === "cpu_seconds_per_pair";
  return {
    title: `${title}, ${place}`,
    note: quantity === "force" ? (isStep ? "end to end: a step of the whole run" : "kernel: the overlap model alone") : null,
    xLabel: isStep ? "time a step →" : isProcessor ? "processor time a pair →" : "time a pair →",
    yLabel: `↑ ${yLabel}`,
    families,
    points: points
      .filter((point) => point[time] > 0 && point.error != null)
      .map((point) => ({
        name: point.model,
        family: point.family,
        x: point[time],
        y: point.error,
        xText: format(point[time], "s"),
        yText: format(point.error),
        details: detailsOf(point),
      })),
  };
}

// On one thread processor time says more than the clock, which other load on the machine slows.
function timeOf(points, pareto) {
  const hasProcessorTime = pareto.threads === 1 && points.every((point) => point.cpu_seconds_per_pair > 0 && !point.device);
  return hasProcessorTime ? "cpu_seconds_per_pair" : "seconds_per_pair";
}

export function panelsOf(pareto) {
  const points = pareto?.points ?? [];
  const families = [...new Set(points.map((point) => point.family))];
  const order = Object.keys(QUANTITIES);
  const keys = [...new Set(points.map((point) => `${point.quantity}\n${point.set}`))].map((key) => key.split("\n"));
  keys.sort(([a], [b]) => order.indexOf(a) - order.indexOf(b));
  return keys
    .flatMap(([quantity, set]) => {
      const own = points.filter((point) => point.quantity === quantity && point.set === set);
      const times = quantity === "force" ? [timeOf(own, pareto), "seconds_per_step"] : [timeOf(own, pareto)];
      return times.map((time) => panelOf(own, quantity, set, time, families));
    })
    .filter((panel) => panel.points.length > 0);
}
