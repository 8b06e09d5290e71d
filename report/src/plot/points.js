// SPDX-License-Identifier: GPL-3.0-or-later
// Labelled points on two logarithmic axes, both of which are better the smaller; with a frontier, the line of those that none beats in both.

import * as Plot from "@observablehq/plot";
import { HUES } from "../view/colour.js";
import { format, h, svg } from "../dom.js";
import { powerOf } from "./plots.js";

const MARGIN = { left: 56, right: 20, top: 16, bottom: 44 };
const FONT = 11;
const MANY = 16; // points that need the page's whole width

// The points that no other beats in both, from left to right.
export function frontOf(points) {
  const sorted = [...points].sort((a, b) => a.x - b.x || a.y - b.y);
  let best = Infinity;
  return sorted.filter((point) => point.y < best && ((best = point.y), true));
}

const WAYS = [[1, 0], [-1, 0], [0, -1], [0, 1], [1, -1], [1, 1], [-1, -1], [-1, 1]];
const overlaps = (a, b) => a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;

// A place for each label, where it meets no other label and no point: first for all that fit close to their
// points, then for the others farther and farther away.
function placeLabels(points, bounds) {
  const taken = points.map(({ px, py }) => ({ x0: px - 5, x1: px + 5, y0: py - 5, y1: py + 5 }));
  const boxAt = (point, width, [dx, dy], reach) => {
    const x = point.px + dx * (8 + 7 * (reach - 1)) - (dx < 0 ? width : dx === 0 ? width / 2 : 0);
    const y = point.py + dy * (dx === 0 ? 14 : 9) * reach;
    return { x0: x, x1: x + width, y0: y - FONT * 0.6, y1: y + FONT * 0.6, reach };
  };
  const isInside = (box) => box.x0 >= bounds.x0 && box.x1 <= bounds.x1 && box.y0 >= bounds.y0 && box.y1 <= bounds.y1;
  const isFree = (box) => isInside(box) && !taken.some((other) => overlaps(box, other));
  const widthOf = (point) => (point.name.length + (point.isZero ? 11 : 0)) * FONT * 0.58;
  const places = points.map(() => null);
  for (let reach = 1; reach <= 12; reach++)
    points.forEach((point, k) => {
      if (places[k]) return;
      places[k] = WAYS.map((way) => boxAt(point, widthOf(point), way, reach)).find(isFree) ?? null;
      if (places[k]) taken.push(places[k]);
    });
  return places.map((box, k) => box ?? boxAt(points[k], widthOf(points[k]), WAYS[0], 1));
}

// A logarithmic axis with some air at both ends, and at most six powers of ten on it.
function axisOf(values, below, above) {
  const domain = [Math.min(...values) / below, Math.max(...values) * above];
  const [low, high] = [Math.ceil(Math.log10(domain[0])), Math.floor(Math.log10(domain[1]))];
  const step = Math.max(1, Math.ceil((high - low) / 5));
  const ticks = Array.from({ length: Math.max(Math.floor((high - low) / step) + 1, 0) }, (_, k) => 10 ** (low + k * step));
  return { type: "log", domain, ticks, grid: true, tickSize: 0 };
}

// panel: title, note, xLabel, yLabel, xTick (how a tick is written), hasFrontier, families, points: name, family, x, y, xText, yText, details.
export class Points {
  constructor(panel, state) {
    Object.assign(this, { panel, state });
    this.area = h(".area");
    this.tip = h(".tip", { hidden: true, role: "status" });
    this.element = h(panel.points.length > MANY ? "figure.plot.wide" : "figure.plot", h("figcaption", h("h3", panel.title), panel.note && h("p.note", panel.note)), h(".holder", this.area, this.tip));
    state.on(["theme"], () => this.draw());
    new ResizeObserver(() => this.draw()).observe(this.area);
  }

  hue(point) {
    return HUES[this.state.theme][this.panel.families.indexOf(point.family) % HUES.light.length];
  }

