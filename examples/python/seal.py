# SPDX-License-Identifier: Apache-2.0
"""The shape of a seal: how high five ridges of a lid must stand to press upon a rubber strip as prescribed over its width.

    python3 seal.py [PICTURE.svg]

The lid goes down by 1.5 mm. The middle ridge is to carry most, the outer ones least: half a wave of a cosine. Ridges share the rubber, so raising one
relieves its neighbours. ½ Σ ((force − wanted)/mean)² is made least by L-BFGS (descent.py) from a flat lid; one static run gives its
exact gradient by all heights (tetlap.gradient of a misfit).
"""

import sys
import tempfile
from pathlib import Path

import descent
import numpy as np

import tetlap

RIDGES, APART, RADIUS, THICK, DOWN = 5, 0.006, 0.002, 0.006, 0.0015  # [m]
PLACES = 0.018 + APART * (np.arange(RIDGES) - 2)  # across the strip [m]
WANTED = 36 * np.cos(np.pi * (np.arange(RIDGES) - 2) / 6)  # [N], of 2 mm of its length
OF = [f"force:ridge{k}:strip:z" for k in range(RIDGES)]
BY = [f"obstacles.ridge{k}.cylinder.centre[2]" for k in range(RIDGES)]
UNIT = 1e-3  # [m]: heights in millimetres

SCENE = {
    "time": {"end": 1, "static": True},
    "bodies": [{"name": "strip", "element": "nodal", "mesh": {"box": {"size": [0.036, 0.002, THICK], "cells": [36, 1, 6]}},
                "material": {"law": "mooney_rivlin", "young": 5e6, "poisson": 0.49, "density": 1200},
                "fixed": [{"group": "z_min"}, {"all": True, "components": ["y"]}]}],  # plane strain
    "obstacles": [{"name": f"ridge{k}", "cylinder": {"centre": [x, 0.001, 0], "axis": [0, 1, 0], "radius": RADIUS, "length": 0.01},
                   "motion": {"velocity": [0, 0, -DOWN]}} for k, x in enumerate(PLACES)],
    "contact": {"stiffness": 1e11},
    "output": {"frames": 4},
}


def settings(heights):
    """Of ridges by their heights above a flat lid's [mm]."""
    return {key: THICK + RADIUS - UNIT * height for key, height in zip(BY, heights)}


def shape(most=12):
    """The heights [mm] by steps, (steps, RIDGES), and how far forces are from those that are wanted."""
    with tempfile.TemporaryDirectory() as folder:
        goal = Path(folder, "forces.csv")
        goal.write_text("".join(f"{name}, {WANTED.mean()**-2}, {force}\n" for name, force in zip(OF, WANTED)))

        def evaluate(heights):
            found = tetlap.gradient(SCENE, f"misfit:{goal}", BY, set=settings(heights))
            return found["value"][0], -UNIT * found["derivative"][0]

        return descent.minimise(evaluate, np.zeros(RIDGES), longest=0.3, most=most)


def forces(heights):
    return tetlap.gradient(SCENE, OF, BY, set=settings(heights))["value"]


def draw(file, heights):
    """The lid as found, the strip under it, and the force of each ridge: flat (red), as found (blue) and wanted (circles)."""
    points = tetlap.run(SCENE, set=settings(heights)).frames[-1].points
    top = points[(np.arange(len(points)) % (37 * 2) < 37) & (np.arange(len(points)) >= 37 * 2 * 6)]
    parts = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 900 250" font-family="sans-serif" font-size="13">',
             '<rect width="900" height="250" fill="white"/>']
    outline = " ".join(f"{40 + 1e4 * x:.1f},{160 - 1e4 * z:.1f}" for x, _, z in top)
    parts.append(f'<polygon points="{outline} {40 + 360},160 40,160" fill="#ddd" stroke="#444"/>')
    for x, height in zip(PLACES, heights):
        z = THICK + RADIUS - UNIT * height - DOWN
        parts.append(f'<circle cx="{40 + 1e4 * x:.1f}" cy="{160 - 1e4 * z:.1f}" r="20" fill="none" stroke="#1b6ca8" stroke-width="2"/>')
    for offset, colour, values in ((-14, "#c1442e", forces(np.zeros(RIDGES))), (2, "#1b6ca8", forces(heights))):
        parts += [f'<rect x="{520 + 70 * k + offset}" y="{200 - 4 * value:.1f}" width="12" height="{4 * value:.1f}" fill="{colour}"/>'
                  for k, value in enumerate(values)]
    parts += [f'<circle cx="{520 + 70 * k + 8}" cy="{200 - 4 * value:.1f}" r="5" fill="none" stroke="#444"/>' for k, value in enumerate(WANTED)]
    parts.append('<path d="M490 200H850" stroke="#444"/><text x="490" y="225">force of each ridge [N]: flat, as found, wanted (circles)</text>')
    Path(file).write_text("\n".join(parts) + "\n</svg>\n", encoding="utf-8")


def main(file=None, most=12):
    points, values = shape(most)
    print(f"{len(values) - 1} steps, from {values[0]:.3g} to {values[-1]:.3g}")
    print("heights [mm]", np.round(points[-1], 4), "forces [N]", np.round(forces(points[-1]), 3), "wanted", np.round(WANTED, 3))
    if file:
        draw(file, points[-1])
    return points, values


if __name__ == "__main__":
    main(*sys.argv[1:2])
