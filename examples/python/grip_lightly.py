# SPDX-License-Identifier: Apache-2.0
"""A gripper's closing path that lifts with little force.

    python3 grip_lightly.py [PICTURE.svg]

Two fingers close upon a soft cube and lift it by 20 mm in 0.2 s. Sought is how far they are closed at six times. Their mean force is to be small, and
at three times the cube may not be below the fingers: squeeze/weight + Σ ((z − lift)/SLACK)² is lowered by six steps of L-BFGS (descent.py). How
much the cube slips by is smooth in the force, so the exact gradient by the rows of the motion's table (tetlap.gradient) says where to
press harder: while the cube is accelerated. A rigid cube that may not slip needs m (g + a)/(2 μ).
"""

import sys
import tempfile
from pathlib import Path

import descent
import numpy as np

import tetlap

SIDE, HEAVY, RUBS, GRAVITY = 0.04, 0.04**3 * 500, 0.5, 9.81  # of the cube [m], its mass [kg], μ, [m/s²]
TIMES = np.linspace(0, 0.3, 31)  # of the table's rows [s]
KNOTS = np.array([0.08, 0.12, 0.16, 0.2, 0.25, 0.3])  # where the closing is sought; at 0 the fingers touch
BEGIN, LIFT = 0.1, 0.02  # [s], [m]
SLACK, UNIT = 5e-4, 1e-3  # [m]
GAVE_UP = 70  # the solver's exit code: a cube that is let fall has no equilibrium within a step
BETWEEN = np.stack([np.interp(TIMES, [0, *KNOTS], [0, *one]) for one in np.eye(len(KNOTS))], axis=1)  # (rows, knots)
LOOKS = (0.2, 0.25, 0.3)


def lifted(t):
    """Height of the fingers, at rest where it begins and ends."""
    share = np.clip((t - BEGIN) / (TIMES[-1] - BEGIN), 0, 1)
    return LIFT * share**2 * (3 - 2 * share)


SCENE = {
    "time": {"end": 0.3, "max_step": 2e-3, "tolerance": 0.1, "velocity_tolerance": 10},  # steps of one length
    "effects": {"gravity": [0, 0, -GRAVITY], "damping": 5e-3},
    "bodies": [{"name": "cube", "mesh": {"box": {"size": [SIDE] * 3, "cells": [2, 2, 2]}}, "place": {"translate": [-SIDE / 2, -SIDE / 2, 0]},
                "material": {"young": 2e4, "poisson": 0.3, "density": 500}}],
    "obstacles": [{"name": "ground", "halfspace": {"point": [0, 0, 0], "normal": [0, 0, 1]}}]
    + [{"name": name, "box": {"centre": [side * (SIDE / 2 + 0.005), 0, SIDE / 2], "size": [0.01, 0.06, 0.03]}, "motion": {"table": []}}
       for name, side in (("left", -1), ("right", 1))],
    "contact": {"stiffness": 1e7, "friction": RUBS},
    "output": {"frames": 2, "vtu": False},
}
FORCES = [f"force:right:cube:x@{t:g}" for t in TIMES[8::2]]
HEIGHTS = [f"displacement:cube:z@{t}" for t in LOOKS]
BY = [f"obstacles.{name}.motion.table[{row}][1]" for name in ("left", "right") for row in range(len(TIMES))]


def settings(closed):
    """By how far each finger is closed at the knots [mm]."""
    ways = UNIT * BETWEEN @ closed
    return {f"obstacles.{name}.motion.table": np.stack([TIMES, sign * ways, 0 * TIMES, lifted(TIMES)], axis=1).tolist()
            for name, sign in (("left", 1), ("right", -1))}


def look(closed):
    """Forces of the right finger while it lifts, and how far the cube is above its lift at last."""
    with tempfile.TemporaryDirectory() as folder:
        history = tetlap.run(SCENE, Path(folder, "grip"), set={**settings(closed), "output.frames": len(TIMES) - 1}).history
        return -history["force_cube_right_x_N"][8::2], history["centre_cube_z_m"][-1] - SIDE / 2 - LIFT


