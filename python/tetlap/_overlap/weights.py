# SPDX-License-Identifier: Apache-2.0
"""Weights files of tetlap's networks: safetensors whose metadata say what the network is (docs/networks.md)."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from .. import _locate
from .._errors import Error

_FORMAT, _VERSION = "tetlap-net", 1
_TYPES = {"F32": np.dtype("<f4"), "F64": np.dtype("<f8")}
_NAMES = {kind: name for name, kind in _TYPES.items()}
_MOST_HEADER = 1 << 24  # bytes
_TEXTS = ("normalisation", "range", "provenance")


class Weights(dict):
    """A network's tensors by name, NumPy arrays; `BLOCK.LAYER.weight` (outputs, inputs), `BLOCK.LAYER.bias` (outputs), as in torch.nn.Linear.

    shape: a dict that determines the layers (docs/networks.md)
    normalisation, range, provenance: texts: what is done to a pair before, which pairs it was trained on, how it came to be
    """

    def __init__(self, tensors, shape, normalisation="", range="", provenance=""):  # noqa: A002: as the file calls it
        super().__init__(tensors)
        self.shape, self.normalisation, self.range, self.provenance = shape, normalisation, range, provenance

    def __repr__(self):
        return f"<Weights of {self.shape.get('kind')}: {sum(tensor.size for tensor in self.values())} numbers, {self.normalisation}>"


def _locate_weights(path):
    path = Path(path)
    if path.suffix == "" and not path.exists():  # the name of a network that ships
        for folder in (Path(_locate.program()).parent / "share" / "tetlap", Path(_locate.program()).parents[1] / "share" / "tetlap",
                       Path(__file__).resolve().parents[3]):
            shipped = folder / "net" / "weights" / f"{path}.safetensors"
            if shipped.is_file():
                return shipped
    return path


def _read_header(path, data):
    size = int.from_bytes(data[:8], "little")
    if len(data) < 8 or size > min(len(data) - 8, _MOST_HEADER):
        raise Error(f"{path}: is no safetensors file: the header's length does not fit the file")
    try:
        header = json.loads(data[8 : 8 + size])
        card = header.pop("__metadata__")
        name, _, version = card["format"].rpartition(" ")
        version, card["shape"] = int(version), json.loads(card["shape"])
    except (ValueError, KeyError, AttributeError, TypeError):
        raise Error(f"{path}: is no weights file of tetlap: its metadata have no format or no shape; tetlap.write_weights writes one") from None
    if name != _FORMAT:
        raise Error(f"{path}: is of format {card['format']!r}, expected '{_FORMAT} {_VERSION}'")
    if version > _VERSION:
        raise Error(f"{path}: is of version {version} of the format, this package reads up to {_VERSION}: take the package of the program that wrote it")
    return header, card, 8 + size


def read_weights(path: str | os.PathLike) -> Weights:
    """A network of tetlap's: a weights file, as `tetlap train` and `write_weights` write it, or the name of one that ships.

    `torch.from_numpy` takes its arrays. Error: no such file, no weights file, or of a newer version.
    """
    path = _locate_weights(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise Error(f"{path}: {error.strerror}") from None
    header, card, start = _read_header(path, data)
    tensors = {}
    for name, entry in header.items():
        try:
            begin, end = entry["data_offsets"]
            tensors[name] = np.frombuffer(data[start + begin : start + end], _TYPES[entry["dtype"]]).reshape(entry["shape"]).copy()
        except (KeyError, TypeError, ValueError):
            raise Error(f"{path}: tensor {name} is damaged") from None
    return Weights(tensors, card["shape"], **{key: card.get(key, "") for key in _TEXTS})


def _as_array(name, value):
    if hasattr(value, "detach"):
        value = value.detach().cpu().numpy()
    value = np.asarray(value)
    if value.dtype.newbyteorder("<") not in _NAMES:
        raise TypeError(f"tensor {name} is of {value.dtype}; expected float32 or float64")
    if value.ndim > 2:
        raise ValueError(f"tensor {name} has the shape {value.shape}; expected one or two dimensions")
    if not np.isfinite(value).all():
        raise ValueError(f"tensor {name} has a number that is not finite")
    return np.ascontiguousarray(value.astype(value.dtype.newbyteorder("<"), copy=False))


def write_weights(path: str | os.PathLike, tensors: Mapping, shape: Mapping | None = None, *, normalisation: str | None = None,
                  range: str | None = None, provenance: str | None = None) -> None:  # noqa: A002: as the file calls it
    """Writes a network as a weights file, which a scene then names as its overlap model. It is there whole, or not at all.

    tensors: arrays or torch tensors by the names that the shape asks for: `Weights`, or a state_dict.
    shape, normalisation, range, provenance: as of `Weights`; default: what `tensors` has, if it is one.

    TypeError, ValueError: a tensor of another type, shape, or not finite. Whether the tensors are those of the shape, the program says when it reads the file.
    """
    shape = shape if shape is not None else getattr(tensors, "shape", None)
    if not isinstance(shape, Mapping):
        raise TypeError("shape must be a dict, as read_weights(path).shape")
    given = {"normalisation": normalisation, "range": range, "provenance": provenance}
    card = {"format": f"{_FORMAT} {_VERSION}", "shape": json.dumps(shape, separators=(",", ":"))}
    for key, text in given.items():
        card[key] = text if text is not None else getattr(tensors, key, "")
    header, parts, at = {"__metadata__": card}, [], 0
    for name, value in tensors.items():
        value = _as_array(name, value)
        header[name] = {"dtype": _NAMES[value.dtype], "shape": list(value.shape), "data_offsets": [at, at + value.nbytes]}
        parts.append(value.tobytes())
        at += value.nbytes
    text = json.dumps(header, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 8)
    path = Path(path)
    with tempfile.NamedTemporaryFile(dir=path.parent, prefix=path.name, delete=False) as file:
        try:
            file.write(len(text).to_bytes(8, "little") + text + b"".join(parts))
            file.flush()
            os.chmod(file.name, 0o644)
            os.replace(file.name, path)
        except BaseException:
            os.unlink(file.name)
            raise
