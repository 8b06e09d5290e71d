# SPDX-License-Identifier: Apache-2.0
"""Four constants of a block, E, ν, friction and damping, from noisy measurements of one motion: it is pressed, dragged, and bounces.

    python3 identify_motion.py [PICTURE.svg]

A plate presses the block upon the ground, drags it until it slides, and leaves so fast that the block jumps. Measured are forces on the
plate while it presses and drags, by how much the block's side bulges, and where the block is while it jumps; the noise is 1 % of the largest of
each kind. χ² = Σ ((q − data)/noise)² is made least by L-BFGS (descent.py) in the logarithms of E, ½ − ν, μ and β, from three starts. Each
evaluation is a run and its exact gradient by all four (tetlap.gradient of a misfit). How sure each constant is follows from the derivatives of all q.
From a μ at which the block never slides nothing leads back: no force depends on it there.
"""

import sys
import tempfile
from pathlib import Path

import descent
import numpy as np

import tetlap

NAMES = ("E [Pa]", "ν", "μ", "β [s]")
TRUTH = np.array([1e5, 0.35, 0.4, 2e-3])
STARTS = {"soft": (5e4, 0.2, 0.2, 5e-3), "stiff": (2e5, 0.45, 0.3, 1e-3), "near": (8e4, 0.3, 0.5, 3e-3)}
BY = ["bodies.block.material.young", "bodies.block.material.poisson", "contact.friction", "bodies.block.material.damping"]
KINDS = ([f"force:plate:block:z@{t}" for t in (0.02, 0.03, 0.05)], [f"force:plate:block:x@{t}" for t in (0.06, 0.07, 0.08)],
         [f"probe:right:x@{t}" for t in (0.02, 0.03)], [f"displacement:block:z@{t}" for t in (0.1, 0.11, 0.12)])
OF = [name for kind in KINDS for name in kind]
NOISE, SEED = 0.01, 5

SCENE = {
    "time": {"end": 0.12, "max_step": 1e-3, "tolerance": 0.1, "velocity_tolerance": 10},  # steps of one length: no jumps where their number changes
    "effects": {"gravity": [0, 0, -9.81]},
    "bodies": [{"name": "block", "mesh": {"box": {"size": [0.1, 0.1, 0.08], "cells": [2, 2, 2]}}, "probes": [{"name": "right", "group": "x_max"}],
                "material": {"law": "neo_hookean", "young": 1e5, "poisson": 0.3, "density": 1000, "damping": 1e-3}}],
    "obstacles": [{"name": "ground", "halfspace": {"point": [0, 0, 0], "normal": [0, 0, 1]}},
                  {"name": "plate", "box": {"centre": [0.05, 0.05, 0.101], "size": [0.2, 0.2, 0.04]}, "motion": {
                      "table": [[0, 0, 0, 0], [0.03, 0, 0, -0.013], [0.035, 0, 0, -0.013], [0.08, 0.03, 0, -0.013], [0.09, 0.03, 0, 0.05]]}}],
    "contact": {"stiffness": 2e7, "friction": 0.3},
    "output": {"frames": 2},
}


def constants(x):
    return np.array([np.exp(x[0]), 0.5 - np.exp(x[1]), np.exp(x[2]), np.exp(x[3])])


def coordinates(p):
    return np.log([p[0], 0.5 - p[1], p[2], p[3]])


def by_coordinates(p):
    return np.array([p[0], p[1] - 0.5, p[2], p[3]])  # dp/dx


def measure(p):
    found = tetlap.gradient(SCENE, OF, BY, set=dict(zip(BY, p)))
    return found["value"], found["derivative"]


def fit(start, data, noise, most=40):
    """The path of the constants from a start, (steps, 4), and χ² along it."""
    with tempfile.TemporaryDirectory() as folder:
        goal = Path(folder, "data.csv")
        goal.write_text("".join(f"{name}, {2 / sigma**2}, {value}\n" for name, value, sigma in zip(OF, data, noise)))

        def evaluate(x):
            p = constants(x)
            found = tetlap.gradient(SCENE, f"misfit:{goal}", BY, set=dict(zip(BY, p)))
            return found["value"][0], found["derivative"][0] * by_coordinates(p)

        points, misfits = descent.minimise(evaluate, coordinates(start), longest=0.2, most=most, enough=1e-4)
    return np.array([constants(x) for x in points]), misfits


def draw(file, paths):
    """The four constants by steps from each start; the truth is dashed."""
    parts = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 900 250" font-family="sans-serif" font-size="13">',
             '<rect width="900" height="250" fill="white"/>']
    for k, name in enumerate(NAMES):
        left, every = 55 + 225 * k, np.concatenate([path[:, k] for path in paths.values()])
        low, high = min(every.min(), TRUTH[k]), max(every.max(), TRUTH[k])
        up = lambda y, low=low, high=high: 200 - 150 * (y - low) / (high - low)
        most = max(len(path) for path in paths.values()) - 1
        parts.append(f'<text x="{left}" y="22">{name}</text><text x="{left + 85}" y="238" text-anchor="middle">steps</text>'
                     f'<path d="M{left} 35V215H{left + 170}" fill="none" stroke="#444"/>'
                     f'<text x="{left - 6}" y="{up(TRUTH[k]) + 4:.0f}" text-anchor="end" fill="#444">{TRUTH[k]:g}</text>'
                     f'<path d="M{left} {up(TRUTH[k]):.1f}h170" stroke="#888" stroke-dasharray="4 4"/>')
        for colour, path in zip(("#1b6ca8", "#c1442e", "#3a8f4d"), paths.values()):
            line = " ".join(f"{left + 170 * i / most:.1f},{up(y):.1f}" for i, y in enumerate(path[:, k]))
            parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
    Path(file).write_text("\n".join(parts) + "\n</svg>\n", encoding="utf-8")


def main(file=None, starts=STARTS):
    exact, _ = measure(TRUTH)
    ends = np.cumsum([0, *map(len, KINDS)])
    noise = NOISE * np.concatenate([np.full(b - a, abs(exact[a:b]).max()) for a, b in zip(ends, ends[1:])])
    data = exact + noise * np.random.default_rng(SEED).standard_normal(len(exact))
    paths, found = {}, {}
    for name in starts:
        paths[name], misfits = fit(STARTS[name], data, noise)
        p = paths[name][-1]
        slope = measure(p)[1] / noise[:, None]
        found[name] = p, misfits[-1], np.sqrt(np.diag(np.linalg.inv(slope.T @ slope)))
        print(f"{name}: in {len(misfits) - 1} steps to χ² = {misfits[-1]:.2f} of {len(data)} numbers: "
              + ", ".join(f"{what} = {value:.4g} ± {sigma:.2g}" for what, value, sigma in zip(NAMES, p, found[name][2])))
    if file:
        draw(file, paths)
    return found


if __name__ == "__main__":
    main(*sys.argv[1:2])
