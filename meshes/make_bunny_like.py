#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes bunny_like.stl: a closed, smooth, sitting animal with two ears, 0.17 m tall, feet on z = 0 [m].

The shape is the zero set of a smooth union of spheres, ellipsoids and capsules. A dual surface (naive surface nets,
Gibson 1998) is taken on a grid, then its vertices move in turns towards the mean of their neighbours within the
surface and back onto the zero set, which evens out the triangles. Plain Python, no randomness: the same file every time.
"""
import math
import struct
import sys

CELL = 0.0078  # grid spacing [m]
BLEND = 0.018  # over which two parts flow into each other [m]
LOW, HIGH = (-0.11, -0.075, -0.02), (0.11, 0.075, 0.19)

# (a, b, radius at a, radius at b): a ball swept from a to b.
PARTS = [
    ((-0.025, 0, 0.048), (0.015, 0, 0.052), 0.046, 0.040),  # body
    ((0.045, 0, 0.1), (0.062, 0, 0.096), 0.030, 0.021),  # head and snout
    ((0.04, 0.019, 0.118), (0.018, 0.034, 0.16), 0.012, 0.0115),  # ears
    ((0.04, -0.019, 0.118), (0.018, -0.034, 0.16), 0.012, 0.0115),
    ((-0.03, 0.034, 0.015), (0.012, 0.038, 0.014), 0.0165, 0.0145),  # hind feet
    ((-0.03, -0.034, 0.015), (0.012, -0.038, 0.014), 0.0165, 0.0145),
    ((0.032, 0.018, 0.05), (0.045, 0.019, 0.013), 0.016, 0.0135),  # front legs
    ((0.032, -0.018, 0.05), (0.045, -0.019, 0.013), 0.016, 0.0135),
    ((-0.07, 0, 0.04), (-0.072, 0, 0.042), 0.015, 0.015),  # tail
]


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def add_scaled(a, s, b):
    return (a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def swept_ball(p, a, b, ra, rb):
    axis = sub(b, a)
    t = min(1.0, max(0.0, dot(sub(p, a), axis) / dot(axis, axis)))
    q = add_scaled(a, t, axis)
    return math.dist(p, q) - (ra + t * (rb - ra))


def field(p):
    """Negative inside; a smooth minimum over the parts (polynomial, Quilez)."""
    value = 1.0
    for part in PARTS:
        d = swept_ball(p, *part)
        h = max(BLEND - abs(d - value), 0.0) / BLEND
        value = min(d, value) - h * h * BLEND / 4
    return value


def gradient(p, step=1e-5):
    g = []
    for c in range(3):
        low, high = list(p), list(p)
        low[c] -= step
        high[c] += step
        g.append((field(high) - field(low)) / (2 * step))
    return tuple(g)


def onto_surface(p):
    for _ in range(4):
        g = gradient(p)
        p = add_scaled(p, -field(p) / dot(g, g), g)
    return p


def surface_net():
    """One vertex a cell that the surface passes, one quadrilateral a grid edge that it crosses, outward."""
    counts = [int(math.ceil((HIGH[c] - LOW[c]) / CELL)) + 1 for c in range(3)]
    place = lambda i: tuple(LOW[c] + CELL * i[c] for c in range(3))
    grid = {(i, j, k): field(place((i, j, k)))
            for i in range(counts[0]) for j in range(counts[1]) for k in range(counts[2])}
    vertices, number = [], {}

    def vertex(cell):
        if cell not in number:
            crossings = []
            corners = [tuple(cell[c] + (n >> c & 1) for c in range(3)) for n in range(8)]
            for m in range(8):
                for c in range(3):
                    n = m | 1 << c
                    if n == m or (grid[corners[m]] < 0) == (grid[corners[n]] < 0):
                        continue
                    t = grid[corners[m]] / (grid[corners[m]] - grid[corners[n]])
                    a, b = place(corners[m]), place(corners[n])
                    crossings.append(add_scaled(a, t, sub(b, a)))
            number[cell] = len(vertices)
            vertices.append(tuple(sum(x[c] for x in crossings) / len(crossings) for c in range(3)))
        return number[cell]

    quads = []
    for i in grid:
        for c in range(3):
            j = tuple(i[d] + (d == c) for d in range(3))
            if j not in grid or (grid[i] < 0) == (grid[j] < 0):
                continue
            a, b = (c + 1) % 3, (c + 2) % 3
            around = []
            for da, db in ((-1, -1), (0, -1), (0, 0), (-1, 0)):
                cell = list(i)
                cell[a] += da
                cell[b] += db
                around.append(vertex(tuple(cell)))
            quads.append(around if grid[i] < 0 else around[::-1])
    return vertices, quads


def split(vertices, quads):
    """Each quadrilateral along its shorter diagonal."""
    triangles = []
    for a, b, c, d in quads:
        if math.dist(vertices[a], vertices[c]) <= math.dist(vertices[b], vertices[d]):
            triangles += [(a, b, c), (a, c, d)]
        else:
            triangles += [(a, b, d), (b, c, d)]
    return triangles


def flip_for_valence(vertices, triangles):
    """Flips edges where that brings the four vertices nearer to six neighbours each."""
    across = {}
    for n, t in enumerate(triangles):
        for k in range(3):
            across[(t[k], t[(k + 1) % 3])] = n
    valence = [0] * len(vertices)
    for t in triangles:
        for v in t:
            valence[v] += 1
    flipped = 0
    for a, b in list(across):
        if (a, b) not in across or (b, a) not in across:
            continue
        m, n = across[(a, b)], across[(b, a)]
        c = next(v for v in triangles[m] if v not in (a, b))
        d = next(v for v in triangles[n] if v not in (a, b))
        if (c, d) in across or (d, c) in across:
            continue
        cost = lambda change: sum((valence[v] + s * change - 6) ** 2 for v, s in ((a, -1), (b, -1), (c, 1), (d, 1)))
        normals = [normal(vertices, t) for t in (triangles[m], triangles[n], (a, d, c), (b, c, d))]
        if cost(1) >= cost(0) or min(dot(normals[0], x) for x in normals[1:]) < 0.7:
            continue
        triangles[m], triangles[n] = (a, d, c), (b, c, d)
        del across[(a, b)], across[(b, a)]
        for number in (m, n):
            for k in range(3):
                across[(triangles[number][k], triangles[number][(k + 1) % 3])] = number
        for v, s in ((a, -1), (b, -1), (c, 1), (d, 1)):
            valence[v] += s
        flipped += 1
    return flipped


def normal(vertices, t):
    n = cross(sub(vertices[t[1]], vertices[t[0]]), sub(vertices[t[2]], vertices[t[0]]))
    length = math.sqrt(dot(n, n)) or 1.0
    return (n[0] / length, n[1] / length, n[2] / length)


def relax(vertices, triangles, rounds):
    neighbours = [set() for _ in vertices]
    for a, b, c in triangles:
        neighbours[a] |= {b, c}
        neighbours[b] |= {a, c}
        neighbours[c] |= {a, b}
    for _ in range(rounds):
        moved = []
        for v, p in enumerate(vertices):
            around = sorted(neighbours[v])
            mean = tuple(sum(vertices[w][c] for w in around) / len(around) for c in range(3))
            moved.append(onto_surface(add_scaled(p, 0.6, sub(mean, p))))
        vertices[:] = moved


def check_closed(triangles):
    """Every edge once in each direction: closed, manifold, consistently oriented."""
    edges = [(t[k], t[(k + 1) % 3]) for t in triangles for k in range(3)]
    known = set(edges)
    if len(known) != len(edges) or any((b, a) not in known for a, b in edges):
        sys.exit("the surface is not closed and manifold: change CELL or move the parts")


def stand_on_floor(vertices):
    lowest = min(p[2] for p in vertices)
    vertices[:] = [(p[0], p[1], p[2] - lowest) for p in vertices]


def write_stl(path, vertices, triangles):
    with open(path, "wb") as stream:
        stream.write(b"bunny_like, GPL-3.0-or-later, metres".ljust(80))
        stream.write(struct.pack("<I", len(triangles)))
        for t in triangles:
            stream.write(struct.pack("<12fH", *normal(vertices, t), *(x for v in t for x in vertices[v]), 0))


def main():
    vertices, quads = surface_net()
    vertices = [onto_surface(p) for p in vertices]
    triangles = split(vertices, quads)
    check_closed(triangles)
    for _ in range(4):
        flip_for_valence(vertices, triangles)
        relax(vertices, triangles, 4)
    check_closed(triangles)
    stand_on_floor(vertices)
    path = sys.argv[1] if len(sys.argv) > 1 else "bunny_like.stl"
    write_stl(path, vertices, triangles)
    print(f"{path}: {len(vertices)} vertices, {len(triangles)} triangles")


if __name__ == "__main__":
    main()
