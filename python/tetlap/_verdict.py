# SPDX-License-Identifier: Apache-2.0
"""What an overlap model is fit for, by `tetlap verdict`."""

from __future__ import annotations

import os
from pathlib import Path

from . import _locate, _views
from ._compare import _execute
from ._results import Run
from ._run import _Folder, _Server
from ._scene import OverlapModel

_USES = {"detect": "fit to detect overlaps", "forces": "fit for forces at given states", "motion": "fit to drive a motion"}


class Verdict:
    """What an overlap model is fit for, and the figures of it (docs/verdict.md).

    grades: {"detect": (fit, reason), "forces": …, "motion": …}: a bool, and the first condition that is not met with its figure, "" where it is fit
    detect, forces, motion: the bools alone
    contract, pairs, unseen: dicts of figures, as in verdict.json; None: not measured
    runs: a dict a scene: `scene`, `outcome`, `nodal_force_error`, `total_force_error`, `path_error`, `energy_gain`, `steps_ratio`, …
    seed: of the pairs; directory: where everything is kept
    """

    def __init__(self, row, seed, directory, keeper):
        self.name, self.seed, self.directory, self._keeper = row["model"], seed, Path(directory), keeper
        self.grades = {use: (grade["fit"], grade["reason"]) for use, grade in row["grades"].items()}
        self.contract, self.pairs, self.unseen, self.runs = row["contract"], row["pairs"], row["unseen"], row["runs"]

    @property
    def detect(self) -> bool:
        """Whether it is fit to detect overlaps."""
        return self.grades["detect"][0]

    @property
    def forces(self) -> bool:
        """Whether it is fit for forces at given states."""
        return self.grades["forces"][0]

    @property
    def motion(self) -> bool:
        """Whether it is fit to drive a motion."""
        return self.grades["motion"][0]

    def run(self, scene: str) -> Run:
        """The model's run of a scene."""
        if scene not in [row["scene"] for row in self.runs]:
            raise KeyError(f"{scene!r} was not run; there are {', '.join(row['scene'] for row in self.runs)}")
        return Run(self.directory / self.name / scene / self.name, self._keeper)

    def __repr__(self):
        return f"<Verdict {self.name}: " + ", ".join(f"{use} {'yes' if fit else 'no'}" for use, (fit, _) in self.grades.items()) + ">"

    def __str__(self):
        return "\n".join(f"{words}: " + ("yes" if self.grades[use][0] else f"no, {self.grades[use][1]}") for use, words in _USES.items())

    def _repr_html_(self):
        grades = _views.table_html(f"Verdict of {self.name}", [line.split(": ", 1) for line in str(self).splitlines()])
        names = ("scene", "outcome", "nodal_force_error", "total_force_error", "path_error", "energy_gain", "steps_ratio")
        return grades + _views.grid_html("In place", names, [[_views.digits(row.get(name)) for name in names] for row in self.runs])


def verdict(model: OverlapModel, directory: str | os.PathLike | None = None, *, quick: bool = False, seed: int | None = None,
            jobs: int | None = None) -> Verdict:
    """Judges an overlap model by `tetlap verdict`: hard pairs, pairs that no training saw, twelve scenes beside `clip`; a `Verdict`.

    model: a name, a file, or a function or torch.nn.Module that takes pairs (n, 2, 4, 3) and returns what docs/own_model.md says.
        A function is called in a thread of this process, one question after the other.
    directory: where everything is kept, in a folder of the model's name. The same call goes on with what is not there yet: another function
        needs another directory. Default: a temporary one that lives as long as the result.
    quick: fewer pairs and five scenes.
    seed: of the pairs; default: the directory's, else a new one.
    jobs: processes at once; default: one a core, for a function one.

    RunError: it could not begin, or was interrupted; it carries the program's message. A question that the model failed at counts as not met, and the
    logger "tetlap" names the file that says why.
    """
    server = _Server(model) if callable(model) else None
    keeper = _Folder() if directory is None else None
    directory = Path(keeper.path if keeper else directory)
    command = [_locate.program(), "verdict", server.word if server else str(model), "-o", str(directory), "--json"]
    if quick:
        command.append("--quick")
    for name, value in (("seed", seed), ("jobs", jobs)):
        if value is not None:
            command += [f"--{name}", str(int(value))]
    try:
        found = _execute(command, [server] if server else [])
    finally:
        if server:
            server.hand_over()
    return Verdict(found["models"][-1], int(found["seed"]), directory, keeper)  # those of earlier calls come first
