// SPDX-License-Identifier: GPL-3.0-or-later
// What it takes to do the same again.

import { h, swatchOf } from "../dom.js";

const text = (value) => (typeof value === "object" && value !== null ? JSON.stringify(value) : String(value));

// The scene as YAML, which `tetlap run` reads.
export function yamlOf(value, indent = "") {
  const isPlain = (one) => typeof one !== "object" || one === null;
  const scalar = (one) => (typeof one === "string" && !/^[A-Za-z_][\w ./-]*$/.test(one) ? JSON.stringify(one) : String(one));
  const inline = (list) => list.every((one) => isPlain(one) || (Array.isArray(one) && one.every(isPlain)));
  const flow = (one) => (Array.isArray(one) ? `[${one.map(flow).join(", ")}]` : scalar(one));
  if (isPlain(value)) return scalar(value);
  if (Array.isArray(value)) {
    if (inline(value)) return flow(value);
    return value.map((one) => `\n${indent}- ${yamlOf(one, `${indent}  `).trimStart()}`).join("");
  }
  const lines = Object.entries(value).map(([key, one]) => {
    const rest = yamlOf(one, `${indent}  `);
    return `\n${indent}${key}:${rest.startsWith("\n") ? "" : " "}${rest}`;
  });
  return lines.length ? lines.join("") : "{}";
}

function rowsOf(run) {
  const { manifest, summary } = run;
  return [
    ["Command", manifest?.command],
    ["Scene file", summary?.scene],
    ["Weights file", manifest?.inputs?.weights_file || null],
    ["Processor", manifest?.processor],
    ["Threads", summary?.threads ?? manifest?.threads],
    ["Linear solver", summary?.solver],
    ...Object.entries(manifest?.versions ?? {}).map(([name, version]) => [name, version]),
  ].filter(([, value]) => value != null);
}

function counters(run) {
  const known = run.summary?.counters;
  if (!known) return null;
  const rows = Object.entries(known).map(([key, value]) => h("tr", h("th", { scope: "row" }, key.replaceAll("_", " ")), h("td.number", Number(value).toLocaleString("en-US"))));
  return h("details.more", h("summary", "Counters of the run"), h(".scroll", h("table", h("tbody", rows))));
}

const listOf = (rows) => (rows.length > 0 ? h("dl", rows.flatMap(([name, value]) => [h("dt", name), h("dd", text(value))])) : null);

function manifestOf(run, rows, isNamed) {
  return h(
    ".manifest",
    isNamed && h("h3", swatchOf(run), run.label),
    listOf(rows),
    run.manifest?.scene && h("details.more", h("summary", "Scene, with every default filled in"), h("pre", { tabindex: 0 }, yamlOf(run.manifest.scene).trimStart())),
    counters(run),
  );
}

// What is the same of all runs stands there once.
export function buildManifest(runs) {
  const known = runs.filter((run) => run.manifest || run.summary);
  if (known.length === 0) return null;
  const rows = known.map(rowsOf);
  const isIn = (list, [name, value]) => list.some((row) => row[0] === name && text(row[1]) === text(value));
  const common = known.length > 1 ? rows[0].filter((row) => rows.every((list) => isIn(list, row))) : [];
  return h(
    "section.block",
    { id: "manifest" },
    h("h2", "Manifest"),
    common.length > 0 && h(".manifest.common", h("h3", "All runs"), listOf(common)),
    h(".columns", known.map((run, k) => manifestOf(run, rows[k].filter((row) => !isIn(common, row)), runs.length > 1))),
  );
}
