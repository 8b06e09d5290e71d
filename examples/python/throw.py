# SPDX-License-Identifier: Apache-2.0
"""A soft ball is thrown upon a table so that it comes to rest in the middle of a bowl behind it.

    python3 throw.py [PICTURE.svg]

Sought are its velocity and its spin about y. From one second on it should be where the bowl is deepest: ½ Σ ((x − X)² + (y − Y)²)/L² over
six times is made least by L-BFGS (descent.py). Each evaluation is a run; tetlap.gradient goes back through all contacts, with friction, on
the table and on the bowl's slopes, and gives the exact derivatives of that sum by all that is sought.
"""

import sys
import tempfile
from pathlib import Path

import descent
import numpy as np

import tetlap

SCENE = Path(__file__).with_name("throw.yaml")
BOWL, LENGTH, TIMES = (0.8, 0.0), 0.1, np.linspace(1, 1.5, 6)  # [m], [m], [s]
BY = [f"bodies.ball.velocity[{k}]" for k in range(3)] + ["bodies.ball.spin[1]"]
SCALE = np.array([1, 1, 1, 10])  # [m/s], [rad/s]: what is sought in units of order 1
START = np.array([0.6, 0.1, 0.5, 0.0])


def settings(x):
    return {"bodies.ball.velocity": list(x[:3]), "bodies.ball.spin": [0, float(SCALE[3] * x[3]), 0]}


def throw(start=START, most=15):
    """The throws of the descent, (steps, 4), and how far they end from the goal."""
    with tempfile.TemporaryDirectory() as folder:
        goal = Path(folder, "goal.csv")
        goal.write_text("".join(f"displacement:ball:{axis}@{time}, {LENGTH**-2}, {place}\n"
                                for time in TIMES for axis, place in zip("xy", BOWL)))

        def evaluate(x):
            found = tetlap.gradient(SCENE, f"misfit:{goal}", BY, set=settings(x))
            return found["value"][0], found["derivative"][0] * SCALE

        return descent.minimise(evaluate, start / SCALE, longest=0.2, most=most)


def path(x):
    with tempfile.TemporaryDirectory() as folder:
        history = tetlap.run(SCENE, Path(folder, "throw"), set=settings(x)).history
        return np.stack([history[f"centre_ball_{axis}_m"] for axis in "xyz"], axis=1)


def draw(file, paths):
    """The ball's way from the side, every fifth frame, at the first throw and at the last."""
    parts = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 900 380" font-family="sans-serif" font-size="13">',
             '<rect width="900" height="380" fill="white"/>',
             '<path d="M0 220H512L640 348L928 60V380H0Z" fill="#ddd" stroke="#444"/>']
    for colour, name, way in zip(("#c1442e", "#1b6ca8"), paths, paths.values()):
        places = np.stack([800 * way[:, 0], 220 - 800 * way[:, 2]], axis=1)
        parts += [f'<circle cx="{x:.1f}" cy="{z:.1f}" r="40" fill="none" stroke="{colour}" opacity="0.4"/>' for x, z in places[::5]]
        parts.append(f'<polyline points="{" ".join(f"{x:.1f},{z:.1f}" for x, z in places)}" fill="none" stroke="{colour}" stroke-width="2"/>')
        parts.append(f'<text x="{20 if name == "first" else 110}" y="360" fill="{colour}">{name} throw</text>')
    Path(file).write_text("\n".join(parts) + "\n</svg>\n", encoding="utf-8")


def main(file=None, most=15):
    points, values = throw(most=most)
    for x, value in zip(points * SCALE, values):
        print(f"velocity {np.round(x[:3], 3)} m/s, spin {x[3]:.2f} rad/s: {value:.4f}")
    way = path(points[-1])
    print(f"at the end at x = {way[-1, 0]:.3f}, y = {way[-1, 1]:.3f} m; in the last 0.1 s it moved {np.linalg.norm(way[-1] - way[-6]):.4f} m")
    if file:
        draw(file, {"first": path(points[0]), "last": way})
    return points, values, way


if __name__ == "__main__":
    main(*sys.argv[1:2])
