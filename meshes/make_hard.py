# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes spike.mesh, wedge.mesh, crack.mesh and hole.mesh: the sharp shapes of Erleben's degenerate cases
(ACM TOG 37, 2018), each symmetric in x and y down to its tetrahedra. Lengths in m.

    python3 meshes/make_hard.py

A shape is a list of convex cells, each a list of faces of three or four corners. A cell is cut from its
centre; faces of four from their own: so neighbours agree, and a mirrored cell gets mirrored tetrahedra.
"""
import os

HERE = os.path.dirname(os.path.abspath(__file__))


def mean(points):
    return tuple(sum(c) / len(points) for c in zip(*points))


def det(a, b, c, d):
    u, v, w = ([p[i] - a[i] for i in range(3)] for p in (b, c, d))
    return (u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0])
            + u[2] * (v[0] * w[1] - v[1] * w[0]))


def hexahedron(low, high):
    """Faces of the cell between two rings of four corners."""
    return [low, high] + [[low[i], low[(i + 1) % 4], high[(i + 1) % 4], high[i]] for i in range(4)]


def cut(cells):
    vertices, tets = {}, []

    def number(point):
        key = tuple(round(c, 12) + 0.0 for c in point)
        return vertices.setdefault(key, len(vertices))

    for faces in cells:
        faces = [list(dict.fromkeys(face)) for face in faces]
        faces = [face for face in faces if len(face) > 2]
        centre = mean(sorted({corner for face in faces for corner in face}))
        for face in faces:
            if len(face) == 3:
                triangles = [face]
            else:
                middle = mean(face)
                triangles = [[middle, face[i], face[(i + 1) % 4]] for i in range(4)]
            for a, b, c in triangles:
                if det(centre, a, b, c) < 0:
                    b, c = c, b
                tets.append([number(p) for p in (centre, a, b, c)])
    return list(vertices), tets


def write(name, comment, cells):
    points, tets = cut(cells)
    with open(os.path.join(HERE, name), "w") as file:
        file.write("MeshVersionFormatted 2\nDimension 3\n# %s; made by make_hard.py.\n" % comment)
        file.write("Vertices\n%d\n" % len(points))
        file.writelines("%.12g %.12g %.12g 0\n" % p for p in points)
        file.write("Tetrahedra\n%d\n" % len(tets))
        file.writelines("%d %d %d %d 1\n" % tuple(i + 1 for i in tet) for tet in tets)
        file.write("End\n")
    print(name, len(points), len(tets))


def ring(x, y, z):
    return [(-x, -y, z), (x, -y, z), (x, y, z), (-x, y, z)]


def spike(half=0.03, height=0.12, layers=4):
    """A pyramid, its point up."""
    def at(k):
        s = 1 - k / layers
        return ring(half * s, half * s, height * k / layers)
    return [hexahedron(at(k), at(k + 1)) for k in range(layers)]


def wedge(half=0.03, length=0.12, height=0.12, layers=4, along=2):
    """A roof, its edge up and along y."""
    def at(k, j):
        x, y, z = half * (1 - k / layers), length * (j / along - 0.5), height * k / layers
        dy = length / along
        return [(-x, y, z), (x, y, z), (x, y + dy, z), (-x, y + dy, z)]
    return [hexahedron(at(k, j), at(k + 1, j)) for k in range(layers) for j in range(along)]


def crack(half=0.1, opening=0.035, depth=0.09, height=0.15, length=0.16, along=3):
    """A block, top in z = 0, with a groove along y."""
    def extrude(section, j):
        y0, y1 = (length * (k / along - 0.5) for k in (j, j + 1))
        return hexahedron([(x, y0, z) for x, z in section], [(x, y1, z) for x, z in section])
    sections = []
    for s in (-1, 1):
        for k in range(2):
            f, g = k / 2, (k + 1) / 2
            sections.append([(s * half, -depth * f), (s * opening * (1 - f), -depth * f),
                             (s * opening * (1 - g), -depth * g), (s * half, -depth * g)])
        sections.append([(s * half, -depth), (0, -depth), (0, -height), (s * half, -height)])
    return [extrude(section, j) for section in sections for j in range(along)]


def hole(half=0.1, opening=0.035, depth=0.09, height=0.15):
    """A block, top in z = 0, with a pit like an upturned pyramid."""
    def rings(f):
        return ring(half, half, -depth * f), ring(opening * (1 - f), opening * (1 - f), -depth * f)
    cells = []
    for f, g in ((0, 0.5), (0.5, 1)):
        (outer, inner), (outer_below, inner_below) = rings(f), rings(g)
        for i in range(4):
            j = (i + 1) % 4
            cells.append(hexahedron([outer[i], outer[j], inner[j], inner[i]],
                                    [outer_below[i], outer_below[j], inner_below[j], inner_below[i]]))
    top, bottom, point = ring(half, half, -depth), ring(half, half, -height), (0.0, 0.0, -depth)
    sides = hexahedron(bottom, top)
    cells.append([f for f in sides if f is not top] + [[top[i], top[(i + 1) % 4], point] for i in range(4)])
    return cells


write("spike.mesh", "A pyramid of base 0.06 and height 0.12 on z = 0", spike())
write("wedge.mesh", "A roof of base 0.06 x 0.12 and height 0.12 on z = 0, its edge along y", wedge())
write("crack.mesh", "A block of 0.2 x 0.16 x 0.15 below z = 0, a groove of width 0.07 and depth 0.09 along y", crack())
write("hole.mesh", "A block of 0.2 x 0.2 x 0.15 below z = 0, a pit of width 0.07 and depth 0.09", hole())
