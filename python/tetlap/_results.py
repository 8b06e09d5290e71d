# SPDX-License-Identifier: Apache-2.0
"""What a run wrote (docs/output.md), as arrays."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from . import _locate, _views
from ._errors import Error, UnknownNameError
from ._vtu import read_pvd, read_vtu

if TYPE_CHECKING:
    import meshio
    import pyvista
    import xarray


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

    def __getitem__(self, name: str) -> np.ndarray:
        """An array of points or of cells by its name. UnknownNameError names those that there are."""
        for arrays in (self.point_data, self.cell_data):
            if name in arrays:
                return arrays[name]
        raise UnknownNameError(f"{self.path.name} has no array '{name}'; it has {', '.join(self.names)}")

    @property
    def names(self) -> list[str]:
        """Of the arrays of points and of cells."""
        return [*self.point_data, *self.cell_data]

    def to_meshio(self) -> meshio.Mesh:
        """A `meshio.Mesh` of the cells with all arrays. Error: there is no package meshio."""
        return _views.to_meshio(self.points, self.cells, self.point_data, self.cell_data)

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """A `pyvista.UnstructuredGrid` of the cells with all arrays. Error: there is no package pyvista."""
        return _views.to_pyvista(self.points, self.cells, self.point_data, self.cell_data)

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

    def __getitem__(self, index: int | slice) -> Frame | list[Frame]:
        """One by its number, or several."""
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        time, files = self._entries[index]
        paths = [self._directory / file for file in files]
        return Frame(paths[0], time, paths[1:])

    @property
    def times(self) -> np.ndarray:
        """[s], (frames)"""
        return np.array([time for time, _ in self._entries])

    def array(self, name: str) -> np.ndarray:
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


def report_html(directory):
    """The page that `tetlap report` makes of what a run or a comparison wrote, inline; "": it cannot be made."""
    with tempfile.TemporaryDirectory(prefix="tetlap-") as folder:
        page = Path(folder, "page.html")
        try:
            done = subprocess.run([_locate.program(), "report", os.fspath(directory), "-o", os.fspath(page)], stdin=subprocess.DEVNULL,
                                  capture_output=True, check=False)
            return _views.page_html(page.read_text(encoding="utf-8")) if done.returncode == 0 else ""
        except (Error, OSError):
            return ""


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
    def outcome(self) -> str | None:
        """"finished", "interrupted", "failed", or None while the run goes on."""
        return self.summary["outcome"] if self.summary else None

    def to_xarray(self) -> xarray.Dataset:
        """An `xarray.Dataset` of the history: its columns over the coordinate `time_s`, and `points` (time_s, vertex, xyz) [m] of the frames where
        there is one a row. Error: there is no package xarray, or the run wrote no history."""
        xarray = _views.need("xarray")
        if self.history is None:
            raise Error(f"{self.directory}: the run wrote no history.csv")
        names = [name for name in self.history.dtype.names if name != "time_s"]
        columns = {name: ("time_s", self.history[name]) for name in names}
        if self.frames and len(self.frames) == len(self.history):
            columns["points"] = (("time_s", "vertex", "xyz"), self.frames.array("points"))
        return xarray.Dataset(columns, coords={"time_s": self.history["time_s"]}, attrs={"directory": os.fspath(self.directory)})

    def _repr_html_(self):
        """In a notebook: the page of `tetlap report`, which needs no network; a table where it cannot be made."""
        page = report_html(self.directory)
        if page:
            return page
        summary = self.summary or {}
        wanted = ("end_time", "steps", "wall_s", "contact_force_max")  # docs/summary.md
        rows = [("outcome", self.outcome or "goes on"), ("frames", len(self.frames))]
        return _views.table_html(f"Run {self.directory}", rows + [(name, _views.digits(summary[name])) for name in wanted if name in summary])

    def __repr__(self):
        return f"<Run {os.fspath(self.directory)}: {self.outcome}, {len(self.frames)} frames>"


def read(directory: str | os.PathLike) -> Run:
    """What a run wrote into `directory`, also of a run that goes on, was stopped or failed."""
    return Run(directory)