def grip(start, most=6):
    """The closings at the knots [mm] by steps, and what was made least."""
    with tempfile.TemporaryDirectory() as folder:
        goals = Path(folder, "force.csv"), Path(folder, "height.csv")
        goals[0].write_text("".join(f"{name}, {1 / (len(FORCES) * HEAVY * GRAVITY)}\n" for name in FORCES))
        goals[1].write_text("".join(f"{name}, {2 / SLACK**2}, {lifted(t)}\n" for name, t in zip(HEIGHTS, LOOKS)))

        def evaluate(closed):
            try:
                found = tetlap.gradient(SCENE, [f"sum:{goals[0]}", f"misfit:{goals[1]}"], BY, set=settings(closed))
            except tetlap.RunError as error:
                if error.code != GAVE_UP:
                    raise
                return np.inf, np.zeros(len(closed))
            left, right = found["derivative"].sum(0).reshape(2, len(TIMES))
            return found["value"].sum(), UNIT * (left - right) @ BETWEEN

        return descent.minimise(evaluate, start, longest=0.1, most=most, enough=3e-3)


def needed(t):
    """Force of each finger by which a rigid cube does not slip: μ times both carries m (g + a)."""
    rate = 1 / (TIMES[-1] - BEGIN)
    share = (t - BEGIN) * rate
    return HEAVY * (GRAVITY + np.where(share < 0, 0, LIFT * rate**2 * (6 - 12 * share))) / (2 * RUBS)


def draw(file, lines):
    """The force of a finger while it lifts: at the first closing, the last, and what a rigid cube needs (dashed)."""
    parts = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 620 300" font-family="sans-serif" font-size="13">',
             '<rect width="620" height="300" fill="white"/>', '<path d="M60 30V250H580" fill="none" stroke="#444"/>',
             '<text x="60" y="20">force of a finger [N]</text><text x="580" y="285" text-anchor="end">time [s]</text>']
    most = 1.1 * max(line.max() for line in lines.values())
    parts += [f'<text x="{60 + 1700 * t:.0f}" y="268" text-anchor="middle">{t:g}</text>' for t in (0.1, 0.2, 0.3)]
    parts += [f'<text x="54" y="{254 - 220 * f / most:.0f}" text-anchor="end">{f:g}</text>' for f in np.arange(0, most, 0.5)]
    for k, (name, line) in enumerate(lines.items()):
        colour, dash = (("#c1442e", ""), ("#1b6ca8", ""), ("#444", ' stroke-dasharray="5 4"'))[k]
        points = " ".join(f"{60 + 1700 * t:.1f},{250 - 220 * f / most:.1f}" for t, f in zip(TIMES[8::2], line))
        parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"{dash}/>'
                     f'<text x="{230 + 110 * k}" y="20" fill="{colour}">{name}</text>')
    Path(file).write_text("\n".join(parts) + "\n</svg>\n", encoding="utf-8")


def main(file=None, start=(0.6,) * 6, most=6):
    points, values = grip(np.array(start), most)
    for closed, value in zip(points, values):
        print(f"{value:.4f}: closed by {np.round(closed, 3)} mm")
    forces, above = zip(*(look(closed) for closed in points[[0, -1]]))
    for name, force, height in zip(("first", "last"), forces, above):
        print(f"{name}: mean force {force.mean():.3f} N; it ends {-1e3 * height:.3f} mm below the fingers' lift")
    print(f"a rigid cube needs {needed(TIMES[8::2]).mean():.3f} N in the mean")
    if file:
        draw(file, {"first": forces[0], "last": forces[1], "needed if rigid": needed(TIMES[8::2])})
    return points, values, forces, above


if __name__ == "__main__":
    main(*sys.argv[1:2])
