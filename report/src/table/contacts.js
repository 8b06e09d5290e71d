// SPDX-License-Identifier: GPL-3.0-or-later
// Contact forces and their estimated errors: a row for each two that touched.

import { format, h, nameCell, scrolled, swatchOf } from "../dom.js";

// Below a thousandth of a per cent it is rounding, or as good as nothing.
const percent = (share) => (share > 0 && share < 1e-5 ? "< 0.001\u2009%" : format(share == null ? NaN : 100 * share, "%", 2));

const COLUMNS = [
  ["Pressure × area", (row) => format(row.pressed_max_N, "N"), "the largest sum of forces of all pairs of elements, whatever their directions"],
  ["Time", (row) => format(row.pressed_max_time, "s"), "of that"],
  ["Two steps hold", (row) => (row.is_brief ? format(row.pressed_held_N, "N") : "all"), "the largest pressure × area that two steps in a row have; far less: the peak lasts one step"],
  ["Largest force", (row) => format(row.force_max_N, "N"), "the resultant between the two"],
  ["Area", (row) => format(row.area_m2, "m²"), "in contact when pressure × area is largest"],
  ["Interface share", (row) => percent(row.estimate.give), "compliance of the interface over the total compliance: the error of the force, or of the displacement"],
  ["Rim loss", (row) => percent(row.estimate.rim), "share of the force that is missing at edges of bodies at this depth"],
  ["Elements across", (row) => format(row.estimate.elements_across, "", 2), "√area over the elements’ mean edge; below about five the pressure’s shape is the mesh’s"],
  ["Stiffness", (row) => format(row.estimate.stiffness, "", 2)],
  ["Stiffness for 1 %", (row) => format(row.estimate.stiffness_for_1_percent, "", 2), "the stiffness at which interface share and rim loss are 1 %"],
];

export function buildContacts(runs) {
  const rows = runs.flatMap((run) => (run.summary?.contacts ?? []).map((row) => ({ run, row })));
  if (rows.length === 0) return null;
  const pairOf = ({ row }) => `${row.a} – ${row.b}`;
  const most = {}; // of two, over all runs
  for (const one of rows) most[pairOf(one)] = Math.max(most[pairOf(one)] ?? 0, one.row.pressed_max_N);
  rows.sort((a, b) => most[pairOf(b)] - most[pairOf(a)] || a.run.index - b.run.index);
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
      h("th", { scope: "row" }, pairOf({ row })),
      names && h("td", swatchOf(run), nameCell(run.label)),
      COLUMNS.map(([, show]) => h("td.number", show(row))),
    );
  return h(
    "section.block",
    { id: "contacts" },
    h("h2", "How wrong the contact may be"),
    scrolled("Contact forces and their estimated errors", h("thead", header), h("tbody", rows.map(line))),
    h("p.note", "Estimated where pressure × area is largest. Formulas: docs/contact_error.md."),
  );
}
