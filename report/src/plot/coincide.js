// SPDX-License-Identifier: GPL-3.0-or-later
// Curves that lie on one another, so that the last one drawn would hide the others: they are drawn in stripes, in turn.
//
//   clip  ——      ——      ——         the curve of n = 3 that is number k has dashes of STRIPE, gaps of (n − 1) STRIPE,
//   geo     ——      ——      ——       and begins k STRIPE later

import { indexAt } from "../data/data.js";

const NEAR = 2; // how far apart two curves may be to count as one [px]
const SHARE = 0.9; // at so many of the points that both have
const STRIPE = 6; // [px]

const finite = (points) => points.filter(([, x, y]) => Number.isFinite(x) && Number.isFinite(y));

// (time, x, y) of a series in pixels.
function pointsOf(one, x, y) {
  return finite(Array.from(one.times, (time, i) => [time, x(time), y(one.values[i])]));
}

function heightAt(points, times, time) {
  const i = indexAt(times, time);
  const [before, after] = [points[i], points[Math.min(i + 1, points.length - 1)]];
  if (after[0] === before[0]) return before[2];
  return before[2] + ((time - before[0]) / (after[0] - before[0])) * (after[2] - before[2]);
}

function lieTogether(a, b) {
  const [begin, end] = [Math.max(a[0][0], b[0][0]), Math.min(a.at(-1)[0], b.at(-1)[0])];
  const shared = b.filter(([time]) => time >= begin && time <= end);
  if (shared.length < 2 || shared.length < SHARE * Math.min(a.length, b.length)) return false;
  const times = a.map(([time]) => time);
  const near = shared.filter(([time, , height]) => Math.abs(heightAt(a, times, time) - height) <= NEAR);
  return near.length >= SHARE * shared.length;
}

// Groups of series, by their numbers, that lie on the first of the group. `x`, `y`: from numbers to pixels.
export function groupsOf(series, x, y) {
  const points = series.map((one) => pointsOf(one, x, y));
  const groups = [];
  points.forEach((own, k) => {
    if (own.length < 2) return;
    const group = groups.find(([first]) => lieTogether(points[first], own));
    if (group) group.push(k);
    else groups.push([k]);
  });
  return groups.filter((group) => group.length > 1);
}

// The dashes of number `k` of a group of `count`: stroke-dasharray and stroke-dashoffset.
export const stripe = (k, count) => ({ array: `${STRIPE} ${STRIPE * (count - 1)}`, offset: -STRIPE * k });
