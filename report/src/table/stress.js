// SPDX-License-Identifier: GPL-3.0-or-later
// The table of hard cases (`tetlap stress --json`): case × model, a mark for each verdict, and what was
// measured beside the mark that is pointed at.

import { format, h, svg } from "../dom.js";

const VERDICTS = {
  held: "held",
  better: "held, though a limit is known",
  tolerance: "within the model's measured tolerance",
  limit: "known limit",
  absent: "could not be asked",
  failed: "failed",
};

const GROUPS = {
  pairs: ["Pairs of tetrahedra", "100 random members a class; volumes, gradients and invariances against exact arithmetic."],
  scenes: ["Scenes", "Whole runs; each asserts that its case did occur, and what physics must keep."],
};

// A shape besides the colour: full, full with a rim, half, ring, dash, cross.
function markOf(outcome) {
  const shapes = {
    held: [svg("circle", { cx: 7, cy: 7, r: 5 })],
    better: [svg("circle", { cx: 7, cy: 7, r: 3 }), svg("circle", { cx: 7, cy: 7, r: 5.2, class: "stroke" })],
    tolerance: [svg("path", { d: "M7 2a5 5 0 0 1 0 10z" }), svg("circle", { cx: 7, cy: 7, r: 4.6, class: "stroke" })],
    limit: [svg("circle", { cx: 7, cy: 7, r: 4.6, class: "stroke" })],
    absent: [svg("path", { d: "M4 7h6", class: "stroke" })],
    failed: [svg("path", { d: "M3 3l8 8M11 3l-8 8", class: "stroke" })],
  };
  return svg("svg", { viewBox: "0 0 14 14", width: 14, height: 14, class: `verdict ${outcome}`, "aria-hidden": "true" }, ...(shapes[outcome] ?? shapes.absent));
}

// Of several files: what comes later replaces the same case with the same model.
export function mergeRows(files) {
  const rows = new Map();
  for (const row of files.flatMap(({ table }) => table?.rows ?? [])) rows.set(`${row.group}\n${row.case}\n${row.model}`, row);
  return [...rows.values()];
}

const isCase = (row, name, model) => row.case === name && row.model === model;
const unique = (list) => [...new Set(list)];

let shown = null; // the table whose tip is in sight

class Grid {
  constructor(group, rows) {
    Object.assign(this, { group, rows });
    this.models = unique(rows.map((row) => row.model));
    this.cases = unique(rows.map((row) => row.case));
    this.tip = h(".tip", { hidden: true, role: "status" });
    this.table = h("table.verdicts", h("thead", h("tr", h("th", { scope: "col" }, "Case"), this.models.map((model) => h("th.model", { scope: "col" }, h("span", model))))), h("tbody", this.cases.map((name) => this.line(name))));
    const [title, note] = GROUPS[group] ?? [group, ""];
    this.holder = h(".holder", h(".scroll", this.table), this.tip);
    this.element = h("figure.plot", h("figcaption", h("h3", title), h("p.note", note)), this.holder);
    this.holder.addEventListener("pointerleave", () => this.hide());
    this.holder.addEventListener("keydown", (event) => this.move(event));
    this.table.querySelector("button")?.setAttribute("tabindex", 0); // from there on, by arrows
  }

  line(name) {
    const cells = this.models.map((model) => {
      const row = this.rows.find((one) => isCase(one, name, model));
      return h("td", row && this.cell(row));
    });
    const isHeld = this.rows.every((row) => row.case !== name || row.outcome === "held");
    return h("tr", { "data-held": isHeld }, h("th", { scope: "row" }, name), cells);
  }

  cell(row) {
    const show = () => this.show(row, button);
    const button = h("button.cell", { type: "button", tabindex: -1, "aria-label": `${row.case}, ${row.model}: ${VERDICTS[row.outcome] ?? row.outcome}`, pointerenter: show, focus: show, click: show, blur: () => this.hide() }, markOf(row.outcome));
    return button;
  }

  show(row, button) {
    shown?.hide();
    shown = this;
    const measured = (row.measures ?? []).map((one) => {
      const bound = one.least != null ? `≥\u2009${format(one.least, "", 2)}` : `≤\u2009${format(one.most, "", 2)}`;
      return [h(one.met ? "dt" : "dt.unmet", one.name), h("dd", format(one.value, "", 2), h("span.bound", bound))];
    });
    const cost = [row.cpu_s >= 0.005 && `${format(row.cpu_s, "s", 2)} of processor time`, row.steps > 0 && `${row.steps} steps`].filter(Boolean).join(", ");
    this.tip.replaceChildren(
      h("b", row.case, " · ", row.model),
      h("p", markOf(row.outcome), VERDICTS[row.outcome] ?? row.outcome),
      row.remark ? h("p.reason", row.remark) : "",
      row.counter ? h("p", "Seen by: ", row.counter) : "",
      h("dl", measured),
      cost ? h("p", cost) : "",
    );
    this.tip.hidden = false;
    const [box, around] = [button.getBoundingClientRect(), this.holder.getBoundingClientRect()];
    const left = Math.min(Math.max(box.right - around.left + 8, 0), around.width - this.tip.offsetWidth);
    const isLow = box.bottom + this.tip.offsetHeight + 12 > window.innerHeight && box.top - around.top > this.tip.offsetHeight;
    const top = isLow ? box.top - around.top - this.tip.offsetHeight - 6 : box.bottom - around.top + 6;
    this.tip.style.transform = `translate(${Math.max(left, 0)}px, ${top}px)`;
  }

  hide() {
    this.tip.hidden = true;
  }

  // Arrows go from mark to mark, over gaps and hidden lines; the way there is one stop of the tab key.
  move(event) {
    const by = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] }[event.key];
    if (event.key === "Escape") this.hide();
    const from = event.target.closest?.("button.cell");
    if (!by || !from) return;
    event.preventDefault();
    const lines = [...this.table.tBodies[0].rows];
    let [y, x] = [lines.indexOf(from.closest("tr")), from.parentElement.cellIndex];
    for (let to = null; !to; ) {
      [y, x] = [y + by[0], x + by[1]];
      if (!lines[y] || x < 1 || x > this.models.length) return;
      to = lines[y].offsetParent ? lines[y].cells[x].querySelector("button") : null;
      if (!to) continue;
      from.setAttribute("tabindex", -1);
      to.setAttribute("tabindex", 0);
      to.focus();
    }
  }
}

export function buildStress(files) {
  const rows = mergeRows(files);
  if (rows.length === 0) return null;
  const counts = Object.keys(VERDICTS).map((outcome) => [outcome, rows.filter((row) => row.outcome === outcome).length]);
  const grids = unique(rows.map((row) => row.group)).map((group) => new Grid(group, rows.filter((row) => row.group === group)));
  const columns = h(".columns", grids.map((grid) => grid.element));
  const only = h("label.check", h("input", { type: "checkbox", change: (event) => columns.classList.toggle("only-unheld", event.target.checked) }), "Only cases that some model did not hold");
  return h(
    "section.block",
    { id: "stress" },
    h("h2", "Hard cases"),
    h("p.lead", "Every hard case with every overlap model, held against physics. Point at a mark, or tap it, for what was measured and why a limit is one."),
    h("p.key-line", counts.filter(([, count]) => count > 0).map(([outcome, count]) => h("span", markOf(outcome), `${count} ${VERDICTS[outcome]}`)), only),
    columns,
  );
}
