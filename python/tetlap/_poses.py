# SPDX-License-Identifier: Apache-2.0
"""Many rigid poses of a body, by the program as a child process."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from . import _locate
from ._errors import RunError
from ._scene import Scene, Settings, override_texts, scene_text, with_absolute_paths


class Poses(NamedTuple):
    """Of every pose: the overlap volume, and force and moment on the posed body for a pressure of 1 Pa, which are minus
    the slopes of the volume by a shift and by a turn about the body's posed centre."""

    volume: np.ndarray  # [m³]   (n,)
    force: np.ndarray  # [m²]    (n, 3)
    moment: np.ndarray  # [m³]   (n, 3)


def _rows(poses):
    """(n, 12): R row by row, then t."""
    array = np.asarray(poses, dtype=float)
    if array.ndim == 2 and array.shape[1] == 12:
        return array
    if array.ndim == 3 and array.shape[1:] in ((3, 4), (4, 4)):
        if array.shape[1] == 4 and not np.array_equal(array[:, 3], np.broadcast_to([0.0, 0, 0, 1], (len(array), 4))):
            raise ValueError("the last row of a 4 × 4 pose must be 0 0 0 1")
        return np.concatenate([array[:, :3, :3].reshape(-1, 9), array[:, :3, 3]], axis=1)
    raise ValueError(f"poses have the shape {array.shape}; expected (n, 12), R row by row and then t, (n, 3, 4) or (n, 4, 4)")


def _execute(words):
    process = subprocess.run(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                             errors="replace")
    if process.returncode == 0:
        return
    lines = [line.partition(": ")[2] for line in process.stderr.splitlines() if line.startswith("error: ")]
    message = "\n".join(lines) or process.stderr.strip() or f"exit code {process.returncode}"
    raise RunError(f"tetlap poses failed: {message}", process.returncode, None)


def poses(scene: Scene, poses: np.ndarray | None = None, *, random: int | None = None, body: str | None = None, shift: float | None = None,
          turn: float | None = None, seed: int | None = None, set: Settings = None,  # noqa: A002: as tetlap.run has it
          device: str | None = None, threads: int | None = None) -> Poses:
    """Overlap volume and wrench of many rigid poses x' = R x + t of one of a scene's bodies against all others.

    scene: a scene file's path, or a dict with the same keys.
    poses: (n, 12), R row by row and then t [m]; or (n, 3, 4), [R t]; or (n, 4, 4).
    random: in their place so many poses at random about the scene's own; shift [m], turn [rad] and seed as the
        program's options.
    body: the posed body's name; default: the first.
    set: what to change in the scene, as in `tetlap.run`.
    device: "host", "opencl", "cuda" or "auto"; default: this processor's vectors. The answers are the same to the bit.

    A `Poses` of arrays. RunError: the program failed; it carries the program's message.
    """
    if (poses is None) == (random is None):
        raise TypeError("give either poses or random")
    with tempfile.TemporaryDirectory(prefix="tetlap-") as folder:
        if isinstance(scene, Mapping):
            text = scene_text(with_absolute_paths(scene))
            scene = Path(folder, "scene.yaml")
            scene.write_text(text + "\n", encoding="utf-8")
        table = Path(folder, "table.csv")
        words = [_locate.program(), "poses", str(scene), "-o", str(table)]
        if poses is not None:
            np.savetxt(Path(folder, "poses"), _rows(poses), fmt="%.17g")
            words += ["--poses", str(Path(folder, "poses"))]
        options = {"random": random, "body": body, "shift": shift, "turn": turn, "seed": seed, "device": device,
                   "threads": threads}
        for name, value in options.items():
            if value is not None:
                words += [f"--{name}", str(value)]
        for override in override_texts(set):
            words += ["--set", override]
        _execute(words)
        numbers = np.loadtxt(table, delimiter=",", skiprows=1, ndmin=2)
    return Poses(numbers[:, 1].copy(), numbers[:, 2:5].copy(), numbers[:, 5:8].copy())
