// SPDX-License-Identifier: GPL-3.0-or-later
// What each effect of a run cost: time, calls and memory. An effect that a run does not have has no cell.

import { count, format, h, nameCell, scrolled, swatchOf } from "../dom.js";

const COLUMNS = [
  ["Forces", "force_s", (row) => format(row.force_s, "s")],
  ["Calls", "force_calls", (row) => count(row.force_calls)],
  ["Newton's matrix", "jacobian_s", (row) => format(row.jacobian_s, "s")],
  ["Calls", "jacobian_calls", (row) => count(row.jacobian_calls)],
  ["After steps", "prepare_s", (row) => format(row.prepare_s, "s")],
  ["Calls", "prepare_calls", (row) => count(row.prepare_calls)],
  ["Memory", "bytes_max", (row) => `${format(row.bytes_max / 1048576, "MiB", 3)}`],
];

export function buildEffects(runs) {
  const known = runs.filter((run) => run.summary?.effects);
  if (known.length === 0) return null;
  const names = known.length > 1;
  const rows = known.flatMap((run) => Object.entries(run.summary.effects).map(([name, row]) => ({ run, name, row })));
  const header = h(
    "tr",
    h("th", { scope: "col" }, "Effect"),
    names && h("th", { scope: "col" }, "Run"),
    COLUMNS.map(([title]) => h("th.number", { scope: "col" }, title)),
  );
  const line = ({ run, name, row }) =>
    h(
      "tr",
      { "data-effect": name },
      h("th", { scope: "row" }, name),
      names && h("td", swatchOf(run), nameCell(run.label)),
      COLUMNS.map(([, key, show]) => h("td.number", row[key] === undefined ? "" : show(row))),
    );
  return h("details.more", h("summary", "By effect"), scrolled("Cost of each effect", h("thead", header), h("tbody", rows.map(line))));
}
