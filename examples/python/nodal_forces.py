# SPDX-License-Identifier: Apache-2.0
"""The contact forces on vertices in the frames of a run, as a sum over pairs of cells.

The potential `field` makes the force on a vertex of the moments m_z = V λ_z(x̄) of its cells' pairs, κ Σ ± m_z (s_j g_A − s_i g_B), and is
linear in them (contact/pressure/field.h): what is not V and x̄ is known once the state is. Cells are those of contact/surface/mesh.h.
"""

from itertools import combinations
from typing import NamedTuple

import numpy as np

import tetlap

SLOPE_TOLERANCE = 0.02  # of the slope on an outer face, before its tetrahedron is split


class State(NamedTuple):
    """Two bodies in a frame. `body`, `vertex`, `entry` and `share`: an entry for each vertex that one of the moments acts on."""

    pairs: np.ndarray  # that share volume (n, 2, 4, 3)
    volume: np.ndarray  # by clip (n)
    moments: np.ndarray  # by clip (n, 8)
    push: np.ndarray  # s_j g_A − s_i g_B (n, 3)
    body: np.ndarray  # 0, 1
    vertex: np.ndarray  # of the frame
    entry: np.ndarray  # of the moments, flat
    share: np.ndarray  # of the push that one of the moments gives to the vertex

    def forces(self, moments):
        """On the frame's vertices (…, 3), over κ."""
        found = np.zeros((self.vertex.max() + 1, 3))
        np.add.at(found, self.vertex, (self.share * moments.ravel()[self.entry])[:, None] * self.push[self.entry // 8])
        return found


def distances(points, triangles):
    """From the points (n, 3) to the next of the triangles (m, 3, 3)."""
    nearest = np.full(len(points), np.inf)
    for a, b, c in triangles:
        normal, from_a = np.cross(b - a, c - a), points - a
        size = normal @ normal
        v, w = np.cross(from_a, c - a) @ normal / size, np.cross(b - a, from_a) @ normal / size
        is_above = (v >= 0) & (w >= 0) & (v + w <= 1)
        nearest = np.minimum(nearest, np.where(is_above, abs(from_a @ normal) / np.sqrt(size), np.inf))
        for begin, end in ((a, b), (b, c), (c, a)):
            along = np.clip((points - begin) @ (end - begin) / ((end - begin) @ (end - begin)), 0, 1)
            nearest = np.minimum(nearest, np.linalg.norm(points - begin - along[:, None] * (end - begin), axis=1))
    return nearest


def edges(cells):
    return cells[:, 1:] - cells[:, :1]


class Body:
    """The cells of a body at rest, (n, 4) numbers of its vertices and of the virtual ones behind them, and φ at all of these."""

    def __init__(self, rest, tets):
        faces = np.stack([np.sort(np.delete(tets, f, 1), 1) for f in range(4)], 1)
        _, same, count = np.unique(faces.reshape(-1, 3), axis=0, return_inverse=True, return_counts=True)
        is_outer = (count[same.ravel()] == 1).reshape(-1, 4)
        surface = rest[faces[is_outer]]
        inner = np.setdiff1d(tets, faces[is_outer])
        depths = np.zeros(len(rest))
        depths[inner] = distances(rest[inner], surface)

        corners, six = rest[tets], np.linalg.det(edges(rest[tets]))
        areas = [np.linalg.norm(np.cross(*np.moveaxis(edges(np.delete(corners, f, 1)), 1, 0)), axis=1) for f in range(4)]
        over_heights = np.stack(areas, 1) / abs(six)[:, None]
        is_wrong = is_outer & (abs(depths[tets] * over_heights - 1) > SLOPE_TOLERANCE)
        split = ~(depths[tets].max(1) > 0) | is_wrong.any(1)

        outer, self.tets = is_outer[split], tets[split]
        virtual_depths = outer.sum(1) / np.maximum(4 * (outer * over_heights[split]).sum(1), 1e-300)
        self.shares = np.where(outer, virtual_depths[:, None] * over_heights[split], 0.25)
        bare = ~outer.any(1)
        virtual_depths[bare] = distances(rest[self.tets[bare]].mean(1), surface)

        parts = [tets[~split]]
        for f in range(4):
            parts.append(self.tets.copy())
            parts[-1][:, f] = len(rest) + np.arange(len(self.tets))
        self.count, self.cells, self.depths = len(rest), np.concatenate(parts), np.concatenate((depths, virtual_depths))
        self.rest_volumes = np.linalg.det(edges(self.place(rest)))

    def place(self, points):
        """The cells (n, 4, 3) where the vertices are there."""
        return np.concatenate((points, (points[self.tets] * self.shares[..., None]).sum(1)))[self.cells]

    def shape(self, points):
        """The cells, the slopes of φ in them, and their volumes at rest over those there."""
        cells, rises = self.place(points), self.depths[self.cells]
        slopes = np.linalg.solve(edges(cells), (rises[:, 1:] - rises[:, :1])[..., None])[..., 0]
        return cells, slopes, self.rest_volumes / np.linalg.det(edges(cells))

    def entries(self, chosen):
        """Which of the vertices each corner of these cells moves with: of the (…, 4) corners which, the vertex, its share."""
        cells = self.cells[chosen].ravel()
        virtual, own = np.flatnonzero(cells >= self.count), np.flatnonzero(cells < self.count)
        at = cells[virtual] - self.count
        return (np.concatenate((own, np.repeat(virtual, 4))), np.concatenate((cells[own], self.tets[at].ravel())),
                np.concatenate((np.ones(len(own)), self.shares[at].ravel())))


def barycentric(cells, points):
    rest = np.linalg.solve(edges(cells).transpose(0, 2, 1), (points - cells[:, 0])[..., None])[..., 0]
    return np.concatenate((1 - rest.sum(1, keepdims=True), rest), 1)


def candidates(one, two):
    """The pairs of cells (n, 4, 3) and (m, 4, 3) whose boxes overlap."""
    low, high = one.min(1), one.max(1)
    (i,), (j,) = (np.nonzero(((low_ < high_.max(0)) & (high__ > low__.min(0))).all(1))
                  for low_, high__, high_, low__ in ((low, high, two.max(1), two.min(1)), (two.min(1), two.max(1), high, low)))
    meet = ((low[i, None] < two[j].max(1)) & (high[i, None] > two[j].min(1))).all(2)
    first, second = meet.nonzero()
    return i[first], j[second]


def states(run):
    """Of each frame of a run each two bodies that overlap."""
    bodies = None
    for frame in run.frames:
        if bodies is None:
            rest = frame.points - frame["displacement"]
            ranges = [np.unique(frame.cells[frame["body"] == b]) for b in np.unique(frame["body"])]
            bodies = [Body(rest[own], np.searchsorted(own, frame.cells[frame["body"] == b])) for b, own in enumerate(ranges)]
        for a, b in combinations(range(len(bodies)), 2):
            two = [(bodies[c], ranges[c], *bodies[c].shape(frame.points[ranges[c]])) for c in (a, b)]
            state = state_of(two)
            if state is not None:
                yield frame, state


def state_of(two):
    (_, _, one_cells, one_slopes, one_ratios), (_, _, cells, slopes, ratios) = two
    i, j = candidates(one_cells, cells)
    if len(i) == 0:
        return None
    pairs = np.stack((one_cells[i], cells[j]), 1)
    found = tetlap.overlap(pairs, "clip", 0, centroid=True, threads=1)
    is_shared = found.volume > 0
    if not is_shared.any():
        return None
    i, j, pairs, volume, centroid = i[is_shared], j[is_shared], pairs[is_shared], found.volume[is_shared], found.centroid[is_shared]
    moments = volume[:, None] * np.concatenate((barycentric(pairs[:, 0], centroid), barycentric(pairs[:, 1], centroid)), 1)
    push = ratios[j, None] * one_slopes[i] - one_ratios[i, None] * slopes[j]
    parts = []
    for side, chosen in enumerate((i, j)):
        body, own = two[side][:2]
        corner, vertex, share = body.entries(chosen)
        parts.append((np.full(len(corner), side), own[vertex], corner // 4 * 8 + 4 * side + corner % 4, (1 - 2 * side) * share))
    return State(pairs, volume, moments, push, *map(np.concatenate, zip(*parts)))
