// SPDX-License-Identifier: GPL-3.0-or-later
// What the page is about: runs with their histories and frames, and measurements.

import { readCodes, readIntegers } from "./codes.js";
import { Obstacles } from "./obstacles.js";

export const RUNS = [..."ABCDEFGHIJKLMNOP"]; // letters of runs

// history.csv as columns of numbers by name; {} without one.
export function readHistory(text) {
  if (!text) return {};
  const [head, ...lines] = text.trim().split("\n");
  const names = head.split(",");
  const columns = Object.fromEntries(names.map((name) => [name, new Float64Array(lines.length)]));
  lines.forEach((line, row) =>
    line.split(",").forEach((number, k) => {
      if (names[k] !== undefined) columns[names[k]][row] = number === "nan" ? NaN : Number(number);
    }),
  );
  return columns;
}

// The norms of the forces between each two: [{label, values}], the largest first; none that is always zero.
function forcesOf(columns, names) {
  const forces = [];
  for (const column of Object.keys(columns)) {
    const pair = /^force_(.*)_x_N$/.exec(column)?.[1];
    if (!pair) continue;
    const parts = ["x", "y", "z"].map((axis) => columns[`force_${pair}_${axis}_N`]);
    if (parts.some((part) => !part)) continue;
    const values = parts[0].map((_, i) => Math.hypot(parts[0][i], parts[1][i], parts[2][i]));
    const most = values.reduce((a, b) => (b > a ? b : a), 0);
    if (most > 0) forces.push({ key: pair, label: labelPair(pair, names), values, most });
  }
  return forces.sort((a, b) => b.most - a.most);
}

// "lower_upper" with the scene's names: "lower – upper".
function labelPair(pair, names) {
  for (const a of names) for (const b of names) if (pair === `${a}_${b}`) return `${a} – ${b}`;
  return pair;
}

export function solidsOf(run) {
  const scene = run.manifest?.scene ?? {};
  const bodies = (scene.bodies ?? []).map((body) => body.name);
  const obstacles = scene.obstacles ?? [];
  return {
    bodies,
    names: [...bodies, ...obstacles.map((obstacle) => obstacle.name)],
    meshed: [...bodies, ...obstacles.filter((o) => o.mesh).map((o) => o.name)], // as numbered in the frames
    shapes: obstacles.filter((o) => !o.mesh), // numbered after those
  };
}

const areDistinct = (names) => names.every(Boolean) && new Set(names).size === names.length;

// Overlap models as the runs themselves call them; if two have one name, by the longer names that the report gives.
function modelsOf(runs) {
  const own = runs.map((run) => run.summary?.overlap);
  return areDistinct(own) ? own : runs.map((run, k) => run.model ?? own[k]);
}

// Runs are called by what tells them apart: their overlap models, else their folders.
function labelRuns(runs) {
  const models = modelsOf(runs);
  const names = runs.length > 1 && areDistinct(models) ? models : runs.map((run, k) => run.name ?? RUNS[k]);
  runs.forEach((run, k) => {
    run.letter = RUNS[k];
    run.overlap = models[k];
    run.label = runs.length > 1 && !areDistinct(names) ? `${names[k]} (${RUNS[k]})` : names[k];
  });
}

function prepare(run, index, source) {
  const columns = readHistory(run.history);
  const solids = solidsOf(run);
  return { ...run, index, source, columns, solids, forces: forcesOf(columns, solids.names), times: columns.time_s ?? [] };
}

// `source` is this document or a newer one.
export function readData(source = document) {
  const data = JSON.parse(source.getElementById("tetlap-data")?.textContent ?? "{}");
  const runs = (data.runs ?? []).map((run, index) => prepare(run, index, source));
  labelRuns(runs);
  return { ...data, runs };
}

// Of each row of a comparison its run, or, without one, which of `count` hues is its own, from the last on.
export function ownersOf({ comparison, runs }, count) {
  const owners = new Map();
  let without = 0;
  for (const row of comparison ?? []) {
    const run = runs.find((one) => one.summary?.overlap === row.model) ?? runs.find((one) => one.name === row.model.replace(/^.*\//, "")) ?? null;
    owners.set(row, { run, hue: run ? null : count - 1 - (without++ % count) });
  }
  return owners;
}

// The arrays of a run's frames. Fields are read when they are first asked for.
export async function readFrames(run) {
  const { frames, index, source } = run;
  const id = (name) => `run-${index}-${name}`;
  const [triangles, tetrahedra, positions] = await Promise.all([
    readIntegers(source, id("triangles"), 4),
    frames.has_inside ? readIntegers(source, id("tetrahedra"), 4) : null,
    readCodes(source, id("positions"), 3 * frames.vertices, 3),
  ]);
  const parts = await Promise.all((frames.obstacles ?? []).map(async (part, k) => ({
    ...part,
    triangles: await readIntegers(source, id(`obstacle-triangles-${k}`), 5), // vertices, body, face
    positions: await readCodes(source, id(`obstacle-positions-${k}`), 3 * part.vertices, 3),
  })));
  const waiting = new Map();
  const field = (name) => {
    const k = frames.fields.findIndex((one) => one.name === name);
    if (k < 0) return Promise.resolve(null);
    if (!waiting.has(k)) {
      const info = frames.fields[k];
      const size = info.on === "vertices" ? frames.vertices : frames.tetrahedra;
      waiting.set(k, readCodes(source, id(`field-${k}`), size, 1).then((codes) => ({ ...info, size, codes })));
    }
    return waiting.get(k);
  };
  return { ...frames, triangles, tetrahedra, positions, obstacles: new Obstacles(parts, run.solids), field };
}

// All times at which any run has a frame (or, without frames, a line of its history), in order.
export function unionTimes(runs) {
  const all = runs.flatMap((run) => Array.from(run.frames?.time_s ?? run.times)).sort((a, b) => a - b);
  const span = all.length ? all[all.length - 1] - all[0] : 0;
  return all.filter((time, i) => i === 0 || time - all[i - 1] > 1e-9 * span);
}

// The last of `times` that is not after `time`.
export function indexAt(times, time) {
  const slack = 1e-9 * Math.abs((times[times.length - 1] ?? 0) - (times[0] ?? 0));
  let low = 0;
  let high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= time + slack) low = middle;
    else high = middle - 1;
  }
  return low;
}
