// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of `tetlap bench --json` as a table: columns as they come, those that are the same in all rows above it.

import { format, h } from "../dom.js";

const isNumber = (value) => typeof value === "number";

function buildTable(rows) {
  const keys = [...new Set(rows.flatMap((row) => Object.keys(row)))].filter((key) => rows.some((row) => typeof row[key] !== "object" && row[key] != null));
  const isSame = (key) => rows.length > 1 && rows.every((row) => row[key] === rows[0][key]);
  const fixed = keys.filter(isSame);
  const free = keys.filter((key) => !isSame(key));
  const name = (key) => key.replaceAll("_", " ");
  return [
    fixed.length > 0 && h("dl", fixed.flatMap((key) => [h("dt", name(key)), h("dd", isNumber(rows[0][key]) ? format(rows[0][key]) : String(rows[0][key]))])),
    h(
      ".scroll",
      h(
        "table",
        h("thead", h("tr", free.map((key) => h(rows.some((row) => isNumber(row[key])) ? "th.number" : "th", { scope: "col" }, name(key))))),
        h("tbody", rows.map((row) => h("tr", free.map((key) => (isNumber(row[key]) ? h("td.number", format(row[key])) : h("td", row[key] == null ? "–" : String(row[key]))))))),
      ),
    ),
  ];
}

export function buildBenches(benches) {
  const lists = benches.map(({ rows }) => (Array.isArray(rows) ? rows : [rows])).filter((rows) => rows.length > 0);
  if (lists.length === 0) return null;
  return h("section.block", { id: "benches" }, h("h2", "Measured"), lists.map((rows) => h(".manifest", h("h3", `bench ${rows[0].bench ?? ""}`), buildTable(rows))));
}
