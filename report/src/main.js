// SPDX-License-Identifier: GPL-3.0-or-later
import "./style.css";
import { HUES, listFields } from "./view/colour.js";
import { buildComparison } from "./table/compare.js";
import { buildContacts } from "./table/contacts.js";
import { RUNS, indexAt, readData, unionTimes } from "./data/data.js";
import { h } from "./dom.js";
import { buildFrontier } from "./plot/frontier.js";
import { LiveBar, follow } from "./live.js";
import { buildManifest } from "./table/manifest.js";
import { buildHeader, buildOverview } from "./table/overview.js";
import { buildPhases } from "./table/phases.js";
import { TimePlot, listPlots, momentOf } from "./plot/plots.js";
import { present, showFrame } from "./present.js";
import { Stage } from "./view/stage.js";
import { createState } from "./state.js";
import { buildStress } from "./table/stress.js";
import { buildSweep, sweepTitle } from "./plot/sweep.js";
import { Transport } from "./view/transport.js";
import { buildVerdict, verdictTitle } from "./table/verdict.js";

const KEYS = [
  ["Space", "play, pause"],
  ["← →", "a frame back, forward"],
  ["Home End", "first, last frame"],
  ["C", "field to colour by"],
  ["X Y Z", "cut along an axis; again: whole"],
  ["[ ]", "move the cut"],
  ["E", "edges"],
  ["T", "light, dark"],
  ["arrows, + −", "turn and approach the scene that has the focus; or drag, Ctrl and wheel"],
];

const prefersDark = window.matchMedia("(prefers-color-scheme: dark)");

function themeOf() {
  const asked = new URLSearchParams(location.hash.slice(1)).get("theme");
  return asked === "dark" || asked === "light" ? asked : prefersDark.matches ? "dark" : "light";
}

function buildBar(state, version) {
  const toggle = h("button.plain", { type: "button", click: () => state.set({ theme: state.theme === "dark" ? "light" : "dark" }) });
  const show = () => {
    document.documentElement.dataset.theme = state.theme;
    HUES[state.theme].forEach((hue, k) => document.documentElement.style.setProperty(`--hue-${k}`, hue));
    RUNS.forEach((letter, k) => document.documentElement.style.setProperty(`--run-${letter}`, HUES[state.theme][k % HUES.light.length]));
    toggle.textContent = state.theme === "dark" ? "Light" : "Dark";
    toggle.setAttribute("aria-label", `Switch to ${toggle.textContent.toLowerCase()} colours`);
  };
  state.on(["theme"], show);
  show();
  const keys = h("dialog.keys", { "aria-label": "Keys", click: (event) => event.target === keys && keys.close() }, h("h2", "Keys"), h("dl", KEYS.flatMap(([key, what]) => [h("dt", key), h("dd", what)])), h("form", { method: "dialog" }, h("button", "Close")));
  const ask = h("button.plain", { type: "button", click: () => keys.showModal() }, "Keys");
  return h("header.bar-top", h("span.mark", "tetlap", version && h("span.version", version)), h("span.space"), ask, toggle, keys);
}

// What keys do to a page as it is now.
function actionsOf({ state, transport, stage }) {
  const fields = listFields(stage?.runs ?? []);
  const cut = (axis) => state.set({ cut: state.cut === axis ? -1 : axis });
  return {
    " ": () => transport?.toggle(),
    ArrowLeft: () => transport?.step(-1),
    ArrowRight: () => transport?.step(1),
    Home: () => transport?.step(-Infinity),
    End: () => transport?.step(Infinity),
    c: () => fields.length && state.set({ field: fields[(fields.indexOf(state.field) + 1) % fields.length] }),
    x: () => cut(0),
    y: () => cut(1),
    z: () => cut(2),
    "[": () => state.set({ cutShare: Math.max(0, state.cutShare - 0.02) }),
    "]": () => state.set({ cutShare: Math.min(1, state.cutShare + 0.02) }),
    e: () => state.set({ edges: !state.edges }),
    t: () => state.set({ theme: state.theme === "dark" ? "light" : "dark" }),
  };
}

// Keys work wherever the focus is, but in what takes them itself.
function listenToKeys() {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
    const own = event.target.closest?.("select, input, button, summary, pre");
    if (own && !(own.matches(".scrub") && event.key === " ") && !/^[a-z[\]]$/i.test(event.key)) return;
    if (own?.matches("select")) return;
    const action = actionsOf(window.tetlap)[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    event.preventDefault();
    action();
  });
}

function worldSize(runs) {
  const framed = runs.filter((run) => run.frames);
  if (framed.length === 0) return 0;
  const { low, high } = framed[0].frames;
  return Math.hypot(...high.map((value, k) => value - low[k]));
}

// Where a page opens: of runs that are compared, where they differ most; of one that goes on, or failed, at its end; else at the start.
function openingTime(data, times) {
  const isAtEnd = data.live?.outcome === "running" || data.runs[0]?.summary?.outcome === "failed";
  const moment = data.runs.length > 1 ? momentOf(data) : isAtEnd ? times.at(-1) : undefined;
  return times[moment === undefined ? 0 : indexAt(times, moment)] ?? 0;
}

