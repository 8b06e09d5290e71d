# SPDX-License-Identifier: Apache-2.0
"""A field remapped between two meshes of the same domain by their overlap volumes.

    python3 remap.py

The field is known by its means over the tetrahedra i of the first mesh, f_i. Its mean over a tetrahedron j of the second is

    g_j = Σ_i V_ij (f_i + s_i · (c_ij − c_i)) / V_j

V_ij and c_ij are volume and centroid of i ∩ j, by tetlap.mesh_pairs; c_i is the centroid of i, and s_i a slope of the field in i:
0 (first order), or that of the affine function which fits the means round i best (second order).

Divided is by the tetrahedron's own volume V_j, not by Σ_i V_ij, and nothing is rescaled afterwards. So two things are not made
true but measured: the integral is kept, Σ_j V_j g_j = Σ_i V_i f_i, as far as Σ_j V_ij = V_i and Σ_j V_ij c_ij = V_i c_i;
constants are reproduced, as far as Σ_i V_ij = V_j. The error against the true means of a smooth field falls with the meshes'
size h; its order is measured.
"""

import numpy as np

import tetlap

# A rule of degree 3 on a tetrahedron: the middle and four points towards the corners (Keast 1986).
_WEIGHTS = np.array([-0.8, 0.45, 0.45, 0.45, 0.45])
_POINTS = np.vstack([np.full(4, 1 / 4), np.full((4, 4), 1 / 6) + np.eye(4) / 3])


def cube(cells, seed):
    """The unit cube as 6 cells³ tetrahedra whose inner vertices are moved at random: (points, tets)."""
    axis = np.linspace(0, 1, cells + 1)
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    is_inside = ((points > 0) & (points < 1)).all(axis=1)
    points[is_inside] += np.random.default_rng(seed).uniform(-0.15, 0.15, (is_inside.sum(), 3)) / cells
    number = np.arange((cells + 1) ** 3).reshape((cells + 1,) * 3)
    corner = np.stack(np.meshgrid(*[np.arange(cells)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    tets = []
    for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)):
        path = [corner]
        for direction in order:
            path.append(path[-1] + np.eye(3, dtype=int)[direction])
        tets.append(np.stack([number[tuple(vertex.T)] for vertex in path], axis=1))
    return points, np.concatenate(tets)


def volumes(points, tets):
    return np.abs(np.linalg.det(points[tets[:, 1:]] - points[tets[:, :1]])) / 6


def centroids(points, tets):
    return points[tets].mean(axis=1)


def field(x):
    return np.sin(2 * x[..., 0]) * np.cos(3 * x[..., 1]) + x[..., 2] ** 2


def means(points, tets):
    """Of the field over each tetrahedron, by quadrature."""
    return field(np.einsum("qv,tvc->tqc", _POINTS, points[tets])) @ _WEIGHTS


def slopes(values, points, tets):
    """For each tetrahedron that of the affine function which fits, by least squares, the means of the tetrahedra which share a
    vertex with it (once for each vertex shared), taken as values at their centroids."""
    centres = centroids(points, tets)
    rows = np.column_stack([np.ones(len(tets)), centres, values])
    products = np.einsum("ta,tb->tab", rows, rows)  # of (1, c, f) with itself
    at_vertices = np.zeros((len(points), 5, 5))
    np.add.at(at_vertices, tets, products[:, None])
    sums = at_vertices[tets].sum(axis=1)
    means = sums[:, 0, 1:] / sums[:, :1, 0]
    spread = sums[:, 1:, 1:] - sums[:, :1, :1] * np.einsum("ta,tb->tab", means, means)
    return np.linalg.solve(spread[:, :3, :3], spread[:, :3, 3:])[:, :, 0]


def remap(values, mesh_a, mesh_b, order):
    pairs = tetlap.mesh_pairs(*mesh_a, *mesh_b, centroid=True)
    integrals = pairs.volume * values[pairs.i]
    if order == 2:
        arms = pairs.centroid - centroids(*mesh_a)[pairs.i]
        integrals += pairs.volume * np.einsum("pc,pc->p", slopes(values, *mesh_a)[pairs.i], arms)
    return np.bincount(pairs.j, integrals, len(mesh_b[1])) / volumes(*mesh_b)


def measure(cells, order):
    """The errors of one remap from a mesh of `cells`³ cubes to one of (cells + 1)³."""
    a, b = cube(cells, seed=1), cube(cells + 1, seed=2)
    size_a, size_b, source = volumes(*a), volumes(*b), means(*a)
    target, ones = remap(source, a, b, order), remap(np.ones(len(size_a)), a, b, order)
    return {
        "integral": abs(size_b @ target - size_a @ source) / abs(size_a @ source),
        "constant": abs(ones - 1).max(),
        "error": np.sqrt(size_b @ (target - means(*b)) ** 2),
    }


def study(sizes, order):
    """Prints the rows of a table; returns them, and the measured orders of convergence."""
    rows, orders = [measure(cells, order) for cells in sizes], []
    print(f"{'slopes 0' if order == 1 else 'slopes fitted'}:\ncells  integral kept to  constants to  error (L2)  order measured")
    for k, (cells, row) in enumerate(zip(sizes, rows)):
        if k > 0:
            orders.append(np.log(rows[k - 1]["error"] / row["error"]) / np.log(cells / sizes[k - 1]))
        measured = f"{orders[-1]:.2f}" if k > 0 else ""
        print(f"{cells:5d}  {row['integral']:16.1e}  {row['constant']:12.1e}  {row['error']:10.3e}  {measured}")
    return rows, orders


def main(sizes=(4, 8, 16)):
    return {order: study(sizes, order) for order in (1, 2)}


if __name__ == "__main__":
    main()
