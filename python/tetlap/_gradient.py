# SPDX-License-Identifier: Apache-2.0
"""Derivatives of what a scene ends with by its parameters, by `tetlap gradient`."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from . import _locate
from ._compare import _execute
from ._run import _place_scene
from ._scene import Scene, Settings, override_texts
from ._overlap.weights import read_weights


def _names(value, what, example):
    names = [value] if isinstance(value, str) else list(value)
    if not names or not all(isinstance(name, str) for name in names):
        raise TypeError(f"{what} is {value!r}; expected a text as {example!r}, or a list of such texts")
    return names


def _number(value):
    return np.nan if value is None else value


def _arrays(found, of, by):
    goals = [found["of"][name] for name in of]
    rows = [[goal["by"][key] for key in by] for goal in goals]
    return {
        "of": of,
        "by": by,
        "value": np.array([_number(goal["value"]) for goal in goals]),
        "derivative": np.array([[_number(cell["derivative"]) for cell in row] for row in rows]).reshape(len(of), len(by)),
        "share": np.array([[_number(cell["share"]) for cell in row] for row in rows]).reshape(len(of), len(by)),
        "parameter": np.array([_number(cell["value"]) for cell in rows[0]]),
        "unit": [goal["unit"] for goal in goals],
        "parameter_unit": [cell["unit"] for cell in rows[0]],
        "does_not_act": {key: cell["does_not_act"] for key, cell in zip(by, rows[0]) if cell["does_not_act"]},
        "no_derivative": {key: cell["no_derivative"] for key, cell in zip(by, rows[0]) if cell["no_derivative"]},
        "adjoint_residual": np.array([goal["adjoint_residual"] for goal in goals]),
        "matrix_residual": np.array([_number(goal["matrix_residual"]) for goal in goals]),
        "force_residual": found["force_residual"],
        "contact_stiffness": found["contact_stiffness"],
        **_check_of(goals, rows),
    }


def _check_of(goals, rows):
    if not rows[0] or "halved" not in rows[0][0]:
        return {}
    along = {key: np.array([_number(goal[key]) for goal in goals]) for key in ("along_by_derivatives", "along_by_runs")}
    return {"halved": np.array([[_number(cell["halved"]) for cell in row] for row in rows]), **along}


def _read_slopes(folder, count):
    names = ["slope.safetensors"] if count == 1 else [f"slope-{number}.safetensors" for number in range(count)]
    return [read_weights(Path(folder) / name) for name in names]


def gradient(scene: Scene, of: str | list[str], by: str | list[str], *, set: Settings = None, total: bool = False,  # noqa: A002
             at: float | None = None, check: bool = False, weights: bool = False, memory: float | None = None) -> dict:
    """Runs a static scene or a motion; what quantities are at its end or at other times, and
    their exact derivatives, as a dict of arrays.

    scene: a scene file's path, or a dict with the same keys (docs/scene.md). Nothing is written.
    of: a quantity, "force:ball:ground:z", "force:ball:ground:z@0.02" at a time, or a list of them (docs/gradients.md).
    at: the time [s] of quantities that name none; None: the run's end.
    by: a parameter's key, "bodies.ground.material.young", or a list of them.
    set: as of `tetlap.run`.
    total: a contact stiffness that the scene does not give changes with E and ν as it is chosen from them; else it is kept.
    weights: by the weights of contact.overlap's network, too; `by` may then be empty.
    memory: what the replay of a motion, or of a scene with friction, may keep [MB]; where it were more, parts are done twice. None: what
    there is.

    value (of): the quantities. derivative (of, by): dq/dp. share (of, by): p dq/dp / q. parameter (by): their values. unit and
    parameter_unit: lists of texts. does_not_act: why a derivative is 0, no_derivative: why it is NaN, by key. force_residual,
    adjoint_residual (of), matrix_residual (of): how exact. With `check`, from three runs more: halved (of, by), by which share of itself a
    derivative moves where steps are halved; along_by_derivatives and along_by_runs (of), how q changes along a random direction. With
    `weights`, weights: dq/dw (of), each as `read_weights` gives it. contact_stiffness: "given", "kept", "follows" or "none". Where there is no number: NaN.

    RunError: the scene has no such gradient, or the run failed; it carries the program's message.
    """
    of = _names(of, "of", "displacement:block:z")
    by = [] if weights and len(by) == 0 else _names(by, "by", "contact.stiffness")
    scene, _, keeper = _place_scene(scene, None)
    command = [_locate.program(), "gradient", str(scene), "--json"] + ["--by", ",".join(by)] * (len(by) > 0) + ["--check"] * bool(check)
    for name in of:
        command += ["--of", name]
    for text in override_texts(set):
        command += ["--set", text]
    if at is not None:
        command += ["--at", repr(float(at))]
    if memory is not None:
        command += ["--memory", repr(float(memory))]
    command += ["--total"] * bool(total)
    try:
        if not weights:
            return _arrays(_execute(command, []), of, by)
        with tempfile.TemporaryDirectory() as folder:
            found = _arrays(_execute([*command, "--weights", str(Path(folder) / "slope.safetensors")], []), of, by)
            return {**found, "weights": _read_slopes(folder, len(of))}
    finally:
        del keeper
