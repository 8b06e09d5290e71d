# SPDX-License-Identifier: Apache-2.0
"""Young's modulus and Poisson's ratio of a block from noisy measurements of a test: a ball is pressed into it.

    python3 identify.py [PICTURE.svg]

Measured are, at three depths, the force on the ball (noise 1 % of the largest) and by how much the block's side bulges
(noise 1 % of the largest bulge). The misfit χ² = Σ ((q − data)/noise)² is made least by Levenberg's and Marquardt's method in
ln E and ln(½ − ν), from three starts. Each evaluation is a run a depth, which gives the quantities and their exact derivatives
by E and ν (tetlap.gradient); nothing is differenced. All starts end at the same place, as far from the truth as the noise allows.
"""

import sys

import numpy as np

import tetlap

TRUTH = np.array([2e5, 0.42])  # E [Pa], ν
STARTS = {"soft": (3e4, 0.2), "stiff": (2e6, 0.45), "near": (1e5, 0.3)}
DEPTHS = (0.004, 0.008, 0.012)  # [m]
OF = ["force:ball:block:z", "probe:side:x"]
BY = ["bodies.block.material.young", "bodies.block.material.poisson"]
NOISE, SEED, MOST_STEPS = 0.01, 5, 40

SCENE = {
    "time": {"end": 1, "static": True},
    "output": {"frames": 2},
    "bodies": [{"name": "block", "element": "nodal", "mesh": {"box": {"size": [0.1, 0.1, 0.06], "cells": [5, 5, 3]}},
                "material": {"law": "neo_hookean", "young": 1e5, "poisson": 0.3, "density": 1000},
                "fixed": [{"group": "z_min"}], "probes": [{"name": "side", "group": "x_max"}]}],
    "obstacles": [{"name": "ball", "sphere": {"centre": [0.05, 0.05, 0.1], "radius": 0.04}, "motion": {"velocity": [0, 0, -0.01]}}],
    "contact": {"stiffness": 1e9},
}


def measure(material):
    """Forces and bulges at all depths, (6), and their derivatives by E and ν, (6, 2)."""
    found = [tetlap.gradient(SCENE, OF, BY, set={**dict(zip(BY, material)), "obstacles.ball.motion.velocity": [0, 0, -depth]})
             for depth in DEPTHS]
    return np.concatenate([one["value"] for one in found]), np.concatenate([one["derivative"] for one in found])


def material_of(x):
    return np.array([np.exp(x[0]), 0.5 - np.exp(x[1])])


def fit(start, data, noise):
    """The path of (E, ν) from a start, (steps, 2), χ² along it, and the covariance of ln E and ln(½ − ν) at its end."""
    x, damping, path, misfits = np.array([np.log(start[0]), np.log(0.5 - start[1])]), 1e-2, [], []
    q, derivative = measure(material_of(x))
    while len(path) < MOST_STEPS:
        E, nu = material_of(x)
        r, J = (q - data) / noise, derivative * [E, nu - 0.5] / noise[:, None]
        path.append((E, nu)), misfits.append(r @ r)
        normal = J.T @ J
        if len(misfits) > 1 and misfits[-2] - misfits[-1] < 1e-6 * (1 + misfits[-1]):
            break
        while damping < 1e12:
            step = np.linalg.solve(normal + damping * np.diag(np.diag(normal)), -J.T @ r)
            step *= min(1, 1.5 / abs(step).max())
            tried = np.minimum(x + step, [np.inf, np.log(0.7)])  # ν > −0.2
            q, derivative = measure(material_of(tried))
            if np.sum(((q - data) / noise) ** 2) <= misfits[-1]:
                break
            damping *= 10
        x, damping = tried, damping / 10
    return np.array(path), np.array(misfits), np.linalg.inv(normal)


