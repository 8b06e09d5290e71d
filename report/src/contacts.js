// SPDX-License-Identifier: GPL-3.0-or-later
// What presses what, how much, and how wrong that may be: a row for each two that touched.

import { format, h, swatchOf } from "./dom.js";

const percent = (share) => format(share == null ? NaN : 100 * share, "%", 2);

const COLUMNS = [
  ["Largest force", (row) => format(row.force_max_N, "N")],
  ["At", (row) => format(row.force_max_time, "s")],
  ["Area then", (row) => format(row.area_m2, "m²")],
  ["Interface share", (row) => percent(row.estimate.give), "compliance of the interface over the total compliance: the error of the force, or of the displacement"],
  ["Lost at rims", (row) => percent(row.estimate.rim), "share of the force that edges of bodies lose at this depth"],
  ["Elements across", (row) => format(row.estimate.elements_across, "", 2), "√area over the elements’ mean edge; below about five the pressure’s shape is the mesh’s"],
  ["Stiffness", (row) => format(row.estimate.stiffness, "", 2)],
  ["For 1 %", (row) => format(row.estimate.stiffness_for_1_percent, "", 2), "the stiffness that would bring interface share and rims to 1 %"],
];

export function buildContacts(runs) {
  const rows = runs.flatMap((run) => (run.summary?.contacts ?? []).map((row) => ({ run, row })));
  if (rows.length === 0) return null;
  rows.sort((a, b) => b.row.force_max_N - a.row.force_max_N);
  const names = runs.length > 1;
  const header = h(
    "tr",
    h("th", { scope: "col" }, "Between"),
    names && h("th", { scope: "col" }, "Run"),
    COLUMNS.map(([title, , help]) => h("th.number", { scope: "col", title: help }, title)),
  );
  const line = ({ run, row }) =>
    h(
      "tr",
      h("th", { scope: "row" }, `${row.a} – ${row.b}`),
      names && h("td", swatchOf(run), run.label),
      COLUMNS.map(([, show]) => h("td.number", show(row))),
    );
  return h(
    "section.block",
    { id: "contacts" },
    h("h2", "How wrong the contact may be"),
    h(".scroll", h("table", h("thead", header), h("tbody", rows.map(line)))),
    h("p.note", "Estimated where the two pressed each other most; the manual’s page on contact has the formulas."),
  );
}
