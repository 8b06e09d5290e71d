// SPDX-License-Identifier: GPL-3.0-or-later
// Elements, and numbers for people.

// h("p.note", {title: "…"}, "text", child): an element with classes, attributes, listeners and children.
export function h(spec, ...rest) {
  const [tag, ...classes] = spec.split(".");
  const element = document.createElement(tag || "div");
  if (classes.length) element.className = classes.join(" ");
  const attributes = rest[0] && rest[0].constructor === Object ? rest.shift() : {};
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(key, value);
    else if (value === true) element.setAttribute(key, "");
    else if (value !== false && value != null) element.setAttribute(key, value);
  }
  element.append(...rest.flat(Infinity).filter((child) => child != null && child !== false));
  return element;
}

export function svg(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

// A table that scrolls sideways where it is too wide, by keyboard too; `label` names it.
export const scrolled = (label, ...children) => h(".scroll", { tabindex: 0, role: "region", "aria-label": label }, h("table", { "aria-label": label }, ...children));

// The mark of a run, in its colour (style.css has the first two; main.js sets them all).
export const swatchOf = (run) => h("span.swatch.run", { style: `background:var(--run-${run.letter})` });

// The same of what has no run: of one of the hues.
export const swatchOfHue = (hue) => h("span.swatch.run", { style: `background:var(--hue-${hue})` });

// A name in a table; a long one is set in several lines.
const LONG = 26;
export const nameCell = (name) => (name.length > LONG ? h("span.long", name) : name);

const PREFIXES = [
  [1e9, "G"],
  [1e6, "M"],
  [1e3, "k"],
  [1, ""],
  [1e-3, "m"],
  [1e-6, "µ"],
  [1e-9, "n"],
];

const RAISED = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

export const raise = (power) => [...String(power)].map((letter) => RAISED[letter]).join("");

const digits = (value, figures) => String(Number(value.toPrecision(figures))).replace("-", "−");

function scientific(value, figures) {
  const [mantissa, power] = value.toExponential(figures - 1).split("e");
  return `${mantissa.replace("-", "−")}\u2009×\u200910${raise(Number(power))}`;
}

// "12.3 kPa", "0.078", "3.00 × 10⁻⁴": three figures, SI prefixes where there is a unit that takes them.
export function format(value, unit = "", figures = 3) {
  if (value == null || !Number.isFinite(value)) return "–";
  if (value === 0) return unit ? `0 ${unit}` : "0";
  const size = Math.abs(value);
  if (unit && /^(Pa|N|J|m|s|m\/s|B)$/.test(unit)) {
    const [scale, prefix] = PREFIXES.find(([least]) => size >= least * 0.9995) ?? [1, ""];
    if (size >= 0.9995e-9) return `${digits(value / scale, figures)}\u2009${prefix}${unit}`;
  }
  const text = size < 1e-3 || size >= 1e6 ? scientific(value, figures) : digits(value, figures);
  return unit ? `${text}\u2009${unit}` : text;
}

export const count = (value) => (value == null ? "–" : Math.round(value).toLocaleString("en-US"));
