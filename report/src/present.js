// SPDX-License-Identifier: GPL-3.0-or-later
// The scene alone, as large as the window, for pictures and movies (`tetlap render`).

import { h } from "./dom.js";

const AXES = ["x", "y", "z"];

// Towards a place at these angles about z, from x, and above the ground.
function directionOf(azimuth, elevation) {
  const [around, up] = [azimuth, elevation].map((angle) => (angle * Math.PI) / 180);
  return [Math.cos(up) * Math.cos(around), Math.cos(up) * Math.sin(around), Math.sin(up)];
}

// {field, cut: "x", share, low, high, azimuth, elevation, theme, edges}, all may be missing; low and high are the ends of the colour scale, angles
// are in degrees. Returns how many frames there are.
export async function present(page, { field, cut, share, low, high, azimuth, elevation, theme, edges }) {
  const { state, stage, times } = page;
  if (!stage) throw new Error("this run has no frames to be drawn");
  if (field && !stage.fieldNames.includes(field)) throw new Error(`there is no field '${field}'; there are ${stage.fieldNames.join(", ")}`);
  page.caption = h("span.instant");
  stage.element.append(h("p.picture-line", h("span.picture-field", ""), stage.legend, page.caption));
  document.body.classList.add("bare");
  state.set({ field: field ?? state.field, cut: cut ? AXES.indexOf(cut) : state.cut, cutShare: share ?? state.cutShare, theme: theme ?? state.theme, edges: edges ?? state.edges });
  if (low !== undefined) stage.range = { low, high };
  if (azimuth !== undefined) stage.away = directionOf(azimuth, elevation);
  await stage.showField();
  stage.element.querySelector(".picture-field").textContent = stage.select.selectedOptions[0]?.textContent ?? "";
  stage.isSized = stage.isPlaced = false;
  stage.camera.aspect = 1; // so that the view is made for the window
  stage.resize();
  return String(times.length);
}

// Frame `index` is drawn when this is fulfilled; −1: the last.
export async function showFrame(page, index) {
  const { state, times, stage, caption } = page;
  const time = times[index < 0 ? times.length + index : index];
  if (time === undefined) throw new Error(`there is no frame ${index}; there are ${times.length}, from 0`);
  state.set({ time });
  caption.textContent = `t = ${page.transport?.readout.value ?? `${time} s`}`;
  stage.renderNow();
  for (let k = 0; k < 2; k++) await new Promise(requestAnimationFrame);
  return "drawn";
}
