// SPDX-License-Identifier: GPL-3.0-or-later
// The page in a browser. `node page.test.mjs CHROMIUM TETLAP SCENE OBSTACLES OUT` runs a scene with two overlap
// models, and one with obstacles of every kind, makes the pages, uses them, and leaves screenshots in OUT.

import assert from "node:assert/strict";
import { execFileSync, spawn, spawnSync } from "node:child_process";
import { cpSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { launch } from "./browser.mjs";

const [chromium, tetlap, scene, obstacles, out] = process.argv.slice(2);
mkdirSync(out, { recursive: true });

// Points of a frontier: what is tested is the page, so any will do.
const PARETO = {
  format: "tetlap-pareto 1",
  points: ["V", "V+grad"].flatMap((quantity) =>
    [
      ["clip", "clip", 1e-7, 1e-15],
      ["exact", "exact", 1e-5, 0],
      ["geo", "geo", 1e-6, 3e-3],
      ["slow", "geo", 2e-6, 4e-3],
    ].map(([model, family, seconds_per_pair, error]) => ({ model, family, quantity, set: "near", seconds_per_pair, error })),
  ),
};

// A table of hard cases with every verdict in it; the last one is replaced by a second file.
const measure = (value, most) => ({ name: "energy gain", value, most, met: value <= most });
const STRESS = {
  format: "tetlap-stress 1",
  rows: [
    ...["clip", "geo"].map((model) => ({ group: "pairs", case: "uniform", model, outcome: model === "clip" ? "held" : "tolerance", measures: [measure(0, 1)], remark: model === "geo" ? "a learned volume" : "" })),
    ...[["held", "drop"], ["better", "crush"], ["limit", "mat twist"], ["absent", "stack"], ["failed", "spikes"]].map(([outcome, name]) => ({
      group: "scenes",
      case: name,
      model: "clip",
      outcome,
      measures: [measure(outcome === "limit" ? 0.5 : 1e-4, 1e-3)],
      remark: outcome === "limit" ? "it turns <inside> out" : "",
      counter: outcome === "limit" ? "trouble.inverted" : undefined,
      cpu_s: 2.5,
    })),
  ],
};
const STRESS_LATER = { format: "tetlap-stress 1", rows: [{ ...STRESS.rows[6], outcome: "held" }] };

// Two verdicts, one of which a scene decided.
const grade = (fit, reason, ...conditions) => ({ fit, reason, conditions });
const condition = (what, bound, value, met, scene) => ({ what, bound, least: what.startsWith("of "), value, met, scene });
const judged = (model, steps) => ({
  model,
  grades: {
    detect: grade(true, "", condition("of the paper's pairs right", 0.99, 1, true)),
    forces: grade(false, "nan error of nodal forces on unseen bodies, at most 0.01 is asked", condition("error of nodal forces on unseen bodies", 0.01, null, false)),
    motion: grade(steps <= 1.5, steps <= 1.5 ? "" : `edge: ${steps} steps over those of clip, at most 1.5 is asked`, condition("steps over those of clip", 1.5, steps, steps <= 1.5, "edge")),
  },
  contract: { balance: 1e-16, refused: 2 },
  pairs: { paper_status: 0.998, moment_error: 0.1 / steps, volume_error: 0.02 / steps },
  unseen: { nodal_force_error: null },
  runs: [{ scene: "edge", kind: "<edges> cross", outcome: steps <= 1.5 ? "finished" : "passed through", share_reached: 1, nodal_force_error: 0.01 * steps, path_error: 1e-3 * steps, momentum_gap: null, steps_ratio: steps }],
});
const VERDICTS_MADE = { format: 1, seed: 7, quick: 1, models: [judged("mine", 4.76), judged("geo", 1.08)] };

// A scene over a grid, in which one value is none that a scene can have.
function makeSweep() {
  const words = ["sweep", scene, "-q", "-o", join(out, "sweep"), "-V", "contact.stiffness=1e5..1e7:3,log", "-V", "bodies.upper.material.poisson=0.3,0.7", "-s", "time.end=0.15", "-s", "output.vtu=false", "-s", "output.frames=5"];
  const { status } = spawnSync(tetlap, words, { stdio: "ignore" });
  assert.equal(status, 70); // half of it failed
}

// Three models and one of the audit alone; the last has a run that gave up halfway.
function makeComparison() {
  const folder = join(out, "models");
  const scaled = (end, frames) => ["-q", "-t", "1", "-s", `time.end=${end}`, "-s", `output.frames=${frames}`, "-s", "bodies.upper.velocity=[0, 0, -1]", "-s", "contact.potential=nodal", "-s", "contact.stiffness=1e6"];
  const run = (...args) => execFileSync(tetlap, args, { stdio: "ignore" });
  run("compare", scene, "--overlap", "clip,geo,clip32", "--audit-only", "exact", "--audit", "3", "-o", folder, ...scaled(0.06, 24));
  run("run", scene, "-m", "clip32", "-o", join(folder, "clip32"), ...scaled(0.03, 12));
  const path = join(folder, "compare.json");
  const rows = JSON.parse(readFileSync(path, "utf8"));
  Object.assign(rows[2], { outcome: "failed", message: "Newton's method gave up", share_reached: 0.5 });
  writeFileSync(path, JSON.stringify(rows));
  run("report", "-q", folder, "-o", join(out, "models.html"));
  return folder;
}

// Two weights files of one base name, with long names, and two models of the audit alone.
const LONG = "a-network-whose-name-is-long-as-those-of-a-search-are";
function makeFiles() {
  const folder = join(out, "files");
  const files = ["geo-small", "geo"].map((network, k) => {
    const place = join(out, `networks-of-search-${k}`);
    mkdirSync(place, { recursive: true });
    cpSync(join("net/weights", `${network}.safetensors`), join(place, `${LONG}.safetensors`));
    return join(place, `${LONG}.safetensors`);
  });
  const words = ["compare", scene, "-q", "-t", "1", "--overlap", ["clip", ...files].join(), "--audit-only", "exact,clip-scalar", "--audit", "3", "-o", folder, "-s", "time.end=0.06", "-s", "output.frames=12", "-s", "bodies.upper.velocity=[0, 0, -1]"];
  execFileSync(tetlap, words, { stdio: "ignore" });
  const path = join(folder, "networks-of-search-0", LONG, "summary.json");
  const summary = JSON.parse(readFileSync(path, "utf8"));
  summary.contacts[0].estimate.rim = 2e-16; // rounding
  writeFileSync(path, JSON.stringify(summary));
  execFileSync(tetlap, ["report", "-q", folder, "-o", join(out, "files.html")]);
  execFileSync(tetlap, ["report", "-q", ...[0, 1].map((k) => join(folder, `networks-of-search-${k}`, LONG)), "-o", join(out, "files-two.html")]);
}

function makePages() {
  const run = (...args) => execFileSync(tetlap, args, { stdio: ["ignore", "inherit", "inherit"] });
  const runs = ["clip", "geo"].map((model) => join(out, model));
  for (const [k, model] of ["clip", "geo"].entries()) run("run", scene, "-q", "-m", model, "-o", runs[k], "-s", "time.end=0.2", "-s", "output.frames=20");
  writeFileSync(join(out, "pareto.json"), JSON.stringify(PARETO));
  run("report", "-q", ...runs, "--pareto", join(out, "pareto.json"), "-o", join(out, "two.html"));
  run("report", "-q", runs[0], "--surface", "-o", join(out, "one.html"));
  run("run", obstacles, "-q", "-o", join(out, "obstacles"), "-s", "time.end=1", "-s", "output.frames=10");
  run("report", "-q", join(out, "obstacles"), "-o", join(out, "obstacles.html"));
  cpSync(join(out, "obstacles"), join(out, "again"), { recursive: true });
  run("report", "-q", join(out, "obstacles"), join(out, "again"), "-o", join(out, "obstacles-two.html"));
  makeSweep();
  const models = makeComparison();
  makeFiles();
  writeFileSync(join(out, "stress.json"), JSON.stringify(STRESS));
  writeFileSync(join(out, "later.json"), JSON.stringify(STRESS_LATER));
  mkdirSync(join(out, "verdict"), { recursive: true });
  writeFileSync(join(out, "verdict", "verdict.json"), JSON.stringify(VERDICTS_MADE));
  run("report", "-q", join(out, "verdict"), "-o", join(out, "verdict.html"));
  run("report", "-q", "--stress", join(out, "stress.json"), "--stress", join(out, "later.json"), "-o", join(out, "stress.html"));
  return { obstaclesTwo: `file://${resolve(out, "obstacles-two.html")}`, verdict: `file://${resolve(out, "verdict.html")}`, files: `file://${resolve(out, "files.html")}`, filesTwo: `file://${resolve(out, "files-two.html")}`, models: `file://${resolve(out, "models.html")}`, folder: models, sweep: `file://${resolve(out, "sweep", "sweep.html")}`, obstacles: `file://${resolve(out, "obstacles.html")}`, stress: `file://${resolve(out, "stress.html")}`, two: `file://${resolve(out, "two.html")}`, one: `file://${resolve(out, "one.html")}`, runs };
}

// Different colours in each canvas, read right after it was drawn: 1 is an empty one.
const COLOURS = `(() => {
  tetlap.stage.renderNow();
  return tetlap.stage.views.map(({ canvas }) => {
    const gl = canvas.getContext("webgl2");
    const bytes = new Uint8Array(4 * canvas.width * canvas.height);
    gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    return new Set(new Uint32Array(bytes.buffer)).size;
  });
})()`;

function assertDrawn(counts) {
  assert.ok(counts.length > 0, "there is no canvas");
  for (const count of counts) assert.ok(count > 50, `a canvas of ${count} colours`);
}

// A number that changes with what the canvases show.
const PICTURE = `(tetlap.stage.renderNow(), tetlap.stage.views.map(({ canvas }) => canvas.toDataURL()).join())`;

const tests = {
  async "loads without a complaint and asks for nothing but itself"(page) {
    assert.equal(await page.eval("document.documentElement.dataset.ready"), "yes");
    assert.deepEqual(page.problems, []);
    assert.deepEqual(page.requests.filter((url) => !url.startsWith("data:")).length, 1);
    assert.equal(await page.eval("document.title"), "Two blocks · tetlap");
  },

  async "draws both runs"(page) {
    const colours = await page.eval(COLOURS);
    assert.equal(colours.length, 2);
    for (const count of colours) assert.ok(count > 50, `${count} colours`);
  },

  async "decodes positions to within the step of their scale"(page, { runs }) {
    // The first body's lowest vertex rests on the ground z = 0 at the start.
    const places = await page.eval("(tetlap.transport.seek(0), Array.from(tetlap.stage.views[0].places))");
    const { low, high, size } = await page.eval("(({ low, high, size }) => ({ low, high, size }))(tetlap.stage.world)");
    const summary = JSON.parse(readFileSync(join(runs[0], "summary.json"), "utf8"));
    assert.equal(places.length, 3 * summary.vertices);
    const middle = low.map((value, k) => (value + high[k]) / 2);
    const least = Math.min(...places.filter((_, i) => i % 3 === 2)) + middle[2];
    assert.ok(Math.abs(least) < (size / 65534) * 2, `lowest z is ${least}`);
  },

  async "scrubs: time, picture and readings follow"(page) {
    const before = await page.eval(PICTURE);
    await page.eval(`(() => { const range = document.querySelector(".scrub"); range.value = 10; range.dispatchEvent(new Event("input")); })()`);
    assert.equal(await page.eval("tetlap.state.time"), 0.1);
    assert.equal(await page.eval(`document.querySelector(".time").value`), "0.100 s");
    assert.notEqual(await page.eval(PICTURE), before);
    const shown = await page.eval(`document.querySelector("#plot-force output").value`);
    const row = await page.eval("tetlap.data.runs[0].forces[0].values[10]");
    assert.ok(Math.abs(parseFloat(shown) - row) <= 0.01 * row, `${shown} for ${row} N`);
  },

  async "plays to the end and stops"(page) {
    await page.eval(`(tetlap.transport.seek(15), tetlap.transport.speed = 8, document.querySelector(".play").click())`);
    assert.equal(await page.eval("tetlap.state.isPlaying"), true);
    await page.until("!tetlap.state.isPlaying");
    assert.equal(await page.eval("tetlap.transport.index"), 20);
  },

  async "is worked by keys"(page) {
    await page.eval("(tetlap.transport.seek(5), document.activeElement.blur())");
    await page.key("ArrowRight");
    assert.equal(await page.eval("tetlap.transport.index"), 6);
    await page.key("Home");
    assert.equal(await page.eval("tetlap.transport.index"), 0);
    await page.key("x", "KeyX");
    assert.equal(await page.eval("tetlap.state.cut"), 0);
    await page.key("x", "KeyX");
    assert.equal(await page.eval("tetlap.state.cut"), -1);
    const theme = await page.eval("tetlap.state.theme");
    await page.key("t", "KeyT");
    assert.notEqual(await page.eval("document.documentElement.dataset.theme"), theme);
    await page.key("t", "KeyT");
    const before = await page.eval(PICTURE);
    await page.eval("tetlap.stage.views[1].canvas.focus()");
    await page.key("ArrowLeft");
    assert.equal(await page.eval("tetlap.transport.index"), 0); // the camera turned, time did not
    assert.notEqual(await page.eval(PICTURE), before);
  },

  async "turns both views with one camera"(page) {
    const box = await page.eval("(({ left, top, width, height }) => ({ left, top, width, height }))(tetlap.stage.views[0].canvas.getBoundingClientRect())");
    const before = await page.eval("tetlap.stage.views.map(({ canvas }) => (tetlap.stage.renderNow(), canvas.toDataURL()))");
    const [x, y] = [box.left + box.width / 2, box.top + box.height / 2];
    await page.mouse("mousePressed", x, y, 1);
    await page.mouse("mouseMoved", x + 60, y + 10, 1);
    await page.mouse("mouseReleased", x + 60, y + 10, 0);
    const after = await page.eval("tetlap.stage.views.map(({ canvas }) => (tetlap.stage.renderNow(), canvas.toDataURL()))");
    assert.notEqual(after[0], before[0]);
    assert.notEqual(after[1], before[1]);
  },

  async "cuts the bodies open: the section lies in the plane and its area is the body's"(page) {
    await page.eval("(tetlap.transport.seek(0), tetlap.state.set({ cut: 2, cutShare: 0.3 }))");
    const [area, depth] = await page.eval(`(() => {
      const view = tetlap.stage.views[0];
      const p = view.section.geometry.getAttribute("position").array;
      let area = 0, depth = 0;
      for (let t = 0; t < view.room.triangleCount; t++) {
        const [x0, y0, z0, x1, y1, z1, x2, y2, z2] = p.subarray(9 * t, 9 * t + 9);
        area += Math.abs((x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)) / 2;
        for (const z of [z0, z1, z2]) depth = Math.max(depth, Math.abs(z - view.cut.place));
      }
      return [area, depth / tetlap.stage.world.size];
    })()`);
    assert.ok(Math.abs(area - 0.04) < 1e-5, `the lower block's section is ${area}, not 0.2 × 0.2`); // at rest
    assert.ok(depth < 1e-3, `${depth}`);
    assertDrawn(await page.eval(COLOURS));
    await page.eval("tetlap.state.set({ cut: -1 })");
  },

  async "colours by every field"(page) {
    const names = await page.eval(`[...document.querySelectorAll("#field option")].map((option) => option.value)`);
    for (const wanted of ["von_mises", "contact_force", "contact_traction", "overlap_fraction", "det_F", "body"]) assert.ok(names.includes(wanted), wanted);
    await page.eval("tetlap.transport.seek(14)");
    const pictures = new Set();
    const marks = names.filter((name) => ["trouble", "wrong_way"].includes(name)); // borne by nothing, they look alike
    const same = ["contact_traction"]; // without friction as large as the pressure
    for (const name of names.filter((other) => !marks.includes(other))) {
      await page.eval(`tetlap.state.set({ field: ${JSON.stringify(name)} })`);
      await page.until(`tetlap.stage.fields.some((field) => field?.name === ${JSON.stringify(name)})`);
      pictures.add(await page.eval(PICTURE));
    }
    assert.equal(pictures.size, names.length - marks.length - same.length);
    assert.equal(marks.length, 2);
    await page.eval(`tetlap.state.set({ field: "von_mises" })`);
  },

  async "a class is painted as it is at vertices, and nothing between two of them"(page) {
    await page.eval("tetlap.transport.seek(14)");
    await page.eval(`tetlap.state.set({ field: "contact_status" })`);
    await page.until(`tetlap.stage.fields.some((field) => field?.name === "contact_status")`);
    const legend = await page.eval(`[...document.querySelectorAll(".legend .class:not(.obstacles)")].map((one) => one.textContent)`);
    assert.deepEqual(legend, ["open", "sticks", "slides"]);
    const codes = await page.eval(`[...new Set(tetlap.stage.views[0].surface.geometry.getAttribute("codes").array)].sort()`);
    assert.deepEqual(codes, [0, 2]); // without friction what touches slides
    // The colours of what sticks are redder than they are blue; none of the others is, and edges are grey.
    const sticks = await page.eval(`(() => {
      tetlap.stage.renderNow();
      const { canvas } = tetlap.stage.views[0], gl = canvas.getContext("webgl2"), bytes = new Uint8Array(4 * canvas.width * canvas.height);
      gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
      let count = 0;
      for (let k = 0; k < bytes.length; k += 4) count += bytes[k] > bytes[k + 2] + 40;
      return count;
    })()`);
    assert.equal(sticks, 0);
    await page.eval(`tetlap.state.set({ field: "von_mises" })`);
  },

  async "plots have a line for each quantity and all its points"(page) {
    const plots = await page.eval(`tetlap.plots.map(({ plot, element }) => ({ id: plot.id, series: plot.series.length,
      lines: element.querySelectorAll("g[aria-label=line] path").length, dots: element.querySelectorAll(".dot").length,
      points: [...element.querySelectorAll("g[aria-label=line] path")].map((path) => path.getAttribute("d").split(/[ML]/).length - 1),
      finite: plot.series.map(({ values }) => values.filter(Number.isFinite).length) }))`);
    assert.deepEqual(plots.map(({ id }) => id), ["force", "force-1", "energy", "error", "step"]);
    for (const plot of plots) {
      assert.equal(plot.lines, plot.series, plot.id);
      assert.equal(plot.dots, plot.series, plot.id);
      plot.points.forEach((count, k) => assert.ok(count >= plot.finite[k], `${plot.id}: ${count} of ${plot.finite[k]} points`));
    }
  },

  async "what both runs have the same curve of is named once"(page) {
    assert.match(await page.eval(`document.querySelector("#plot-energy .together").textContent`), /^The same curve for both runs: kinetic, elastic/);
  },

  async "a plot sets the time where it is pressed"(page) {
    const place = await page.eval(`(() => { const plot = tetlap.plots[0]; plot.area.scrollIntoView({ block: "center" });
      const box = plot.area.querySelector("svg").getBoundingClientRect(); return [box.left + plot.x.apply(0.05), box.top + box.height / 2]; })()`);
    await page.mouse("mousePressed", ...place, 1);
    await page.mouse("mouseReleased", ...place, 0);
    assert.equal(await page.eval("tetlap.state.time"), 0.05);
  },

  async "the frontier has every point, labelled, and tells about it"(page) {
    const [points, labels] = await page.eval(`[".point", ".label"].map((name) => document.querySelectorAll("#frontier " + name).length)`);
    assert.equal(points, PARETO.points.length);
    assert.equal(labels, PARETO.points.length);
    const filled = await page.eval(`[...document.querySelectorAll("#frontier .plot:first-child .point")].map((point) => point.getAttribute("r") === "5")`);
    assert.deepEqual(filled, [true, true, false, false]); // clip, exact; geo and slow are beaten by clip
    await page.eval(`document.querySelector("#frontier .point").focus()`);
    assert.match(await page.eval(`document.querySelector("#frontier .tip:not([hidden])").textContent`), /clip.*100\u2009ns/);
    await page.eval("document.activeElement.blur()");
  },

  async "the headline, the plot and the history agree about the largest force"(page, { runs }) {
    const { contact_force_max } = JSON.parse(readFileSync(join(runs[0], "summary.json"), "utf8"));
    const peaks = await page.eval(`Array.from(tetlap.data.runs[0].columns.contact_force_peak_N)`);
    assert.ok(Math.abs(Math.max(...peaks) / contact_force_max - 1) < 1e-9, `${Math.max(...peaks)} and ${contact_force_max}`);
    assert.match(await page.eval(`document.querySelector("#plot-force .readings").textContent`), /largest since the last row/);
  },

  async "tells how wrong the contact may be, a row for each two that touched"(page, { runs }) {
    const contacts = runs.flatMap((run) => JSON.parse(readFileSync(join(run, "summary.json"), "utf8")).contacts);
    assert.ok(contacts.length > 0);
    assert.equal(await page.eval(`document.querySelectorAll("#contacts tbody tr").length`), contacts.length);
  },

  async "says where the time went, in full"(page, { runs }) {
    const { phases } = JSON.parse(readFileSync(join(runs[0], "summary.json"), "utf8"));
    assert.equal(await page.eval(`document.querySelectorAll("#phases .row:first-child .piece").length`), Object.keys(phases).length);
    const named = await page.eval(`[...document.querySelectorAll("#phases .row:first-child .piece")].map(({ title }) => title)`);
    named.forEach((title) => assert.match(title, /^[A-Z]/)); // a phase that the page does not know has its key
    const drawn = await page.eval(`[...document.querySelectorAll("#phases .piece")].map((piece) => getComputedStyle(piece).backgroundColor)`);
    const paper = await page.eval("getComputedStyle(document.body).backgroundColor");
    drawn.forEach((colour) => assert.ok(colour !== paper && colour !== "rgba(0, 0, 0, 0)", colour));
    const { effects } = JSON.parse(readFileSync(join(runs[0], "summary.json"), "utf8"));
    assert.deepEqual(
      [...new Set(await page.eval(`[...document.querySelectorAll("#phases tr[data-effect]")].map((row) => row.dataset.effect)`))],
      Object.keys(effects),
    );
    assert.match(await page.eval(`document.querySelector("#manifest").textContent`), /tetlap run/);
  },
};

// The corners of an obstacle in the frame that is shown, as drawn: [[x, y, z], …] in space.
const CORNERS = (name) => `(() => {
  const view = tetlap.stage.views[0];
  const at = view.solids.geometry.getAttribute("position").array;
  const corners = [];
  view.obstacles.triangles.forEach(({ shape }, t) => {
    if (shape.name !== "${name}") return;
    for (let corner = 3 * t; corner < 3 * t + 3; corner++) corners.push([0, 1, 2].map((k) => at[3 * corner + k] + view.world.origin[k]));
  });
  return corners;
})()`;

const boxOf = (corners) => [0, 1, 2].map((k) => [Math.min(...corners.map((x) => x[k])), Math.max(...corners.map((x) => x[k]))]);

// tests/scenes/obstacle_shapes.yaml over 1 s in 10 frames.
const obstacleTests = {
  async "obstacles without a mesh are where they stand or have moved to"(page) {
    const boxes = {
      0: { ball: [[0.75, 1.25], [-0.25, 0.25], [0.25, 0.75]], blade: [[2.8, 3.2], [0.95, 1.05], [0.4, 0.6]] },
      10: { ball: [[0.75, 1.25], [-0.25, 0.25], [0.25, 0.75]], blade: [[2.95, 3.05], [0.8, 1.2], [0.9, 1.1]] }, // a quarter turn, 0.5 m up
    };
    for (const [frame, solids] of Object.entries(boxes)) {
      await page.eval(`tetlap.transport.seek(${frame})`);
      for (const [name, wanted] of Object.entries(solids)) {
        const box = boxOf(await page.eval(CORNERS(name))).flat();
        wanted.flat().forEach((value, k) => assert.ok(Math.abs(box[k] - value) < 1e-3, `${name} in frame ${frame}: ${box}`));
      }
    }
  },

  async "they turn: the lines between their faces go round"(page) {
    await page.eval("tetlap.transport.seek(0)");
    const [before, weights] = await page.eval(`[${CORNERS("roller")}, Array.from(tetlap.stage.views[0].obstacles.weights())]`);
    assert.ok(weights.includes(0) && weights.filter((weight) => weight === 0).length < weights.length / 4);
    await page.eval("tetlap.transport.seek(1)"); // by 1 rad about y, through (3, 2, 0.5), and 0.02 m up
    const after = await page.eval(CORNERS("roller"));
    before.forEach(([x, y, z], i) => {
      const turned = [3 + (x - 3) * Math.cos(1) + (z - 0.5) * Math.sin(1), y, 0.52 - (x - 3) * Math.sin(1) + (z - 0.5) * Math.cos(1)];
      turned.forEach((value, k) => assert.ok(Math.abs(after[i][k] - value) < 1e-3, `corner ${i}: ${after[i]} instead of ${turned}`));
    });
  },

  async "half-spaces are grids at their height, and no part of the box around the scene"(page) {
    const height = (frame) => `(tetlap.transport.seek(${frame}), tetlap.stage.views[0].grids.map(({ grid, up, shape }) => [shape.name, grid.position.clone().add({ x: tetlap.stage.world.origin[0], y: tetlap.stage.world.origin[1], z: tetlap.stage.world.origin[2] }).dot(up)]))`;
    const [first, last] = [await page.eval(height(0)), await page.eval(height(10))];
    assert.deepEqual(first.map(([name]) => name), ["ground", "slope"]);
    const wanted = [[0, -2.4], [0, 0.6]]; // the slope rises by (1, 2, 3) · (0.6, 0, 0.8)
    [first, last].forEach((heights, k) => heights.forEach(([name, value], i) => assert.ok(Math.abs(value - wanted[k][i]) < 2e-3, `${name}: ${value}`)));
    const { near } = await page.eval("tetlap.stage.world");
    assert.ok(near.low[2] > -1 && near.high[0] <= 3.5, JSON.stringify(near)); // the roller's side is at 3.3
    assert.equal((await page.eval(CORNERS("ground"))).length, 0);
  },

  async "they are seen, and in the colour of no field"(page) {
    const pictures = await page.eval(`(() => {
      const { solids } = tetlap.stage.views[0];
      const shown = ${PICTURE};
      solids.visible = false;
      const hidden = ${PICTURE};
      solids.visible = true;
      return [shown, hidden];
    })()`);
    assert.notEqual(pictures[0], pictures[1]);
    const codes = await page.eval(`[...new Set(tetlap.stage.views[0].solids.geometry.getAttribute("codes").array)]`);
    assert.deepEqual(codes, [65535]);
  },

  async "the legend lists them, and pointing at one tells its name"(page) {
    const [label, names] = await page.eval(`(({ textContent, title }) => [textContent, title])(document.querySelector(".legend .obstacles"))`);
    assert.equal(label, "8 obstacles");
    assert.equal(names, "ground, ball, crate, pipe, slope, planet, blade, roller");
    const told = await page.eval(`(() => {
      const [view] = tetlap.stage.views;
      const { origin } = tetlap.stage.world;
      const centre = view.grids[0].grid.position.clone().set(1 - origin[0], 0 - origin[1], 0.5 - origin[2]).project(tetlap.stage.camera);
      return view.pick(centre.x, centre.y, tetlap.stage.camera);
    })()`);
    assert.deepEqual(told, { obstacle: "ball" });
  },

  async "a cut opens them, too"(page) {
    const [whole, cut] = await page.eval(`(() => {
      const { surface, section, outline } = tetlap.stage.views[0];
      const picture = () => { for (const body of [surface, section, outline]) body.visible = false; return ${PICTURE}; };
      const whole = (tetlap.state.set({ cut: -1 }), picture());
      const cut = (tetlap.state.set({ cut: 0, cutShare: 0.5 }), picture());
      surface.visible = true;
      tetlap.state.set({ cut: -1 });
      return [whole, cut];
    })()`);
    assert.notEqual(whole, cut);
  },
};

const VERDICT = (name, model) => `#stress button[aria-label^="${name}, ${model}:"]`;

const stressTests = {
  async "the table of hard cases has a mark for every case and model, the later file's where both know one"(page) {
    assert.equal(await page.eval("document.title"), "Stability · tetlap");
    const labels = await page.eval(`[...document.querySelectorAll("#stress button.cell")].map((cell) => cell.getAttribute("aria-label"))`);
    assert.equal(labels.length, STRESS.rows.length);
    assert.ok(labels.includes("spikes, clip: held"), labels.join("; "));
    assert.ok(labels.includes("mat twist, clip: known limit"));
    assert.equal(await page.eval(`document.querySelectorAll("#stress table svg.failed").length`), 0);
    assert.match(await page.eval(`document.querySelector("#stress .key-line").textContent`), /3 held.*1 within.*1 known limit/);
  },

  async "a mark that is pointed at tells its reason, as text"(page) {
    const box = await page.eval(`(({ left, top, width, height }) => [left + width / 2, top + height / 2])(document.querySelector('${VERDICT("mat twist", "clip")}').getBoundingClientRect())`);
    await page.mouse("mouseMoved", ...box);
    const text = await page.eval(`document.querySelector("#stress .tip:not([hidden])").textContent`);
    for (const wanted of ["mat twist · clip", "known limit", "it turns <inside> out", "trouble.inverted", "energy gain", "0.5", "2.5\u2009s"]) assert.ok(text.includes(wanted), `${wanted} in ${text}`);
    await page.mouse("mouseMoved", 2, 2);
    assert.equal(await page.eval(`document.querySelectorAll("#stress .tip:not([hidden])").length`), 0);
  },

  async "a tap tells it as well, and within the page"(page) {
    for (const cell of [VERDICT("uniform", "geo"), VERDICT("crush", "clip")]) {
      await page.eval(`document.querySelector('${cell}').click()`);
      const [left, right, wide] = await page.eval(`(({ left, right }) => [left, right, document.documentElement.clientWidth])(document.querySelector("#stress .tip:not([hidden])").getBoundingClientRect())`);
      assert.ok(left >= 0 && right <= wide, `${left} … ${right} of ${wide}`);
    }
  },

  async "arrows go from mark to mark, one stop of the tab key"(page) {
    assert.equal(await page.eval(`document.querySelectorAll("#stress button.cell[tabindex='0']").length`), 2);
    await page.eval(`document.querySelector('${VERDICT("drop", "clip")}').focus()`);
    await page.key("ArrowDown");
    assert.match(await page.eval(`document.activeElement.getAttribute("aria-label")`), /^crush, clip/);
    assert.match(await page.eval(`document.querySelector("#stress .tip:not([hidden])").textContent`), /though a limit is known/);
    await page.key("Escape");
    assert.equal(await page.eval(`document.querySelectorAll("#stress .tip:not([hidden])").length`), 0);
    await page.eval("document.activeElement.blur()");
  },

  async "what was held can be left out"(page) {
    const lines = `[...document.querySelectorAll("#stress tbody tr")].filter((line) => line.offsetParent).length`;
    const before = await page.eval(lines);
    await page.eval(`document.querySelector("#stress input").click()`);
    assert.equal(await page.eval(lines), before - 2); // drop; spikes, as the later file knows it
    await page.eval(`document.querySelector("#stress input").click()`);
    assert.equal(await page.eval(lines), before);
  },
};

// history.csv of a model as rows of numbers by name.
function historyOf(folder, model) {
  const [head, ...lines] = readFileSync(join(folder, model, "history.csv"), "utf8").trim().split("\n");
  const names = head.split(",");
  return lines.map((line) => Object.fromEntries(line.split(",").map((text, k) => [names[k], Number(text)])));
}

const verdictTests = {
  async "a verdict tells its grades, what decided them, and every figure"(page) {
    assert.equal(await page.eval("document.title"), "What the models are fit for · tetlap");
    const textsOf = (query) => page.eval(`[...document.querySelectorAll(${JSON.stringify(query)})].map((one) => one.textContent)`);
    assert.deepEqual(await textsOf("#verdict .grade b"), ["yes", "no", "no", "yes", "no", "yes"]);
    assert.deepEqual((await textsOf("#verdict .reason")).slice(0, 2), ["not measured: error of nodal forces on unseen bodies, at most 0.01 is asked", "edge: 4.76 steps over those of clip, at most 1.5 is asked"]);
    assert.deepEqual(await textsOf("#verdict [data-met=false]"), ["–", "–", "4.76edge"]);
    assert.ok((await textsOf("#verdict tbody th")).includes("Paper's pairs right"));
    const rows = await textsOf("#verdict tr");
    assert.ok(rows.includes("Classes that could not be asked22"), rows.join("\n"));
    assert.ok(rows.some((row) => row.startsWith("edge<edges> crossminepassed through100\u2009%4.76\u2009%")), rows.join("\n"));
    assert.deepEqual(await textsOf("#verdict .outcome"), ["passed through", "finished"]);
  },
  async "a verdict draws errors on pairs against errors in place, where two models have both"(page) {
    const labels = await page.eval(`[...document.querySelectorAll("#verdict .point")].map((one) => one.getAttribute("aria-label"))`);
    assert.deepEqual(labels, ["mine: 0.42\u2009%, error 4.76\u2009%", "geo: 1.85\u2009%, error 1.08\u2009%"]);
    await page.eval(`document.querySelector("#verdict .point").focus()`);
    assert.match(await page.eval(`document.querySelector("#verdict .tip").textContent`), /nodal forces, worst4\.76\u2009%sceneedgeruns that ended0 of 1/);
  },
};

const compareTests = {
  async "all models of a comparison are shown, and it opens where their forces differ most"(page, { folder }) {
    assert.deepEqual(await page.eval("tetlap.stage.views.map((view) => view.run.label)"), ["clip", "geo", "clip32"]);
    assertDrawn(await page.eval(COLOURS));
    const clip = historyOf(folder, "clip");
    let [most, moment] = [0, -1];
    for (const other of ["geo", "clip32"])
      historyOf(folder, other).forEach((row, i) => {
        const apart = Math.hypot(...Object.keys(row).filter((key) => /^force_.*_N$/.test(key)).map((key) => row[key] - clip[i][key]));
        if (apart > most) [most, moment] = [apart, row.time_s];
      });
    assert.ok(most > 0 && moment > 0, "they differ");
    assert.ok(Math.abs((await page.eval("tetlap.state.time")) - moment) < 1e-9, `${await page.eval("tetlap.state.time")} for ${moment}`);
  },

  async "the tables have every model, and what failed looks failed"(page) {
    const rows = (n) => page.eval(`[...document.querySelectorAll("#compare table")][${n}].querySelectorAll("tbody tr").length`);
    assert.equal(await rows(0), 12); // four quantities of geo, clip32, exact against clip
    assert.equal(await rows(1), 3);
    const [text, colour, plain] = await page.eval(`(() => { const cells = [...document.querySelectorAll("#compare td.outcome")]; return [cells[2].textContent, getComputedStyle(cells[2]).color, getComputedStyle(cells[0]).color]; })()`);
    assert.equal(text, "failed");
    assert.notEqual(colour, plain);
    const geo = await page.eval("tetlap.data.comparison[1].audit_force_error");
    assert.ok(geo > 0 && geo < 0.1);
    await page.eval("tetlap.transport.seek(20)");
    assert.deepEqual(await page.eval(`[...document.querySelectorAll(".pane .ended")].map((one) => !one.hidden)`), [false, false, true]);
  },

  async "plots have a line of each model, distances a band, the audit one without a run as well"(page) {
    const lines = (id) => page.eval(`[...document.querySelectorAll("#plot-${id} .reading > span:nth-of-type(1)")].map((one) => one.textContent)`);
    assert.deepEqual(await lines("force"), ["clip", "geo", "clip32"]);
    assert.deepEqual(await lines("distance"), ["geo", "clip32"]);
    assert.deepEqual(await lines("audit"), ["geo", "clip32", "exact"]);
    assert.ok((await page.eval(`document.querySelectorAll("#plot-distance svg [aria-label=area] path").length`)) >= 1);
    assert.equal(await page.eval(`document.querySelectorAll("#phases .bar").length`), 3);
    const hues = await page.eval(`[...document.querySelectorAll("#plot-audit .reading line")].map((one) => one.getAttribute("stroke"))`);
    const clip = await page.eval(`document.querySelector("#plot-force .reading line").getAttribute("stroke")`);
    assert.equal(new Set([...hues, clip]).size, 4, `${hues} and the reference's ${clip}`);
  },

  async "the audit says sums, median and worst state, and errors have a floor"(page) {
    const heads = await page.eval(`[...document.querySelectorAll("#compare table")[0].querySelectorAll("thead th")].map((one) => one.textContent)`);
    assert.deepEqual(heads, ["Model", "Errors of", "Sums", "Median", "Worst", "at", "States"]);
    const row = await page.eval("tetlap.data.comparison[1]");
    assert.ok(row.audit_force_error_worst >= row.audit_force_error_median && row.audit_force_error_worst_time > 0);
    // the exact model differs from clip by rounding, the network by percents
    const ends = await page.eval(`(() => { const ticks = [...document.querySelectorAll("#plot-audit svg [aria-label='y-axis tick label'] text")]; return [ticks[0].textContent, ticks.at(-1).textContent]; })()`);
    const [low, high] = ends.map((text) => Math.log10(Number(text)) || -Number([..."⁰¹²³⁴⁵⁶⁷⁸⁹"].reduce((t, digit, k) => t.replaceAll(digit, k), text.replace("10⁻", ""))));
    assert.ok(high - low <= 8, `the axis spans ${ends}`);
  },

  async "curves that coincide are striped, and named"(page) {
    const [named, label, dashes, offsets] = await page.eval(`(() => { const plot = document.querySelector("#plot-force"), lines = [...plot.querySelectorAll("svg [aria-label=line] path")];
      return [plot.querySelector(".together").textContent, plot.querySelector("svg[role=img]").getAttribute("aria-label"),
        lines.map((line) => line.getAttribute("stroke-dasharray")), lines.map((line) => line.getAttribute("stroke-dashoffset"))]; })()`);
    const members = /^Curves that coincide: (.*)\.$/.exec(named)?.[1].split(", ");
    assert.ok(members?.includes("clip") && members.includes("clip32"), named); // 1e-5 of the force apart
    assert.ok(label.endsWith(named), label);
    const order = ["clip", "geo", "clip32"].filter((one) => members.includes(one));
    ["clip", "geo", "clip32"].forEach((one, k) => {
      assert.equal(dashes[k], members.includes(one) ? `6 ${6 * (members.length - 1)}` : null, one);
      if (members.includes(one)) assert.equal(Math.abs(offsets[k]), 6 * order.indexOf(one), one);
    });
    assert.deepEqual(await page.eval(`[...document.querySelectorAll(".together")].map((one) => one.hidden === (one.textContent === ""))`), await page.eval("tetlap.plots.map(() => true)"));
    const apart = await page.eval(`document.querySelector("#plot-audit .together").textContent`);
    assert.ok(!/geo/.test(apart), apart); // its error is a hundred times clip32's
  },

  async "what is the same of all runs stands in the manifest once"(page) {
    const names = await page.eval(`[...document.querySelectorAll("#manifest .manifest")].map((one) => [...one.querySelectorAll("dt")].map((dt) => dt.textContent))`);
    assert.equal(names.length, 4); // all runs, and three
    for (const name of ["Processor", "tetlap", "compiler"]) assert.deepEqual(names.map((list) => list.includes(name)), [true, false, false, false], name);
    assert.deepEqual(names.map((list) => list.includes("Command")), [false, true, true, true]); // clip32's is another
  },

  async "all plots have the same axis of time"(page) {
    const extents = await page.eval("tetlap.plots.map((plot) => plot.x.domain.join())");
    assert.ok(extents.length > 4);
    assert.deepEqual([...new Set(extents)], ["0,0.06"]);
  },

  async "contacts stand together by bodies, in the order of the runs"(page) {
    const rows = await page.eval(`[...document.querySelectorAll("#contacts tbody tr")].map((row) => [row.cells[0].textContent, row.cells[1].textContent])`);
    const pairs = [...new Set(rows.map(([pair]) => pair))];
    assert.deepEqual(rows, pairs.flatMap((pair) => ["clip", "geo", "clip32"].filter((run) => rows.some((row) => row[0] === pair && row[1] === run)).map((run) => [pair, run])));
    assert.ok(rows.length > 2, String(rows));
  },

  async "one camera turns them all, by keys as well, and all has a name"(page) {
    const pictures = () => page.eval("tetlap.stage.views.map(({ canvas }) => (tetlap.stage.renderNow(), canvas.toDataURL()))");
    const before = await pictures();
    await page.eval("tetlap.stage.views[2].canvas.focus()");
    await page.key("ArrowLeft");
    (await pictures()).forEach((picture, k) => assert.notEqual(picture, before[k], `view ${k}`));
    const nameless = await page.eval(`[...document.querySelectorAll("canvas, [role=region], svg[role=img], input, select, button")].filter((one) => !one.getAttribute("aria-label") && !one.textContent.trim() && !one.labels?.length).length`);
    assert.equal(nameless, 0);
  },
};

// What a reading says stands beside its number, not below or on it.
const CROWDED = `[...document.querySelectorAll(".reading")].filter((one) => {
  const [name, value] = [one.querySelector(".name"), one.querySelector("output")].map((part) => part.getBoundingClientRect());
  return name.right > value.left + 0.5 || value.right > one.getBoundingClientRect().right + 0.5;
}).map((one) => one.textContent)`;

const fileTests = {
  async "weights files have one name everywhere, and no path is above the page"(page) {
    const names = ["clip", `networks-of-search-0/${LONG}`, `networks-of-search-1/${LONG}`];
    assert.deepEqual(await page.eval("tetlap.stage.views.map((view) => view.run.label)"), names);
    const texts = (selector) => page.eval(`[...document.querySelectorAll('${selector}')].map((one) => one.textContent)`);
    assert.deepEqual(await texts("#plot-force .reading .name"), names);
    assert.deepEqual(await texts("#compare th[scope=rowgroup]"), [...names.slice(1), "exact", "clip-scalar"]);
    assert.deepEqual(await texts("#plot-audit .reading .name"), [...names.slice(1), "exact", "clip-scalar"]);
    assert.deepEqual(await texts("#compare .scroll:last-of-type th[scope=row]"), ["clip (reference)", ...names.slice(1)]); // of their own runs
    const facts = await texts(".facts span");
    assert.equal(facts[0], "02_two_blocks.yaml");
    assert.equal(facts.at(-1), `overlap: ${names.join(", ")}`);
    assert.deepEqual(await page.eval(`[...document.querySelectorAll("#manifest dt")].filter((one) => one.textContent === "Weights file").map((one) => one.nextSibling.textContent.startsWith("/"))`), [true, true]);
  },

  async "a model has one colour in tables and curves, with a run and without"(page) {
    const [rows, curves] = await page.eval(`(() => { const colour = (text) => { const one = document.createElement("i"); one.style.color = text; document.body.append(one); const value = getComputedStyle(one).color; one.remove(); return value; };
      return [[...document.querySelectorAll("#compare th[scope=rowgroup] .swatch")].map((one) => getComputedStyle(one).backgroundColor), [...document.querySelectorAll("#plot-audit .reading line")].map((one) => colour(one.getAttribute("stroke")))]; })()`);
    assert.equal(new Set(rows).size, 4, String(rows));
    assert.deepEqual(rows, curves);
  },

  async "nothing is cut off: the audit's table fits, and every number stands beside its name"(page) {
    assert.deepEqual(await page.eval(`[...document.querySelectorAll("#compare .scroll")].map((one) => one.scrollWidth <= one.clientWidth)`), [true, true]);
    assert.deepEqual(await page.eval(CROWDED), []);
    const errors = await page.eval(`[...document.querySelectorAll("#compare table")[0].querySelectorAll("tbody:first-of-type td.number")].map((one) => one.textContent)`);
    const contacts = await page.eval(`[...document.querySelectorAll("#contacts td")].map((one) => one.textContent)`);
    assert.ok(contacts.includes("< 0.001\u2009%") && !contacts.some((text) => /⁻\d*.*%/.test(text)), String(contacts)); // no digits of rounding
    assert.match(errors[0], /^0\.\d\d\u2009%$/); // of geo-small's volumes
  },
};

async function testForcesTwo(browser, url) {
  const page = await browser.open(url, { width: 1280, height: 900 });
  const plots = await page.eval(`tetlap.plots.filter(({ plot }) => plot.id.startsWith("force")).map(({ plot, element }) => ({ title: plot.title, names: plot.series.map(({ label }) => label), hues: [...element.querySelectorAll(".reading line")].map((one) => one.getAttribute("stroke")) }))`);
  assert.deepEqual(plots.map(({ title }) => title), ["Contact force, cube – ground", "Contact force, cube – slope"]);
  for (const { names, hues } of plots) {
    assert.deepEqual(names.slice(0, 2), ["obstacles", "again"]);
    assert.notEqual(hues[0], hues[1]);
    assert.deepEqual(hues.slice(0, 2), plots[0].hues.slice(0, 2));
  }
  await page.close();
}

async function testFilesTwo(browser, url) {
  const page = await browser.open(url, { width: 1280, height: 900 });
  const text = await page.eval(`document.querySelector("#plot-error").textContent`);
  assert.ok(text.includes(`networks-of-search-1/${LONG} against networks-of-search-0/${LONG}`), text);
  assert.ok(text.includes("forces apart") && !text.includes("B − A"), text); // letters stand nowhere else
  assert.deepEqual(await page.eval(CROWDED), []);
  const key = await page.eval(`[...document.querySelectorAll(".overview .key-line span:not(.swatch)")].map((one) => one.textContent)`);
  assert.deepEqual(key, [0, 1].map((k) => `networks-of-search-${k}/${LONG}`)); // of the figures' colours
  await page.close();
}

const sweepTests = {
  async "a sweep's page has a plot of each quantity, and a row of each run"(page) {
    assert.equal(await page.eval("document.title"), "Sweep of 02_two_blocks · tetlap");
    assert.equal(await page.eval(`document.querySelectorAll("#sweep tbody tr").length`), 6);
    assert.equal(await page.eval(`document.querySelectorAll("#sweep tbody tr[data-outcome=failed]").length`), 3);
    assert.match(await page.eval(`document.querySelector("#sweep .lead").textContent`), /6 runs.*3 finished, 3 failed/);
    const dots = await page.eval(`document.querySelectorAll("#sweep-contact_force_max_N svg circle").length`);
    assert.equal(dots, 3);
    assert.equal(await page.eval(`document.querySelectorAll("#sweep-steps svg [aria-label=dot] path").length`), 3); // crosses
  },

  async "the order of convergence stands at its dot, along the key that it was observed along"(page) {
    const orders = () => page.eval(`[...document.querySelectorAll("#sweep-contact_force_last_N svg .order text")].map((one) => one.textContent)`);
    const known = await page.eval("tetlap.data.sweep.runs.map((run) => run.order).filter(Number.isFinite)");
    assert.equal(known.length, 1);
    assert.deepEqual(await orders(), [`order ${known[0].toFixed(2)}`]);
    const choose = (key) => page.eval(`(() => { const select = document.querySelector("#along"); select.value = "${key}"; select.dispatchEvent(new Event("change")); })()`);
    await choose("bodies.upper.material.poisson");
    assert.deepEqual(await orders(), []);
    await choose("contact.stiffness");
  },

  async "the axis is chosen, and the dots tell the table's numbers"(page) {
    const table = await page.eval("tetlap.data.sweep.runs.map((run) => run.steps).filter(Boolean)");
    const titles = () => page.eval(`[...document.querySelectorAll("#sweep-steps svg circle title")].map((one) => one.textContent)`);
    for (const steps of table) assert.ok((await titles()).some((text) => text.includes(`: ${steps}`)), `${steps} in ${await titles()}`);
    await page.eval(`(() => { const select = document.querySelector("#along"); select.value = "bodies.upper.material.poisson"; select.dispatchEvent(new Event("change")); })()`);
    const courses = await page.eval("tetlap.data.sweep.runs.filter((run) => run.history).length");
    assert.ok(courses >= 3, `${courses} courses of forces`);
    assert.equal(await page.eval(`document.querySelectorAll("#sweep-history svg path[stroke-opacity='0.8'], #sweep-history svg g[stroke-opacity='0.8'] path").length`), courses);
    assert.ok(await page.eval("Math.max(...tetlap.data.sweep.runs.flatMap((run) => run.history?.force_N ?? [])) > 0"));
    assert.ok((await titles()).length > 0, "no circle has a title");
    assert.ok((await titles()).every((text) => text.startsWith("poisson 0.3")), String(await titles()));
    assert.match(await page.eval(`document.querySelector("#sweep-steps svg").getAttribute("aria-label")`), /Steps against bodies.upper.material.poisson/);
  },
};

// The address that `tetlap view` prints.
function serve(folder) {
  mkdirSync(folder, { recursive: true });
  const server = spawn(tetlap, ["view", folder, "-q"], { stdio: ["ignore", "pipe", "inherit"] });
  return new Promise((resolve, reject) => {
    server.stdout.once("data", (text) => resolve({ server, url: String(text).trim() }));
    server.once("exit", () => reject(new Error("tetlap view ended")));
  });
}

// A run is watched from before it begins until it has ended.
async function testLive(browser) {
  const folder = join(out, "live");
  rmSync(folder, { recursive: true, force: true });
  const { server, url } = await serve(folder);
  const page = await browser.open(url, { width: 1280, height: 900 });
  const word = () => page.eval(`document.querySelector(".live [role=status]").textContent`);
  try {
    assert.equal(await word(), "Waiting for the run to begin");
    const run = spawn(tetlap, ["run", scene, "-q", "-o", folder, "-t", "1", "-s", "time.end=20", "-s", "output.frames=2000"], { stdio: ["ignore", "ignore", "inherit"] });
    await page.until("tetlap.times.length > 5 && !!tetlap.stage?.camera", 300);
    assert.equal(await word(), "Running");
    const later = await browser.open(url, { width: 1280, height: 900 }); // opened while the run goes on: at its last frame
    assert.ok(await later.eval("tetlap.state.time > 0 && tetlap.state.time === tetlap.times.at(-1)"));
    await later.eval(`(tetlap.absent = 0, new MutationObserver(() => (tetlap.absent += !document.querySelector("main:not(.arriving) .live"))).observe(document.body, { childList: true, subtree: true }), window.first = tetlap, 0)`);
    await later.until("window.first !== tetlap", 300); // a newer page: the bar was never away
    assert.equal(await later.eval("window.first.absent"), 0);
    await later.close();
    // chosen while the newer page is made, or just before
    await page.eval(`new Promise((done) => new MutationObserver((_, watch) => document.querySelector("main.arriving") && (watch.disconnect(), done(0))).observe(document.body, { childList: true }))`);
    await page.eval("(tetlap.state.set({ cut: 1, theme: 'dark' }), tetlap.stage.controls.target.set(0.01, 0, 0), tetlap.stage.controls.update(), tetlap.before = tetlap.stage, 0)");
    const frames = await page.eval("tetlap.times.length");
    await page.until(`tetlap.times.length > ${frames} && tetlap.stage.views.length === 1`, 300);
    assert.equal(await page.eval("tetlap.before === tetlap.stage"), false);
    assert.deepEqual(await page.eval("[tetlap.state.cut, tetlap.state.theme, tetlap.state.time === tetlap.times.at(-1)]"), [1, "dark", true]);
    run.kill("SIGINT");
    await page.until("tetlap.data.live.outcome === 'interrupted'", 300);
    assert.match(await word(), /^Interrupted/);
    assertDrawn(await page.eval(COLOURS));
    assert.deepEqual(page.problems, []);
    assert.ok(page.requests.length > 0);
    assert.ok(page.requests.every((one) => one.startsWith(url) || one.startsWith("data:")));
  } finally {
    await page.close();
    server.kill("SIGINT");
  }
}

// A run that failed looks so beside one that finished: in its name, its warning and its figure.
async function testFailed(browser, runs) {
  const failed = join(out, "failed-run");
  cpSync(runs[1], failed, { recursive: true });
  const path = join(failed, "summary.json");
  const summary = JSON.parse(readFileSync(path, "utf8"));
  writeFileSync(path, JSON.stringify({ ...summary, outcome: "failed", message: "at t = 0.1 s: it gave up" }));
  execFileSync(tetlap, ["report", "-q", runs[0], failed, "-o", join(out, "failed.html")]);
  const page = await browser.open(`file://${resolve(out, "failed.html")}`, { width: 1280, height: 900 });
  const figures = await page.eval(`[...document.querySelectorAll(".figures dd.failed")].map((one) => one.textContent)`);
  assert.deepEqual(figures, ["failed"]);
  assert.match(await page.eval(`document.querySelector(".warning").textContent`), /: failed at t = 0.1 s: it gave up/);
  assert.deepEqual(page.problems, []);
  await page.close();
  execFileSync(tetlap, ["report", "-q", failed, "-o", join(out, "failed-alone.html")]);
  const alone = await browser.open(`file://${resolve(out, "failed-alone.html")}`, { width: 1280, height: 900 });
  assert.ok(await alone.eval("tetlap.state.time === tetlap.times.at(-1) && tetlap.state.time > 0")); // it opens where it failed
  await alone.close();
}

async function shoot(browser, url, name, view, script) {
  const page = await browser.open(url, view);
  await page.eval(script);
  await new Promise((wake) => setTimeout(wake, 300));
  writeFileSync(join(out, `${name}.png`), await page.screenshot(true));
  const wide = await page.eval("document.documentElement.scrollWidth");
  assert.ok(wide <= view.width, `${name}: the page is ${wide} pixels wide`);
  assert.deepEqual(page.problems, []);
  await page.close();
}

const pages = makePages();
const browser = await launch(chromium);
let failed = 0;
const attempt = async (name, test) => {
  try {
    await test();
    console.log(`ok      ${name}`);
  } catch (error) {
    failed++;
    console.log(`FAILED  ${name}\n${error.stack}`);
  }
};
try {
  const page = await browser.open(pages.two, { width: 1280, height: 900 });
  for (const [name, test] of Object.entries(tests)) await attempt(name, () => test(page, pages));
  await attempt("no complaint after all of it", () => assert.deepEqual(page.problems, []));
  await page.close();
  const shapes = await browser.open(pages.obstacles, { width: 1280, height: 900 });
  for (const [name, test] of Object.entries(obstacleTests)) await attempt(name, () => test(shapes));
  await attempt("no complaint after all of it", () => assert.deepEqual(shapes.problems, []));
  await shapes.close();
  for (const [width, theme] of [[1280, "light"], [1280, "dark"], [400, "light"]])
    await attempt(`obstacles fit ${width} pixels, ${theme}`, () => shoot(browser, pages.obstacles, `obstacles-${theme}-${width}`, { width, height: 1000, theme, isMobile: width < 600 }, "tetlap.transport.seek(5)"));
  for (const width of [1280, 400]) {
    const table = await browser.open(pages.stress, { width, height: 900, isMobile: width < 600 });
    for (const [name, test] of Object.entries(stressTests)) await attempt(`${width} pixels: ${name}`, () => test(table));
    await attempt("no complaint after all of it", () => assert.deepEqual(table.problems, []));
    await table.close();
  }
  const verdict = await browser.open(pages.verdict, { width: 1280, height: 900 });
  for (const [name, test] of Object.entries(verdictTests)) await attempt(name, () => test(verdict));
  await attempt("no complaint after all of it", () => assert.deepEqual(verdict.problems, []));
  await verdict.close();
  for (const [width, theme] of [[1280, "light"], [400, "dark"]])
    await attempt(`a verdict fits ${width} pixels, ${theme}`, () => shoot(browser, pages.verdict, `verdict-${theme}-${width}`, { width, height: 1000, theme, isMobile: width < 600 }, "0"));
  await attempt("forces of two runs have a plot for each two bodies and a colour for each run", () => testForcesTwo(browser, pages.obstaclesTwo));
  await attempt("a run that failed looks so", () => testFailed(browser, pages.runs));
  await attempt("a page follows a run from before it begins to its end", () => testLive(browser));
  const models = await browser.open(pages.models, { width: 1280, height: 900 });
  for (const [name, test] of Object.entries(compareTests)) await attempt(name, () => test(models, pages));
  await attempt("no complaint after all of it", () => assert.deepEqual(models.problems, []));
  await models.close();
  for (const [width, theme] of [[1280, "light"], [420, "light"], [420, "dark"]])
    await attempt(`three models fit ${width} pixels, ${theme}`, () => shoot(browser, pages.models, `models-${theme}-${width}`, { width, height: 1000, theme, isMobile: width < 600 }, "0"));
  const files = await browser.open(pages.files, { width: 1280, height: 900 });
  for (const [name, test] of Object.entries(fileTests)) await attempt(name, () => test(files));
  await files.close();
  await attempt("two files are told apart in words", () => testFilesTwo(browser, pages.filesTwo));
  for (const width of [1280, 420])
    await attempt(`long names fit ${width} pixels`, () => shoot(browser, pages.files, `files-${width}`, { width, height: 1000, isMobile: width < 600 }, "0"));
  const sweep = await browser.open(pages.sweep, { width: 1280, height: 900 });
  for (const [name, test] of Object.entries(sweepTests)) await attempt(name, () => test(sweep));
  await attempt("no complaint after all of it", () => assert.deepEqual(sweep.problems, []));
  await sweep.close();
  for (const [width, theme] of [[1280, "light"], [420, "dark"]])
    await attempt(`a sweep fits ${width} pixels, ${theme}`, () => shoot(browser, pages.sweep, `sweep-${theme}-${width}`, { width, height: 1000, theme, isMobile: width < 600 }, "0"));
  const point = `document.querySelector('${VERDICT("mat twist", "clip")}').focus()`;
  for (const [width, height, theme] of [[1600, 1000, "light"], [1600, 1000, "dark"], [400, 1100, "light"], [400, 1100, "dark"]])
    await attempt(`hard cases fit ${width} pixels, ${theme}`, () => shoot(browser, pages.stress, `stress-${theme}-${width}`, { width, height, theme, isMobile: width < 600 }, point));
  const seek = "tetlap.transport.seek(10)";
  await attempt("fits 1600 pixels, light", () => shoot(browser, pages.two, "light-1600", { width: 1600, height: 1000 }, seek));
  await attempt("fits 1600 pixels, dark", () => shoot(browser, pages.two, "dark-1600", { width: 1600, height: 1000, theme: "dark" }, `${seek}, tetlap.state.set({ cut: 1 })`));
  await attempt("fits 400 pixels, light", () => shoot(browser, pages.two, "light-400", { width: 400, height: 5200, isMobile: true }, seek));
  await attempt("fits 400 pixels, dark; surfaces only", () => shoot(browser, pages.one, "dark-400", { width: 400, height: 3600, theme: "dark", isMobile: true }, seek));
} finally {
  await browser.close();
}
console.log(failed ? `${failed} failed` : "all passed");
process.exit(failed ? 1 : 0);
