# SPDX-License-Identifier: Apache-2.0
"""Two published problems of differentiable contact, on their own meshes: what throws a rabbit to a mark, and how slippery a slide is.

    python3 published.py DATA bunnies|slide

DATA is the folder json_scripts of the repository DiffIPC-data, which belongs to Z. Huang et al., Differentiable solver for time-dependent
deformation problems with contact, ACM Trans. Graph. 43 (2024); it is not part of tetlap.

bunnies  their figure 1: one rabbit is thrown at another over a smooth floor. Sought is its velocity, so that the other one's centre is at a mark
         (x, z) after two seconds; the loss is the squared distance [m²].
slide    their figure 21: a rabbit tumbles down a slide. Sought is the friction coefficient, begun at .5, from where its centre is at .1; the loss
         is 100 times the squared distances [m²] at four times of the first second. They look at two seconds: after so many blows the exact
         derivative no longer points to the truth.

Materials, meshes, places and starts are theirs. Their implicit Euler steps of .05 s damp by themselves; here the rabbits have a damping of their
own, and the run chooses its steps. L-BFGS (descent.py) follows exact derivatives through all contacts.
"""

import argparse
import tempfile
from pathlib import Path

import descent
import numpy as np

import tetlap

MARK = (3.67854, 0.137261)  # (x, z) of the other rabbit's centre after two seconds [m]
FRICTION, TIMES = 0.1, (0.25, 0.5, 0.75, 1.0)  # the true one; [s]


def rabbit(name, mesh, young, density, place, velocity):
    return {"name": name, "mesh": {"file": str(mesh)}, "place": place, "velocity": velocity,
            "material": {"law": "neo_hookean", "young": young, "poisson": 0.48, "density": density, "damping": 5e-3}}


def bunnies(data):
    mesh = data / "fig1_bunnies" / "stanford-bunny.obj_.msh"
    return {"time": {"end": 2}, "effects": {"gravity": [0, -9.81, 0]},
            "bodies": [rabbit("thrown", mesh, 1e6, 1240, {"scale": 6}, [2, 0.5, 0]),
                       rabbit("other", mesh, 1e6, 1240, {"scale": 6, "translate": [1, 0, 0]}, [0, 0, 0])],
            "obstacles": [{"name": "floor", "mesh": {"file": str(data / "fig1_bunnies" / "flat-pool.msh")}}],
            "contact": {}, "output": {"frames": 2, "vtu": False}}


def slide(data):
    folder = data / "fig21_friction_bunny"
    place = {"scale": 4, "translate": [0.5, -0.13, -0.7]}
    return {"time": {"end": TIMES[-1]}, "effects": {"gravity": [0, -9.8, 0]},
            "bodies": [rabbit("rabbit", folder / "stanford-bunny.obj_.msh", 1e5, 1000, place, [0, 0, 2])],
            "obstacles": [{"name": "slide", "mesh": {"file": str(folder / "slide.msh")}}],
            "contact": {"friction": FRICTION}, "output": {"frames": len(TIMES), "vtu": False}}


def centres(scene, body):
    """Of a body in every frame, (frames, 3), the first at the start."""
    with tempfile.TemporaryDirectory() as folder:
        history = tetlap.run(scene, Path(folder, "run")).history
    return np.stack([history[f"centre_{body}_{axis}_m"] for axis in "xyz"], axis=1)


def least(scene, by, start, goal, weight, longest, most):
    """The points of the descent and the losses weight · Σ (q − d)², goal: the quantities q and the values d."""
    with tempfile.TemporaryDirectory() as folder:
        misfit = Path(folder, "goal.csv")
        misfit.write_text("".join(f"{quantity}, {2 * weight}, {value}\n" for quantity, value in goal))

        def evaluate(x):
            found = tetlap.gradient(scene, f"misfit:{misfit}", by, set=dict(zip(by, map(float, x))))
            print(f"  {np.round(x, 4)}: {found['value'][0]:.6f}", flush=True)
            return found["value"][0], found["derivative"][0]

        return descent.minimise(evaluate, start, longest=longest, most=most)


def throw(data, most=20):
    scene = bunnies(data)
    begun = centres({**scene, "time": {"end": 1e-3}}, "other")[0]
    goal = [(f"displacement:other:{axis}", mark - at) for axis, mark, at in zip("xz", MARK, begun[[0, 2]])]
    by = [f"bodies.thrown.velocity[{k}]" for k in range(3)]
    return least(scene, by, [2, 0.5, 0], goal, 1, 0.5, most)


def slip(data, most=20):
    scene = slide(data)
    way = centres(scene, "rabbit")
    goal = [(f"displacement:rabbit:{axis}@{time}", d)
            for time, moved in zip(TIMES, way[1:] - way[0]) for axis, d in zip("xyz", moved)]
    return least(scene, ["contact.friction"], [0.5], goal, 100, 0.2, most)


PROBLEMS = {"bunnies": throw, "slide": slip}


def main(data, problem, most=20):
    points, losses = PROBLEMS[problem](Path(data).resolve(), most)
    print(f"{problem}: {np.round(points[0], 4)} → {np.round(points[-1], 4)}, loss {losses[0]:.6g} → {losses[-1]:.6g} in {len(losses) - 1} steps")
    return points, losses


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", metavar="DATA", help="the folder json_scripts of DiffIPC-data")
    parser.add_argument("problem", choices=PROBLEMS)
    main(**vars(parser.parse_args()))