  draw() {
    const width = Math.round(this.area.clientWidth);
    if (width < 50) return;
    const { panel } = this;
    const height = Math.round(Math.min(Math.max(width * 0.62, 300), panel.points.length > MANY ? 620 : 460));
    const floor = Math.min(...panel.points.filter((point) => point.y > 0).map((point) => point.y));
    const shown = panel.points.map((point) => ({ ...point, y: point.y > 0 ? point.y : floor / 100, isZero: !(point.y > 0) }));
    const front = panel.hasFrontier ? frontOf(shown) : [];
    const chart = Plot.plot({
      width,
      height,
      marginLeft: MARGIN.left,
      marginRight: MARGIN.right,
      marginTop: MARGIN.top,
      marginBottom: MARGIN.bottom,
      style: { background: "transparent", fontFamily: "inherit", fontSize: `${FONT}px`, overflow: "visible" },
      x: { ...axisOf(shown.map((point) => point.x), 1.5, 2), label: panel.xLabel, labelAnchor: "right", tickFormat: panel.xTick },
      y: { ...axisOf(shown.map((point) => point.y), 5, 5), label: panel.yLabel, tickFormat: powerOf },
      marks: [Plot.line(front, { x: "x", y: "y", curve: "step-after", stroke: "currentColor", strokeOpacity: 0.35, strokeWidth: 1.2, strokeDasharray: "2 3" })],
    });
    const [x, y] = [chart.scale("x"), chart.scale("y")];
    const points = shown.map((point) => ({ ...point, px: x.apply(point.x), py: y.apply(point.y) }));
    this.addPoints(chart, points, new Set((panel.hasFrontier ? front : shown).map((point) => point.name)));
    const boxes = placeLabels(points, { x0: MARGIN.left, x1: width - 2, y0: 4, y1: height - MARGIN.bottom });
    boxes.forEach((box, k) => {
      if (box.reach > 1) this.addLeader(chart, points[k], box);
      const label = svg("text", { class: "label", "text-anchor": "start", x: box.x0, y: (box.y0 + box.y1) / 2, dy: "0.34em", fill: this.hue(points[k]) }, points[k].name + (points[k].isZero ? " (no error)" : ""));
      chart.append(label);
    });
    this.area.replaceChildren(chart);
  }

  // From a point to a label that had to stand apart.
  addLeader(chart, point, box) {
    const x2 = Math.min(Math.max(point.px, box.x0), box.x1);
    const y2 = (box.y0 + box.y1) / 2;
    chart.insertBefore(svg("line", { class: "leader", x1: point.px, y1: point.py, x2, y2, stroke: this.hue(point) }), chart.querySelector(".point"));
  }

  addPoints(chart, points, filled) {
    for (const point of points) {
      const isFilled = filled.has(point.name);
      const mark = svg("circle", {
        class: "point",
        cx: point.px,
        cy: point.py,
        r: isFilled ? 5 : 4,
        fill: isFilled ? this.hue(point) : "var(--paper)",
        stroke: this.hue(point),
        tabindex: 0,
        role: "img",
        "aria-label": `${point.name}: ${point.xText}, error ${point.yText}`,
      });
      mark.addEventListener("pointerenter", () => this.show(point));
      mark.addEventListener("focus", () => this.show(point));
      mark.addEventListener("pointerleave", () => (this.tip.hidden = true));
      mark.addEventListener("blur", () => (this.tip.hidden = true));
      chart.append(mark);
    }
  }

  show(point) {
    const rows = point.details.map(([name, value]) => [h("dt", name), h("dd", typeof value === "number" ? format(value) : String(value))]);
    this.tip.replaceChildren(h("b", point.name), h("dl", rows));
    this.tip.hidden = false;
    const left = Math.min(Math.max(point.px + 12, 0), this.area.clientWidth - this.tip.offsetWidth);
    const top = point.py + 14 + this.tip.offsetHeight > this.area.clientHeight ? point.py - 14 - this.tip.offsetHeight : point.py + 14;
    this.tip.style.transform = `translate(${left}px, ${top}px)`;
  }
}
