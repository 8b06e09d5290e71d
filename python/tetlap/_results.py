# SPDX-License-Identifier: Apache-2.0
"""What a run wrote (docs/output.md), as arrays."""

import json
import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ._errors import Error, UnknownNameError
from ._vtu import read_pvd, read_vtu


class Frame:
    """One frame, or the surface of obstacles at its time.

    time: [s]
    points: current positions [m]          (n, 3)
    cells: vertices of tetrahedra (m, 4), of obstacles without a mesh of triangles (m, 3)
    point_data, cell_data: arrays by name, as the program documents them; frame["velocity"] looks in both
    obstacles: the surfaces of obstacles without a mesh, as frames
    """

    def __init__(self, path, time=None, obstacles=()):
        data = read_vtu(path)
        self.path = Path(path)
        self.time = data["time"] if data["time"] is not None else time
        self.points, self.cells = data["points"], data["cells"]
        self.point_data, self.cell_data = data["point_data"], data["cell_data"]
        self.obstacles = [Frame(obstacle, self.time) for obstacle in obstacles]

    def __getitem__(self, name):
        for arrays in (self.point_data, self.cell_data):
            if name in arrays:
                return arrays[name]
        raise UnknownNameError(f"{self.path.name} has no array '{name}'; it has {', '.join(self.names)}")

    @property
    def names(self):
        return [*self.point_data, *self.cell_data]

    def __repr__(self):
        return f"<Frame t={self.time} points={len(self.points)} cells={len(self.cells)}>"


class Frames(Sequence):
    """The frames of a run, each read from its file when it is asked for."""

    def __init__(self, directory, keeper=None):
        self._directory, self._keeper = Path(directory), keeper
        listed = self._directory / "frames.pvd"
        self._entries = read_pvd(listed) if listed.exists() else []

    def __len__(self):
        return len(self._entries)

    def __getitem__(self, index):
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        time, files = self._entries[index]
        paths = [self._directory / file for file in files]
        return Frame(paths[0], time, paths[1:])

    @property
    def times(self):
        """[s], (frames)"""
        return np.array([time for time, _ in self._entries])

    def array(self, name):
        """One array of all frames: "points" or a name of Frame, (frames, …)."""
        return np.stack([frame.points if name == "points" else frame[name] for frame in self])

    def __repr__(self):
        return f"<{len(self)} frames of {self._directory}>"


def read_history(path):
    """history.csv as a structured array: rows are frames, fields are its columns.

    A line that is not whole, which a run that was killed may leave at the end, is left out.
    """
    text = Path(path).read_text(encoding="utf-8")
    lines = text[: text.rfind("\n") + 1].splitlines()
    if not lines:
        raise Error(f"{path}: expected a line of names")
    dtype = [(name, "f8") for name in lines[0].split(",")]
    rows = np.empty(len(lines) - 1, dtype)
    for row, line in enumerate(lines[1:]):
        values = line.split(",")
        if len(values) != len(dtype):
            raise Error(f"{path}: line {row + 2} has {len(values)} numbers, expected {len(dtype)}")
        rows[row] = tuple(map(float, values))
    return rows


FORMAT = 1  # of summary.json and manifest.json


def _read_json(path):
    if not path.exists():
        return None
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise Error(f"{path}: is no JSON ({error})") from None
    found = record.get("format") if isinstance(record, dict) else None
    if found != FORMAT:
        kind = "has no format number" if found is None else f"is of format {found}"
        raise Error(f"{path}: {kind}, expected format {FORMAT}: use the package of the program that wrote the file, or "
                    "run the scene again")
    return record


class Run:
    """A run's folder.

    frames: a sequence of Frame; frames.array("velocity") is one array of all
    history: structured array, a row per frame, or None if the scene writes none
    summary, manifest: dicts, or None while the run goes on

    A temporary folder lives as long as its `keeper`, to which the run and its frames hold on.
    """

    def __init__(self, directory, keeper=None):
        self.directory, self._keeper = Path(directory), keeper
        if not self.directory.is_dir():
            raise FileNotFoundError(f"{directory}: there is no such folder; expected one that `tetlap run` wrote")
        history = self.directory / "history.csv"
        self.frames = Frames(self.directory, keeper)
        self.history = read_history(history) if history.exists() else None
        self.summary = _read_json(self.directory / "summary.json")
        self.manifest = _read_json(self.directory / "manifest.json")
        if not self.frames and self.history is None and self.summary is None:
            raise Error(f"{directory}: expected frames.pvd, history.csv or summary.json, as `tetlap run` writes them")

    @property
    def outcome(self):
        """"finished", "interrupted", "failed", or None while the run goes on."""
        return self.summary["outcome"] if self.summary else None

    def __repr__(self):
        return f"<Run {os.fspath(self.directory)}: {self.outcome}, {len(self.frames)} frames>"


def read(directory):
    """What a run wrote into `directory`, also of a run that goes on, was stopped or failed."""
    return Run(directory)
