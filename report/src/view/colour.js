// SPDX-License-Identifier: GPL-3.0-or-later
// How fields are called, and in which colours they are shown. The ramps run from the bodies' own neutral tint,
// where nothing happens, to the strongest contrast with the background; lightness goes one way only.

import { rgb } from "d3-color";
import { interpolateRgbBasis } from "d3-interpolate";

const RAMPS = {
  light: {
    one: ["#e4e2dc", "#f3d9a0", "#f2b05f", "#e5763f", "#bf3b4a", "#7d1d5c", "#3d0f4e"],
    two: ["#1d4e89", "#5d8fc4", "#b5cde4", "#e8e6e1", "#efc3a4", "#d77f57", "#9e3324"],
    none: "#cfcdc8",
  },
  dark: {
    one: ["#4d535c", "#6d4478", "#a03a72", "#d0525d", "#f0814d", "#f9b968", "#fff0c0"],
    two: ["#9cc8f5", "#4f8fd0", "#3f6696", "#4d535c", "#8f5a46", "#d07a4e", "#ffc79a"],
    none: "#4a4e56",
  },
};

// Far apart for all common kinds of colour vision (after Okabe and Ito, 2008).
export const HUES = {
  light: ["#2f6fc4", "#d2691e", "#2a8f78", "#8a56b8", "#b8487a", "#8a7a1f", "#5b6770"],
  dark: ["#6ea8f0", "#f0924c", "#4fc4a6", "#b78be0", "#e884ab", "#c9b84e", "#9aa6b0"],
};

const TINTS = {
  light: ["#9db8d6", "#e0b48e", "#a3c9ba", "#c5b0da", "#dba9bd", "#cfc48d", "#b4bcc2"],
  dark: ["#4f6f96", "#946441", "#417a6a", "#6f568a", "#8a5069", "#7d7336", "#5c666e"],
};

const FIELDS = {
  von_mises: { label: "Stress, von Mises", unit: "Pa" },
  pressure: { label: "Pressure (−tr σ / 3)", unit: "Pa", middle: 0 },
  contact_force: { label: "Contact force", unit: "N" },
  contact_pressure: { label: "Contact pressure", unit: "Pa" },
  contact_traction: { label: "Contact traction", unit: "Pa" },
  contact_depth: { label: "Contact depth", unit: "m" },
  contact_gap: { label: "Contact gap", unit: "m" },
  contact_status: { label: "Contact status", isClass: true, classes: ["open", "sticks", "slides"] },
  friction_force: { label: "Friction force", unit: "N" },
  slip: { label: "Slip", unit: "m" },
  slip_way: { label: "Accumulated slip", unit: "m" },
  friction_work: { label: "Friction work", unit: "J" },
  reaction: { label: "Reaction", unit: "N" },
  trouble: { label: "Trouble", isClass: true, classes: ["none", "inverted", "enclosed", "inverted and enclosed"] },
  wrong_way: { label: "Contact pulls outwards", isClass: true, classes: ["no", "yes"] },
  overlap_fraction: { label: "Overlap fraction", unit: "" },
  det_F: { label: "Volume ratio det F", unit: "", middle: 1 },
  velocity: { label: "Speed", unit: "m/s" },
  displacement: { label: "Displacement", unit: "m" },
  status_predicted: { label: "Status by the overlap model", isClass: true, classes: ["apart", "overlaps"] },
  status_exact: { label: "Status by the reference", isClass: true, classes: ["apart", "overlaps"] },
  status_error: { label: "Errors of the status", isClass: true, classes: ["right", "false positive", "false negative"] },
  status_wrong_pairs: { label: "Pairs misclassified", isClass: false },
  body: { label: "Body", unit: "", isClass: true },
};

const ORDER = ["von_mises", "contact_force", "contact_pressure", "contact_traction", "contact_depth", "contact_gap", "contact_status", "overlap_fraction", "status_predicted", "status_exact", "status_error", "status_wrong_pairs", "det_F", "pressure", "velocity", "displacement", "body"];

export function describe(field) {
  const known = FIELDS[field.name];
  const label = field.name.replaceAll("_", " ").replace(/^./, (letter) => letter.toUpperCase());
  const isClass = known?.isClass ?? (field.is_integer && field.high - field.low < 12);
  return { label, unit: "", ...known, isClass };
}

// Fields of all runs by name, the best known first.
export function listFields(runs) {
  const names = new Set(runs.flatMap((run) => (run.frames?.fields ?? []).map((field) => field.name)));
  const rank = (name) => (ORDER.includes(name) ? ORDER.indexOf(name) : ORDER.length - 2.5);
  return [...names].sort((a, b) => rank(a) - rank(b));
}

export function rampOf(theme, kind) {
  return interpolateRgbBasis(RAMPS[theme][kind]);
}

export function tintsOf(theme, count) {
  return Array.from({ length: count }, (_, k) => TINTS[theme][k % TINTS[theme].length]);
}

export const neutralOf = (theme) => RAMPS[theme].none;

// `count` colours as bytes (count, 4).
export function bytesOf(colours) {
  const bytes = new Uint8Array(4 * colours.length);
  colours.forEach((colour, k) => {
    const { r, g, b } = rgb(colour);
    bytes.set([r, g, b, 255], 4 * k);
  });
  return bytes;
}