def draw(file, paths, data, noise, fitted):
    """Left E and ν by steps from each start, right the forces with their noise and as fitted."""
    colours = ("#1b6ca8", "#c1442e", "#3a8f4d")
    parts = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 900 330" font-family="sans-serif" font-size="13">',
             '<rect width="900" height="330" fill="white"/>']

    def panel(left, title, below, xs, ys, low, high, marks, log=False):
        span = (np.log(high) - np.log(low)) if log else high - low
        place = (lambda y: 280 - 240 * ((np.log(y / low) if log else y - low) / span))
        parts.append(f'<text x="{left}" y="22">{title}</text><text x="{left + 110}" y="318" text-anchor="middle">{below}</text>')
        parts.append(f'<path d="M{left} 40V280H{left + 220}" fill="none" stroke="#444"/>')
        for y, text in marks:
            parts.append(f'<text x="{left - 6}" y="{place(y) + 4:.0f}" text-anchor="end" fill="#444">{text}</text>')
        return (lambda x: left + 220 * (x - xs[0]) / (xs[1] - xs[0])), place

    most = max(len(path) for path in paths.values()) - 1
    for left, title, k, low, high, marks, log in ((60, "E [Pa]", 0, 2e4, 3e6, ((3e4, "3e4"), (2e5, "2e5"), (2e6, "2e6")), True),
                                                  (360, "ν", 1, 0, 0.5, ((0.2, "0.2"), (0.3, "0.3"), (0.42, "0.42")), False)):
        across, up = panel(left, title, "steps", (0, most), None, low, high, marks, log)
        parts.append(f'<path d="M{left} {up(TRUTH[k]):.1f}h220" stroke="#888" stroke-dasharray="4 4"/>')
        for colour, path in zip(colours, paths.values()):
            line = " ".join(f"{across(i):.1f},{np.clip(up(y), 35, 285):.1f}" for i, y in enumerate(path[:, k]))
            parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
    top = 1.15 * data[::2].max()
    across, up = panel(660, "force on the ball [N]", "depth [mm]", (0, 13), None, 0, top, ((0, "0"), (data[4], f"{data[4]:.0f}")))
    line = " ".join(f"{across(1e3 * depth):.1f},{up(y):.1f}" for depth, y in zip(DEPTHS, fitted[::2]))
    parts.append(f'<polyline points="{across(0):.1f},{up(0):.1f} {line}" fill="none" stroke="{colours[0]}" stroke-width="2"/>')
    for depth, y, bar in zip(DEPTHS, data[::2], noise[::2]):
        parts.append(f'<path d="M{across(1e3 * depth):.1f} {up(y - bar):.1f}V{up(y + bar):.1f}" stroke="#444"/>'
                     f'<circle cx="{across(1e3 * depth):.1f}" cy="{up(y):.1f}" r="4" fill="none" stroke="#444"/>')
    with open(file, "w", encoding="utf-8") as out:
        out.write("\n".join(parts) + "\n</svg>\n")


def main(file=None):
    exact, _ = measure(TRUTH)
    noise = NOISE * np.tile([abs(exact[::2]).max(), abs(exact[1::2]).max()], len(DEPTHS))
    data = exact + noise * np.random.default_rng(SEED).standard_normal(len(exact))
    paths, ends = {}, {}
    for name, start in STARTS.items():
        paths[name], misfits, covariance = fit(start, data, noise)
        ends[name] = paths[name][-1], misfits[-1], np.sqrt(np.diag(covariance)) * [paths[name][-1][0], 0.5 - paths[name][-1][1]]
        (E, nu), misfit, spread = ends[name]
        print(f"{name}: from E = {start[0]:.3g}, ν = {start[1]:.3g} in {len(misfits) - 1} steps to E = {E:.4g} ± {spread[0]:.2g} Pa, "
              f"ν = {nu:.4f} ± {spread[1]:.2g}; χ² = {misfit:.3f}")
    if file:
        draw(file, paths, data, noise, measure(ends["near"][0])[0])
    return ends


if __name__ == "__main__":
    main(*sys.argv[1:2])
