// SPDX-License-Identifier: GPL-3.0-or-later
// The views side by side under one camera, one time, one colour scale; and the controls that belong to them.

import { PerspectiveCamera, Spherical, Vector3 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { NO_CODE, decode } from "../data/codes.js";
import { bytesOf, describe, listFields, neutralOf, rampOf, tintsOf } from "./colour.js";
import { indexAt, readFrames } from "../data/data.js";
import { format, h, swatchOf } from "../dom.js";
import { PALETTE, View } from "./scene.js";

const AXES = ["x", "y", "z"];
const STEPS = 256; // of a ramp

// A box around the bodies of all runs in all frames, one around them and what is `near` of the obstacles, and
// the latter's middle and diagonal.
function worldOf(all) {
  const low = [0, 1, 2].map((k) => Math.min(...all.map((frames) => frames.low[k])));
  const high = [0, 1, 2].map((k) => Math.max(...all.map((frames) => frames.high[k])));
  const reach = Math.hypot(...high.map((value, k) => value - low[k])) / 2;
  const near = { low: [...low], high: [...high] };
  for (const { obstacles, time_s } of all)
    obstacles.visit(time_s.length, 1, (at) =>
      at.forEach((p, k) => {
        near.low[k] = Math.max(Math.min(near.low[k], p), low[k] - reach);
        near.high[k] = Math.min(Math.max(near.high[k], p), high[k] + reach);
      }),
    );
  const origin = near.low.map((value, k) => (value + near.high[k]) / 2);
  return { low, high, near, origin, size: Math.hypot(...near.high.map((value, k) => value - near.low[k])) || 1 };
}

// The ends of the colour scale over all runs: the top is where 99.9 % of what is not at rest lies below.
function scaleOf(fields, info) {
  const low = Math.min(...fields.map((field) => field.low));
  const high = Math.max(...fields.map((field) => field.high));
  if (info.isClass) return { low, high, isOpen: false };
  if (info.middle !== undefined) {
    const reach = Math.max(high - info.middle, info.middle - low) || 1;
    return { low: info.middle - reach, high: info.middle + reach, isOpen: false };
  }
  const floor = Math.min(low, 0);
  let top = floor;
  for (const field of fields) {
    const histogram = new Uint32Array(NO_CODE + 1);
    for (const code of field.codes) histogram[code]++;
    const least = Math.ceil(((high - low) * 1e-3) / ((field.high - field.low || 1) / NO_CODE));
    let total = 0;
    for (let code = least; code < NO_CODE; code++) total += histogram[code];
    let above = 0;
    let code = NO_CODE - 1;
    while (code > least && above + histogram[code] <= 1e-3 * total) above += histogram[code--];
    top = Math.max(top, decode(field.low, field.high, code));
  }
  return { low: floor, high: top > floor ? top : high > floor ? high : floor + 1, isOpen: top < high * 0.999 };
}

export class Stage {
  constructor(runs, state) {
    this.runs = runs;
    this.state = state;
    this.fieldNames = listFields(runs);
    this.views = [];
    this.isDue = false;
    this.element = this.build();
  }

  build() {
    this.panes = h(".panes", { "data-count": this.runs.length > 2 ? "many" : this.runs.length });
    this.legend = h("figure.legend", { "aria-live": "off" });
    this.tip = h(".tip", { hidden: true });
    return h("section.stage", { "aria-label": "Scene" }, this.panes, this.buildControls());
  }

  buildControls() {
    const { state } = this;
    const options = this.fieldNames.map((name) => {
      const field = this.runs.flatMap((run) => run.frames.fields).find((one) => one.name === name);
      return h("option", { value: name }, describe(field).label);
    });
    this.select = h("select", { id: "field", change: () => state.set({ field: this.select.value }) }, options);
    const cutButton = (label, axis) =>
      h("button", { type: "button", "aria-pressed": "false", "data-axis": axis, click: () => state.set({ cut: axis }) }, label);
    this.cutButtons = [cutButton("Off", -1), ...AXES.map((axis, k) => cutButton(axis, k))];
    this.cutRange = h("input", {
      type: "range",
      min: 0,
      max: 1000,
      value: 500,
      "aria-label": "Position of the cut",
      input: () => state.set({ cutShare: this.cutRange.valueAsNumber / 1000 }),
    });
    this.edges = h("input", { type: "checkbox", checked: true, change: () => state.set({ edges: this.edges.checked }) });
    return h(
      ".controls",
      h(".control.grow", h("label", { for: "field" }, "Colour"), this.select, this.legend),
      h(".control", h("span.name", { id: "cut-name" }, "Cut"), h(".segments", { role: "group", "aria-labelledby": "cut-name" }, this.cutButtons), this.cutRange),
      h(".control", h("label.check", this.edges, "Edges"), h("button.plain", { type: "button", click: () => this.resetCamera() }, "Reset view")),
    );
  }

  // `view`: the camera of a stage that this one takes the place of.
  async load(view) {
    const all = await Promise.all(this.runs.map(readFrames));
    this.world = worldOf(all);
    this.runs.forEach((run, k) => this.addPane(run, all[k]));
    for (const view of this.views) view.body = await view.frames.field("body");
    this.addCamera();
    if (view) this.setView(view);
    this.listen();
    await this.showField();
    this.showTheme();
    this.showCut();
    this.showTime();
    this.resize();
    new ResizeObserver(() => this.resize()).observe(this.panes);
  }

  addPane(run, frames) {
    const canvas = h("canvas", {
      tabindex: 0,
      role: "img",
      "aria-label": `${run.label} in 3-D. Arrow keys turn it, plus and minus come closer and go away.`,
    });
    const ended = h("span.ended", { hidden: true });
    const name = this.runs.length > 1 ? h("figcaption", swatchOf(run), run.label, ended) : null;
    const pane = h("figure.pane", canvas, name);
    this.panes.append(pane);
    const view = new View(run, frames, this.world, canvas);
    view.ended = ended;
    this.views.push(view);
    canvas.addEventListener("pointermove", (event) => this.hover(view, event));
    canvas.addEventListener("pointerleave", () => (this.tip.hidden = true));
    canvas.addEventListener("keydown", (event) => this.turn(event));
  }

  addCamera() {
    this.panes.append(this.tip);
    this.camera = new PerspectiveCamera(32, 1, this.world.size / 200, this.world.size * 60);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.panes);
    this.controls.addEventListener("change", () => {
      if (this.state.cut >= 0 && this.cutSide !== this.sideOf(this.state.cut)) this.showCut();
      this.request();
    });
    this.controls.addEventListener("start", () => (this.tip.hidden = true));
    this.panes.style.touchAction = "pan-y"; // one finger up or down scrolls the page
    // The wheel scrolls the page, too; with Ctrl, or a pinch, it comes closer.
    this.panes.addEventListener("wheel", (event) => event.ctrlKey || event.metaKey || event.stopImmediatePropagation(), { capture: true });
    this.resetCamera();
  }

  // Where the camera stands and what it looks at, in the scene's coordinates.
  view() {
    if (!this.camera) return undefined;
    const { origin } = this.world;
    const add = (place) => place.toArray().map((value, k) => value + origin[k]);
    return { position: add(this.camera.position), target: add(this.controls.target) };
  }

  setView({ position, target }) {
    const { origin } = this.world;
    const less = (place) => place.map((value, k) => value - origin[k]);
    this.isPlaced = true;
    this.camera.position.fromArray(less(position));
    this.controls.target.fromArray(less(target));
    this.controls.update();
  }

  destroy() {
    this.controls?.dispose();
    for (const view of this.views) view.destroy();
  }

  // From the front, a little from above, so near that all frames just fit.
  resetCamera() {
    const away = new Vector3(...(this.away ?? [0.6, -0.95, 0.42])).normalize();
    const right = new Vector3().crossVectors(this.camera.up, away).normalize();
    const up = new Vector3().crossVectors(away, right);
    const slope = Math.tan((this.camera.fov * Math.PI) / 360);
    let distance = 0;
    for (const view of this.views)
      view.visit((place) => {
        const reach = Math.max(Math.abs(place.dot(up)), Math.abs(place.dot(right)) / this.camera.aspect);
        distance = Math.max(distance, place.dot(away) + (1.12 * reach) / slope);
      });
    this.camera.position.copy(away.multiplyScalar(distance));
    this.controls.target.set(0, 0, 0);
    this.controls.update();
    this.request();
  }

  turn(event) {
    const step = event.shiftKey ? 0.04 : 0.14;
    const moves = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
    const zoom = { "+": 0.88, "=": 0.88, "-": 1 / 0.88 }[event.key];
    const move = moves[event.key];
    if ((!move && !zoom) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    const offset = this.camera.position.clone().sub(this.controls.target);
    const spherical = new Spherical().setFromCartesianCoords(offset.y, offset.z, offset.x); // z is up
    if (move) {
      spherical.theta += move[0];
      spherical.phi = Math.min(Math.max(spherical.phi + move[1], 0.02), Math.PI - 0.02);
    } else spherical.radius *= zoom;
    const turned = new Vector3().setFromSpherical(spherical);
    this.camera.position.copy(this.controls.target).add(new Vector3(turned.z, turned.x, turned.y));
    this.controls.update();
  }

  listen() {
    const { state } = this;
    state.on(["time"], () => this.showTime());
    state.on(["field"], () => this.showField());
    state.on(["cut", "cutShare"], () => this.showCut());
    state.on(["edges"], () => this.showEdges());
    state.on(["theme"], () => this.showTheme());
  }

  // A run that did not come so far stays at its last frame, and says so.
  showTime() {
    const { time } = this.state;
    for (const view of this.views) {
      const { time_s } = view.frames;
      const last = time_s[time_s.length - 1];
      view.setFrame(indexAt(time_s, time));
      view.ended.hidden = !(time > last * (1 + 1e-9));
      view.ended.textContent = `ended at ${format(last, "s")}`;
    }
    this.request();
  }

  showEdges() {
    this.edges.checked = this.state.edges;
    for (const view of this.views) view.setEdges(this.state.edges);
    this.request();
  }

  showTheme() {
    for (const view of this.views) view.setTheme(this.state.theme);
    this.showEdges();
    this.paint();
  }

  async showField() {
    const name = this.state.field;
    this.select.value = name;
    const fields = await Promise.all(this.views.map((view) => view.frames.field(name)));
    if (name !== this.state.field) return; // another was chosen meanwhile
    const known = fields.filter(Boolean);
    if (known.length === 0) return;
    this.info = describe(known[0]);
    this.scale = this.range && !this.info.isClass ? { ...this.range, isOpen: known.some((field) => field.high > this.range.high) } : scaleOf(known, this.info);
    this.fields = fields;
    this.paint();
  }

  // Colours of the field in this theme, on the views and in the legend.
  paint() {
    if (!this.fields) return;
    const { info, scale } = this;
    const { theme } = this.state;
    const classes = info.isClass ? Math.round(scale.high - scale.low) + 1 : 0;
    const ramp = rampOf(theme, info.middle === undefined ? "one" : "two");
    const colours = classes ? tintsOf(theme, classes) : Array.from({ length: STEPS }, (_, k) => ramp(k / (STEPS - 1)));
    const bytes = bytesOf(colours);
    this.views.forEach((view, k) => view.setField(this.fields[k], scale, bytes, classes, neutralOf(theme)));
    this.legend.replaceChildren(...(classes ? this.classLegend(colours) : this.rampLegend(colours)), ...this.obstacleLegend());
    this.request();
  }

  classLegend(colours) {
    const names = this.state.field === "body" ? this.runs[0].solids.meshed : (this.info.classes ?? []);
    return colours.map((colour, k) => {
      const value = Math.round(this.scale.low) + k;
      return h("span.class", h("span.swatch", { style: `background:${colour}` }), names[value] ?? String(value));
    });
  }

  rampLegend(colours) {
    const stops = colours.filter((_, k) => k % 15 === 0 || k === STEPS - 1).join(",");
    const { low, high, isOpen } = this.scale;
    const { unit } = this.info;
    return [
      h("span.end", format(low, unit)),
      h("span.ramp", { style: `background:linear-gradient(90deg,${stops})` }),
      h("span.end", { title: isOpen ? "a thousandth of the values lies above" : "" }, (isOpen ? "≥ " : "") + format(high, unit)),
    ];
  }

  obstacleLegend() {
    const names = [...new Set(this.runs.flatMap((run) => run.solids.shapes.map((shape) => shape.name)))];
    if (names.length === 0) return [];
    const label = names.length > 2 ? `${names.length} obstacles` : names.join(", ");
    return [h("span.class.obstacles", { title: names.join(", ") }, h("span.swatch", { style: `background:${PALETTE[this.state.theme].obstacle}` }), label)];
  }

  // The side of a cut on which the reader is, so that the section is always in sight.
  sideOf(axis) {
    return this.camera.position.getComponent(axis) < this.controls.target.getComponent(axis) ? -1 : 1;
  }

  showCut() {
    const { cut, cutShare } = this.state;
    for (const button of this.cutButtons) button.setAttribute("aria-pressed", String(Number(button.dataset.axis) === cut));
    this.cutRange.disabled = cut < 0;
    this.cutRange.value = Math.round(1000 * cutShare);
    this.cutRange.setAttribute("aria-valuetext", `${Math.round(100 * cutShare)} %`);
    const { low, high, origin } = this.world;
    const place = cut < 0 ? 0 : low[cut] + cutShare * (high[cut] - low[cut]) - origin[cut];
    this.cutSide = cut < 0 ? 0 : this.sideOf(cut);
    for (const view of this.views) view.setCut(cut < 0 ? null : { axis: cut, place, side: this.cutSide });
    this.request();
  }

  tell(view, hit) {
    if (hit.obstacle) return [h("b", hit.obstacle), " obstacle"];
    const names = this.state.field === "body" ? view.run.solids.meshed : (this.info?.classes ?? []);
    const value = this.info?.isClass ? (names[Math.round(hit.value)] ?? String(Math.round(hit.value))) : format(hit.value, this.info?.unit);
    return [h("b", value), ` tetrahedron ${hit.tetrahedron}`];
  }

  hover(view, event) {
    if (event.buttons || this.state.isPlaying || event.pointerType === "touch") {
      this.tip.hidden = true;
      return;
    }
    const box = view.canvas.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * 2 - 1;
    const y = 1 - ((event.clientY - box.top) / box.height) * 2;
    const hit = view.pick(x, y, this.camera);
    this.tip.hidden = !hit;
    if (!hit) return;
    this.tip.replaceChildren(...this.tell(view, hit));
    const frame = this.panes.getBoundingClientRect();
    const left = Math.min(event.clientX - frame.left + 14, frame.width - 170);
    this.tip.style.transform = `translate(${left}px, ${event.clientY - frame.top + 14}px)`;
  }

  resize() {
    const canvas = this.views[0]?.canvas;
    if (!canvas) return;
    const { width, height } = canvas.getBoundingClientRect();
    if (!width || !height) return;
    const isFirst = !this.isPlaced && this.camera.aspect === 1 && !this.isSized;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    for (const view of this.views) view.resize(width, height);
    this.isSized = true;
    if (isFirst) this.resetCamera();
    this.renderNow();
  }

  request() {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame(() => this.renderNow());
  }

  renderNow() {
    this.isDue = false;
    for (const view of this.views) view.render(this.camera);
  }
}
