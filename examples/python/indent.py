# SPDX-License-Identifier: Apache-2.0
"""Labelled indentations of a soft finger, for learning to feel: where a ball presses, how deep, with what force, and the pressure map.

    python3 indent.py out/indent                    10,000 of them; the same command goes on after an interruption
    python3 indent.py out/indent --count 20 --seed 7

The finger is a pad of rubber on a bone: 20 x 20 x 8 mm, its lower face held. A rigid ball of radius 6 mm goes to a place above it and then down.

      ball  ( )                position  of the ball in the plane [m]                       (2)
     ───────┴───────           depth     of its lowest point below the face at rest [m]
    │ pad           │          force     on the pad, by the contact [N]                     (3)
    ╘═══════════════╛          pressure  the normal force of contact on each column of      (11, 11)
                                         vertices, over its share of the face [Pa]; rows are x

The pressure adds up to the normal force, to rounding. Results are arrays in the folder, `tetlap.Results`.
"""

import argparse

import numpy as np

import tetlap

CELLS, LAYERS = 10, 4  # of the mesh: along the sides, through the height
SIDE, HEIGHT, RADIUS = 0.02, 0.008, 0.006  # [m]
GAP = 1e-4  # between the ball and the face at the beginning [m]
REACH = 0.006  # positions are within ± this [m]
DEPTHS = (2e-4, 1.2e-3)  # [m]

SCENE = {
    "title": "A ball pressed into a soft finger",
    "time": {"end": 1, "static": True},
    "bodies": [{
        "name": "pad",
        "mesh": {"box": {"size": [SIDE, SIDE, HEIGHT], "cells": [CELLS, CELLS, LAYERS]}},
        "place": {"translate": [-SIDE / 2, -SIDE / 2, -HEIGHT]},
        "material": {"young": 1e5, "poisson": 0.4, "density": 1000},
        "fixed": [{"box": {"min": [-1, -1, -1], "max": [1, 1, -HEIGHT + 1e-9]}}],
    }],
    "obstacles": [{"name": "ball", "sphere": {"centre": [0, 0, RADIUS + GAP], "radius": RADIUS}, "motion": {"external": True}}],
    "contact": {},
    "output": {"frames": 1},  # a load step ends at a frame at the latest
}


def draw(count, seed):
    """What the indentations differ in; the first of a longer list are those of a shorter one."""
    numbers = np.random.default_rng(seed).random((count, 3))
    places, depths = REACH * (2 * numbers[:, :2] - 1), DEPTHS[0] + (DEPTHS[1] - DEPTHS[0]) * numbers[:, 2]
    return [{"x": x, "y": y, "depth": depth} for (x, y), depth in zip(places.tolist(), depths.tolist())]


def columns(points):
    """Of the points at rest: the vertices of each column of the mesh (11, 11, 5)."""
    order = np.lexsort(np.round(points, 9).T[::-1])  # by x, then y, then z
    return order.reshape(CELLS + 1, CELLS + 1, LAYERS + 1)


def shares():
    """Of the columns in the area of the face [m²], (11, 11)."""
    widths = np.full(CELLS + 1, SIDE / CELLS)
    widths[[0, -1]] /= 2
    return np.outer(widths, widths)


def indent(sim, p):
    pad = sim.bodies["pad"]
    vertices = columns(pad.points)
    sim.drive["ball"] = [p["x"], p["y"], 0]
    sim.advance(until=0.5)
    sim.drive["ball"] = [p["x"], p["y"], -GAP - p["depth"]]
    sim.advance(until=1)
    return {"position": [p["x"], p["y"]], "depth": p["depth"], "force": sim.contacts["pad", "ball"].force,
            "pressure": -pad.forces[vertices, 2].sum(axis=2) / shares()}


def main(directory, count=10_000, seed=1, processes=None):
    return tetlap.map(draw(count, seed), indent, directory, scene=SCENE, processes=processes, threads=1)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Labelled indentations of a soft finger")
    parser.add_argument("directory")
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int)
    print(main(**vars(parser.parse_args())))