const licences = () => document.getElementById("tetlap-licences")?.textContent.trim() ?? "";

const titleOf = ({ runs, sweep, stress, pareto, live, verdict }) =>
  runs[0]?.summary?.title || runs[0]?.manifest?.scene?.title || runs[0]?.name || (sweep && sweepTitle(sweep)) || (verdict && verdictTitle(verdict)) || (stress && !pareto ? "Stability" : live ? "A run to come" : "Overlap models");

// What the reader has chosen in a page, for a newer one. Who looks at the last frame goes on to what is the last then.
function choicesOf({ state, times: old }, times, fields) {
  const isFollowing = !old.length || state.time === old.at(-1);
  const { theme, cut, cutShare, edges } = state;
  return { theme, cut, cutShare, edges, time: isFollowing ? (times.at(-1) ?? 0) : state.time, field: fields.includes(state.field) ? state.field : fields[0] };
}

// A whole page about these data, not yet in the document. `kept`: the page that it takes the place of.
function build(data, kept) {
  const { runs } = data;
  const framed = runs.filter((run) => run.frames);
  const times = unionTimes(runs);
  const fields = listFields(framed);
  const state = createState({
    theme: themeOf(),
    time: openingTime(data, times),
    isPlaying: false,
    field: fields[0],
    cut: -1,
    cutShare: 0.5,
    edges: true,
    ...(kept && choicesOf(kept, times, fields)),
  });
  const title = titleOf(data);
  document.title = `${title} · tetlap`;

  const transport = times.length > 1 ? new Transport(runs, times, state) : null;
  const stage = framed.length > 0 ? new Stage(framed, state) : null;
  const seek = (time) => {
    transport.pause();
    let best = 0;
    times.forEach((one, i) => Math.abs(one - time) < Math.abs(times[best] - time) && (best = i));
    transport.seek(best);
  };
  const plots = transport ? listPlots(data, worldSize(runs)).map((plot) => new TimePlot(plot, runs, state, seek)) : [];
  const live = data.live ? (kept?.live ?? new LiveBar()) : null;
  const place = h("span", { hidden: true }); // of the bar, which stays in the page that is seen until this one is
  live?.show(data.live);
  const page = h(
    "main",
    buildHeader(runs, title, !!live),
    kept?.live ? place : live?.element,
    buildOverview(runs),
    stage?.element,
    transport?.element,
    data.comparison && buildComparison(data),
    plots.length > 0 && h("section.block", { id: "plots" }, h("h2", "Over time"), h(".plots", plots.map((plot) => plot.element))),
    buildContacts(runs),
    data.verdict && buildVerdict(data.verdict, state),
    data.sweep && buildSweep(data.sweep, state, createState),
    data.pareto && buildFrontier(data.pareto, state),
    data.stress && buildStress(data.stress),
    buildPhases(runs),
    buildManifest(runs),
  );
  return { state, transport, stage, plots, data, live, place, times, fields, page, bar: buildBar(state, data.version), present, showFrame };
}

// A newer page in the place of this one, once it is ready to be seen: same camera, field, cut and scroll.
async function replace(data) {
  const old = window.tetlap;
  old.transport?.pause();
  const place = document.activeElement?.dataset?.place;
  const next = build(data, old);
  next.page.classList.add("arriving");
  document.body.insertBefore(next.page, old.page.nextSibling);
  await next.stage?.load(old.stage?.view());
  next.state.set(choicesOf(old, next.times, next.fields)); // chosen while it was made
  const view = old.stage?.view();
  if (view) next.stage?.setView(view);
  old.bar.replaceWith(next.bar);
  if (next.place.isConnected) next.place.replaceWith(next.live.element);
  old.page.remove();
  next.page.classList.remove("arriving");
  next.stage?.resize();
  old.stage?.destroy();
  window.tetlap = next;
  if (place) document.querySelector(`[data-place="${place}"]`)?.focus({ preventScroll: true });
}

async function start() {
  const data = readData();
  const text = licences();
  const says = data.live ? "Served by tetlap view to this machine alone." : "Made by tetlap report. This page is one file and asks for nothing from any network.";
  const footer = h("footer", h("p", says), text && h("details.more", h("summary", "Licences of what is inside this page"), h("pre", { tabindex: 0 }, text)));
  const page = build(data);
  window.tetlap = page;
  prefersDark.addEventListener("change", () => window.tetlap.state.set({ theme: themeOf() }));
  document.body.replaceChildren(...document.querySelectorAll("body > script"), page.bar, page.page, footer);
  listenToKeys();
  await page.stage?.load();
  for (let frame = 0; frame < 2; frame++) await new Promise(requestAnimationFrame); // plots draw when they know their size
  if (data.live) follow(data.live, (state) => window.tetlap.live.show(state), (source) => replace(readData(source)));
}

start().then(
  () => (document.documentElement.dataset.ready = "yes"),
  (error) => {
    document.documentElement.dataset.ready = "failed";
    document.body.prepend(h("p.warning", `This page could not be shown: ${error.message}`));
    throw error;
  },
);
