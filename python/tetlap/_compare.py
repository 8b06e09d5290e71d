# SPDX-License-Identifier: Apache-2.0
"""One scene with several overlap models, by `tetlap compare`."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Mapping
from pathlib import Path

from . import _locate, _views
from ._errors import RunError
from ._results import Run, report_html
from ._run import _SERVER_S, _Folder, _place_scene, _Server, _Words
from ._scene import OverlapModel, Scene, Settings, override_texts


class Compared:
    """A model's part of a comparison.

    name: what it is called
    outcome: "finished", "failed", … as in summary.json
    errors: dict, a row of compare.json (docs/summary.md): `force_error_l2`, `trajectory_error`, `audit_force_error`, `summary`, …
    run: a `tetlap.Run`; None where the model has none
    """

    def __init__(self, name, row, run):
        self.name, self.outcome, self.errors, self.run = name, row["outcome"], row, run

    def __repr__(self):
        error = self.errors.get("force_error_l2")
        return f"<Compared {self.name}: {self.outcome}, error of forces {error if error is None else format(error, '.3g')}>"


class Comparison(dict):
    """The `Compared` of each model by its name; in a notebook a table of their errors, and the page of their runs side by side."""

    _directory = None  # of the runs and compare.json

    def _repr_html_(self):
        return self._errors_html() + (report_html(self._directory) if self._directory else "")

    def _errors_html(self):
        wanted = ("force_error_l2", "trajectory_error", "audit_force_error", "audit_volume_error")
        names = [name for name in wanted if any(name in model.errors for model in self.values())]
        rows = [(model.name, model.outcome, *(_views.digits(model.errors.get(name)) for name in names)) for model in self.values()]
        return _views.grid_html("Comparison of overlap models", ("model", "outcome", *names), rows)


def _serve(models):
    """The models' words in the order given, and the servers of those that are functions of this process."""
    servers, words = [], []
    for name, model in models.items():
        if callable(model):
            servers.append(_Server(model, name))
            words.append(servers[-1].word)
        else:
            words.append(str(model))
    return words, servers


def _execute(command, servers):
    descriptors = [descriptor for server in servers for descriptor in server.descriptors]
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               errors="replace", pass_fds=descriptors)
    for server in servers:
        server.hand_over()
    said = _Words(process.stderr)
    try:
        out = process.stdout.read()
        process.wait()
    except BaseException:
        process.kill()
        process.wait()
        raise
    finally:
        process.stdout.close()
        said.join()
        for server in servers:
            server.join(_SERVER_S)
    if process.returncode != 0 and not out.strip():  # a model whose run failed is a row, not a failure
        message = "\n".join(said.errors) or f"exit code {process.returncode}"
        cause = next((server.error for server in servers if server.error), None)
        raise RunError(f"tetlap {command[1]} failed: {message}", process.returncode, None) from cause
    return json.loads(out)


def compare(scene: Scene, models: Mapping[str, OverlapModel], directory: str | os.PathLike | None = None, *, set: Settings = None,  # noqa: A002
            reference: str | None = None, audit: int | None = None, threads: int | None = None) -> Comparison:
    """Runs a scene with several overlap models; a `Comparison`: a dict of `Compared` by the models' names.

    scene: a scene file's path, or a dict with the same keys (docs/scene.md).
    models: {"clip": "clip", "mine": f}: what each is called, and its name, its file, or a function or torch.nn.Module that takes
        pairs (n, 2, 4, 3) and returns what docs/own_model.md says. Functions are called in threads of this process.
    directory: where a folder for each run is written. Default: out/NAME for a file; for a dict a temporary folder that lives as
        long as the runs.
    reference: the name of the model that the others are compared with; default: the first.
    audit: in every so-many-th step of the reference in contact all models are asked in the same state; 0: never. Default: 10.
    set, threads: as of `tetlap.run`.

    A model whose run fails has the outcome "failed", and what it did up to then.

    RunError: the comparison could not begin; it carries the program's message. What a function raised is its cause.
    """
    if not isinstance(models, Mapping) or not models:
        raise TypeError("models must be a dict, as in {'clip': 'clip', 'mine': f}")
    if reference is not None and reference not in models:
        raise ValueError(f"reference {reference!r} is none of the models: {', '.join(models)}")
    scene, directory, keeper = _place_scene(scene, directory)
    words, servers = _serve(models)
    command = [_locate.program(), "compare", str(scene), "--overlap", ",".join(word.replace(",", "\\,") for word in words), "-o", str(directory), "--json"]
    for text in override_texts(set):
        command += ["--set", text]
    for name, value in (("audit", audit), ("threads", threads), ("reference", reference and words[list(models).index(reference)])):
        if value is not None:
            command += [f"--{name}", str(value)]
    try:
        rows = _execute(command, servers)
    finally:
        for server in servers:
            server.hand_over()
    compared = Comparison()
    compared._directory = directory
    for name, row in zip(models, rows):
        folder = Path(directory, row["model"])
        compared[name] = Compared(name, row, Run(folder, keeper) if folder.is_dir() else None)
    return compared
