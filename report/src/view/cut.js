// SPDX-License-Identifier: GPL-3.0-or-later
// A plane through tetrahedra: each that it crosses gives a triangle or a quadrilateral, and each triangle of the
// surface a piece of outline.

// Edges of a tetrahedron by its two vertices.
const EDGES = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

// For each set of vertices on the positive side (bit k: vertex k), the crossed edges in order around the polygon.
const POLYGONS = Array.from({ length: 16 }, (_, mask) => {
  const inside = [0, 1, 2, 3].filter((k) => mask & (1 << k));
  const outside = [0, 1, 2, 3].filter((k) => !(mask & (1 << k)));
  const edge = (a, b) => EDGES.findIndex(([p, q]) => p === Math.min(a, b) && q === Math.max(a, b));
  if (inside.length === 1) return outside.map((b) => edge(inside[0], b));
  if (outside.length === 1) return inside.map((a) => edge(a, outside[0]));
  if (inside.length === 2) {
    const [[a, b], [c, d]] = [inside, outside];
    return [edge(a, c), edge(a, d), edge(b, d), edge(b, c)];
  }
  return [];
});

// The section of tetrahedra (count, 4) by axis · x = place. Returns corners as [vertex, vertex, share] in `ends`
// (corner, 2) and `shares`, triangles of three corners each, the tetrahedron of each triangle, and for each
// corner the weights that draw the edges of the polygons but not the diagonals of quadrilaterals.
export function sectionOf(tetrahedra, positions, axis, place, room) {
  let corners = 0;
  let triangles = 0;
  const side = new Float64Array(4);
  const count = tetrahedra.length / 4;
  for (let t = 0; t < count; t++) {
    let mask = 0;
    for (let k = 0; k < 4; k++) {
      side[k] = positions[3 * tetrahedra[4 * t + k] + axis] - place;
      if (side[k] > 0) mask |= 1 << k;
    }
    const polygon = POLYGONS[mask];
    if (polygon.length === 0) continue;
    if (triangles + 2 > room.owners.length) grow(room);
    for (let piece = 0; piece + 2 < polygon.length; piece++) {
      const isQuad = polygon.length === 4;
      const fan = [polygon[0], polygon[piece + 1], polygon[piece + 2]];
      fan.forEach((edge, k) => {
        const [a, b] = EDGES[edge];
        room.ends[2 * corners] = tetrahedra[4 * t + a];
        room.ends[2 * corners + 1] = tetrahedra[4 * t + b];
        room.shares[corners] = side[a] / (side[a] - side[b]);
        // Weight k is 0 along the side opposite corner k; the diagonal's weight is held at 1.
        const hidden = isQuad ? (piece === 0 ? 1 : 2) : -1;
        for (let w = 0; w < 3; w++) room.weights[3 * corners + w] = w === k || w === hidden ? 255 : 0;
        corners++;
      });
      room.owners[triangles++] = t;
    }
  }
  room.triangleCount = triangles;
}

export function createRoom(triangles = 1024) {
  return {
    ends: new Int32Array(6 * triangles),
    shares: new Float32Array(3 * triangles),
    weights: new Uint8Array(9 * triangles),
    owners: new Int32Array(triangles),
    triangleCount: 0,
  };
}

function grow(room) {
  const larger = createRoom(2 * room.owners.length);
  for (const key of ["ends", "shares", "weights", "owners"]) {
    larger[key].set(room[key]);
    room[key] = larger[key];
  }
}

// The outline: where the plane crosses the surface's triangles (count, 4); end points as (point, 3).
export function outlineOf(triangles, positions, axis, place) {
  const points = [];
  const count = triangles.length / 4;
  for (let t = 0; t < count; t++) {
    for (let k = 0; k < 3; k++) {
      const a = 3 * triangles[4 * t + k];
      const b = 3 * triangles[4 * t + ((k + 1) % 3)];
      const da = positions[a + axis] - place;
      const db = positions[b + axis] - place;
      if (da > 0 === db > 0) continue;
      const share = da / (da - db);
      for (let c = 0; c < 3; c++) points.push(positions[a + c] + share * (positions[b + c] - positions[a + c]));
    }
  }
  return new Float32Array(points);
}
