// SPDX-License-Identifier: GPL-3.0-or-later
// Obstacles without a mesh: surfaces in parts, of what stands (one row of positions, for all frames) and of
// what moves. Half-spaces, which have no end, are drawn as grids; the others are called solids here.

import { decode } from "./codes.js";

const rowsOf = (part) => part.positions.length / (3 * part.vertices);

// A coordinate of a vertex in a frame.
function placeOf(part, frame, vertex, axis) {
  const row = Math.min(frame, rowsOf(part) - 1);
  return decode(part.low[axis], part.high[axis], part.positions[3 * (part.vertices * row + vertex) + axis]);
}

// For each triangle of a part, whether its edge opposite to corner 0, 1, 2 lies between two faces.
function seamsOf({ triangles, vertices }) {
  const faces = new Map();
  const keyOf = (t, k) => {
    const [a, b] = [triangles[t + ((k + 1) % 3)], triangles[t + ((k + 2) % 3)]];
    return Math.min(a, b) * vertices + Math.max(a, b);
  };
  const seams = [];
  for (let t = 0; t < triangles.length; t += 5)
    for (let k = 0; k < 3; k++) {
      const key = keyOf(t, k);
      if (!faces.has(key)) faces.set(key, triangles[t + 4]);
      else if (faces.get(key) !== triangles[t + 4]) faces.set(key, -1);
    }
  for (let t = 0; t < triangles.length; t += 5) seams.push([0, 1, 2].map((k) => faces.get(keyOf(t, k)) === -1));
  return seams;
}

export class Obstacles {
  // `parts` as read from the page, `solids` as of solidsOf (data.js).
  constructor(parts, solids) {
    this.parts = parts;
    this.shapes = solids.shapes;
    this.first = solids.meshed.length; // number of the first shape among all
    this.triangles = parts.flatMap((part) => this.listTriangles(part));
  }

  // Of solids: {part, corners, shape, seams}.
  listTriangles(part) {
    const seams = seamsOf(part);
    const list = [];
    for (let t = 0; t < part.triangles.length; t += 5) {
      const shape = this.shapes[part.triangles[t + 3] - this.first];
      if (!shape?.halfspace) list.push({ part, corners: part.triangles.subarray(t, t + 3), shape, seams: seams[t / 5] });
    }
    return list;
  }

  // Distances from the edges for the shader, (corner, edge): an edge that is no seam is far from everywhere.
  weights() {
    return Uint8Array.from(this.triangles.flatMap(({ seams }) => [0, 1, 2].flatMap((corner) => seams.map((isSeam, k) => (isSeam && corner !== k ? 0 : 255)))));
  }

  // The solids' corners in a frame from an origin, (triangle, 3, 3).
  fill(target, frame, origin) {
    let i = 0;
    for (const { part, corners } of this.triangles)
      for (const vertex of corners)
        for (let axis = 0; axis < 3; axis++) target[i++] = placeOf(part, frame, vertex, axis) - origin[axis];
  }

  // Calls with the places of the solids' vertices in every `stride`th of `count` frames.
  visit(count, stride, call) {
    for (const part of this.parts) {
      const vertices = new Set(this.triangles.flatMap((triangle) => (triangle.part === part ? [...triangle.corners] : [])));
      for (let frame = 0; frame < Math.min(count, rowsOf(part)); frame += stride)
        for (const vertex of vertices) call([0, 1, 2].map((axis) => placeOf(part, frame, vertex, axis)));
    }
  }

  // A point of a half-space's surface in a frame; null: the frames do not have it.
  pointOf(shape, frame) {
    const body = this.first + this.shapes.indexOf(shape);
    for (const part of this.parts)
      for (let t = 0; t < part.triangles.length; t += 5)
        if (part.triangles[t + 3] === body) return [0, 1, 2].map((axis) => placeOf(part, frame, part.triangles[t], axis));
    return null;
  }
}
