# SPDX-License-Identifier: Apache-2.0
"""A scene given as a dict, as the text of a scene file."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Union

import numpy as np

#: A scene file's path, or a dict with the same keys, docs/scene.md.
Scene = Union[str, "os.PathLike[str]", Mapping]
#: What to change in a scene: {"contact.stiffness": 1e6} or ["contact.stiffness=1e6"].
Settings = Union[Mapping, Iterable[str], None]
#: An overlap model: a name, a weights file, or a function of pairs (n, 2, 4, 3), docs/own_model.md.
OverlapModel = Union[str, "os.PathLike[str]", Callable]


def _number_text(value, where):
    if math.isnan(value):
        raise ValueError(f"{where} is NaN; expected a number")
    if math.isinf(value):
        return ".inf" if value > 0 else "-.inf"
    return repr(value)


def scene_text(value, where="the scene"):
    """YAML's flow style, which is JSON but for infinities. NumPy's arrays and numbers are lists and numbers."""
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise TypeError(f"{where} has the key {key!r}; expected text")
        parts = (f"{json.dumps(key, ensure_ascii=False)}: {scene_text(item, f'{where}.{key}')}" for key, item in value.items())
        return "{" + ", ".join(parts) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(scene_text(item, f"{where}[{i}]") for i, item in enumerate(value)) + "]"
    if isinstance(value, (str, os.PathLike)):
        return json.dumps(os.fspath(value), ensure_ascii=False)
    if value is None or isinstance(value, (bool, int)):
        return json.dumps(value)
    if isinstance(value, float):
        return _number_text(value, where)
    raise TypeError(f"{where} is a {type(value).__name__}; expected a dict, list, text, number, bool or None")


def _from_here(path):
    return os.fspath(Path(path).absolute())


def _solid_with_paths(solid):
    """A body or obstacle whose mesh counts from the current directory."""
    mesh = solid.get("mesh") if isinstance(solid, Mapping) else None
    if isinstance(mesh, (str, os.PathLike)):
        return {**solid, "mesh": _from_here(mesh)}
    if isinstance(mesh, Mapping) and isinstance(mesh.get("file"), (str, os.PathLike)):
        return {**solid, "mesh": {**mesh, "file": _from_here(mesh["file"])}}
    return solid


#: What stands before a model, as in both= and fade:.05=, and NET.safetensors, MINE.so, MINE.py:name: a model that is a file
_WRAPPERS = re.compile(r"(?:(?!exec:|channel:)[a-z0-9-]+(?::[^=/]*)?=)*")
_MODEL_FILE = re.compile(r"(?!exec:)(.*(?:\.safetensors|\.so|\.py(?=:)))(:.*)?", re.S)


def _model_with_path(section, key):
    """A section whose model's file, not name, counts from the current directory."""
    value = section.get(key)
    if isinstance(value, os.PathLike):
        return {**section, key: _from_here(value)}
    if not isinstance(value, str):
        return section
    begin = _WRAPPERS.match(value).end()
    file = _MODEL_FILE.fullmatch(value, begin)
    return {**section, key: value[:begin] + _from_here(file[1]) + (file[2] or "")} if file else section


def _start_with_path(start):
    """The other run's folder, from the current directory."""
    if isinstance(start, (str, os.PathLike)):
        return _from_here(start)
    if isinstance(start, Mapping) and isinstance(start.get("run"), (str, os.PathLike)):
        return {**start, "run": _from_here(start["run"])}
    return start


def with_absolute_paths(scene):
    """The program counts paths from the scene file; those of a dict count from the current directory."""
    result = dict(scene)
    for key in ("bodies", "obstacles"):
        if isinstance(result.get(key), (list, tuple)):
            result[key] = [_solid_with_paths(solid) for solid in result[key]]
    contact = result.get("contact")
    if isinstance(contact, Mapping):
        contact = _model_with_path(contact, "overlap")
        result["contact"] = contact
    if "start" in result:
        result["start"] = _start_with_path(result["start"])
    return result


def override_texts(overrides: Settings) -> list[str]:
    """KEY=VALUE for --set, of a dict or of such texts."""
    if overrides is None:
        return []
    if isinstance(overrides, Mapping):
        return [f"{key}={scene_text(value, key)}" for key, value in overrides.items()]
    if isinstance(overrides, str) or not all(isinstance(text, str) and "=" in text for text in overrides):
        raise TypeError(f"set is {overrides!r}; expected a dict as {{'contact.stiffness': 1e6}}, or a list of 'KEY=VALUE'")
    return list(overrides)
