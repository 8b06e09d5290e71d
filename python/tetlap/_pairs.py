# SPDX-License-Identifier: Apache-2.0
"""Labelled pairs of tetrahedra as arrays, and models measured on them."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from . import _locate
from ._errors import RunError
from ._run import _SERVER_S, _Server
from ._scene import OverlapModel


def _call(words, server=None):
    """What the program says on standard output; RunError with its message."""
    process = subprocess.Popen([_locate.program(), *map(str, words)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True, errors="replace", pass_fds=server.descriptors if server else ())
    if server:
        server.hand_over()
    try:
        out, err = process.communicate()
    except BaseException:
        process.kill()
        process.wait()
        raise
    finally:
        if server:
            server.join(_SERVER_S)
    if process.returncode != 0:
        lines = [line[7:] if line.startswith("error: ") else line for line in err.splitlines()]
        raise RunError(f"tetlap {words[0]} failed: " + ("\n".join(lines) or f"exit code {process.returncode}"), process.returncode,
                       None) from (server.error if server else None)
    return out


def load_pairs(file: str | os.PathLike, *, first: int = 0, count: int | None = None) -> np.ndarray:
    """The pairs of a data set (docs/data.md) as an array of records (n).

    Fields: `coordinates` (2, 4, 3) float64 [edges of the unit cube]; `status`, 1 where the closed tetrahedra have a point in common, and
    `kind`, uint8; `volume` float64; `gradient` (2, 4, 3) and `centroid` (3) float64 if the file has them. So
    `pairs["coordinates"]` is (n, 2, 4, 3), as `tetlap.overlap` and models take it.

    first, count: a range of the pairs; default: all.

    RunError: no data set, damaged, or without such a range; it carries the program's message.
    """
    with tempfile.TemporaryDirectory(prefix="tetlap-") as folder:
        target = Path(folder, "pairs.npy")
        words = ["dataset", "export", file, "-o", target, "--first", first]
        _call(words if count is None else [*words, "--count", count])
        packed = np.load(target)
    return packed.astype(np.dtype(packed.dtype.descr, align=True))  # PyTorch takes no array whose rows begin between its numbers


def _write_pairs(folder, data):
    """A data set's path: of one that is there, or of pairs (n, 2, 4, 3) that are labelled by exact arithmetic."""
    if isinstance(data, (str, os.PathLike)):
        return data
    if getattr(data, "dtype", None) is not None and data.dtype.names and "coordinates" in data.dtype.names:
        data = data["coordinates"]
    data = np.ascontiguousarray(data, dtype=np.float64)
    if data.ndim < 1 or data.shape[1:] != (2, 4, 3):
        raise ValueError(f"pairs have the shape {data.shape}, expected (n, 2, 4, 3)")
    source, target = Path(folder, "pairs.npy"), Path(folder, "pairs.h5")
    np.save(source, data.reshape(len(data), 24))
    _call(["dataset", "import", source, "-o", target, "--gradient"])
    return target


def evaluate(model: OverlapModel, data: str | os.PathLike | np.ndarray | None = None, *, law: str | None = None, mix: Mapping[str, float] | None = None, count: int | None = None,
             seed: int | None = None, paths: int | None = None, threads: int | None = None) -> dict:
    """Measures an overlap model on labelled pairs; a dict with the keys of `tetlap eval --json` (docs/training.md).

    model: a name, a file, or a function or torch.nn.Module that takes pairs (n, 2, 4, 3) and returns what docs/own_model.md says.
        It is called in a thread of this process.
    data: a data set's file; or pairs (n, 2, 4, 3), or an array of records as `load_pairs` returns it, which are labelled anew by
        exact arithmetic. Instead of it a law draws them:
    law, mix, seed: as `tetlap datagen` has them: "scene", "paper-test", "uniform"; {"scene": 1}; a whole number.
    count: the number of pairs; default: all of the file, or the law's.
    paths: also look for jumps of V and of its gradient along that many paths.

    RunError: the program failed; it carries the program's message. What a function raises is its cause.
    """
    if (data is None) == (law is None):
        raise TypeError("give either data or law, as in evaluate(f, 'pairs.h5') or evaluate(f, law='scene', seed=1)")
    server = _Server(model) if callable(model) else None
    try:
        with tempfile.TemporaryDirectory(prefix="tetlap-") as folder:
            words = ["eval", server.word if server else model]
            words += [_write_pairs(folder, data)] if data is not None else ["--law", law]
            if mix is not None:
                words += ["--mix", ",".join(f"{kind}={share}" for kind, share in mix.items())]
            for name, value in (("seed", seed), ("count", count), ("paths", paths), ("threads", threads)):
                if value is not None:
                    words += [f"--{name}", int(value)]
            return json.loads(_call([*words, "--json"], server))
    finally:
        if server:
            server.hand_over()
