# SPDX-License-Identifier: Apache-2.0
"""The folder of arrays that `tetlap.map` fills: a row an item.

    map.json         format, count, what the rows depend on, and the fields with dtype and shape
    status.npy       of each item: 0 waiting, 1 good, 2 failed; written after the rows that it is about
    keys.npy         of each item: a digest
    NAME.npy         a field, a row an item: (count, …); NaN, or 0 of integers, where the status is not 1
    failures.jsonl   a line a failure: index, kind, message
"""

from __future__ import annotations

import fcntl
import json
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ._errors import Error, UnknownNameError

_FORMAT = "tetlap-map 1"
_WAITING, _GOOD, _FAILED = 0, 1, 2
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_TAKEN = ("status", "keys", "map", "failures")


@dataclass(frozen=True)
class Failure:
    """An item of `tetlap.map` that has no result.

    index: the item's number
    kind: the exception's class, as "RunError"
    message: what it said
    """

    index: int
    kind: str
    message: str


def _replace(path, write):
    """A file that appears whole or not at all."""
    beside = path.with_name(path.name + ".part")
    with open(beside, "wb") as file:
        write(file)
        file.flush()
        os.fsync(file.fileno())
    os.replace(beside, path)


def _read_about(directory):
    path = directory / "map.json"
    try:
        about = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    except ValueError as error:
        raise Error(f"{path}: is no JSON ({error})") from None
    found = about.get("format") if isinstance(about, dict) else None
    if found != _FORMAT:
        raise Error(f"{path}: is of format {found!r}, expected {_FORMAT!r}: use the package that wrote it")
    return about


def _read_failures(directory, status):
    """Of every item whose status says so. A line that is not whole, which a kill may leave, is nobody's."""
    found = {}
    path = directory / "failures.jsonl"
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        try:
            failure = Failure(**json.loads(line))
        except (ValueError, TypeError):
            continue
        found[failure.index] = failure
    return [found.get(index, Failure(index, "Error", f"{path} does not say why")) for index in np.flatnonzero(status == _FAILED).tolist()]


def _empty(shape, dtype):
    return np.full(shape, np.nan, dtype) if dtype.kind in "fc" else np.zeros(shape, dtype)


def as_row(result):
    """What a function returned, as arrays by name."""
    if not isinstance(result, Mapping) or not result:
        raise TypeError(f"the function returned {type(result).__name__}; expected a dict of numbers and arrays by name")
    row = {}
    for name, value in result.items():
        if not isinstance(name, str) or not _NAME.fullmatch(name) or name in _TAKEN:
            raise ValueError(f"the function returned the name {name!r}; expected letters, digits and '_', and none of {', '.join(_TAKEN)}")
        array = np.array(value)
        if array.dtype.kind not in "biufc":
            raise TypeError(f"the function returned as {name!r} what is no array of numbers: {array.dtype}")
        row[name] = array
    return row


class Table:
    """The writing end. One process at a time; `close` lets go."""

    def __init__(self, directory, keys, origin):
        self._directory = Path(directory)
        self._directory.mkdir(parents=True, exist_ok=True)
        if not (self._directory / "map.json").exists() and any(path.name != "lock" for path in self._directory.iterdir()):
            raise Error(f"{self._directory}: is not empty and has no map.json; name a folder of its own")
        self._lock = open(self._directory / "lock", "w")  # noqa: SIM115: held until close
        try:
            self._claim()
            self._open(keys, origin)
        except BaseException:
            self.close()
            raise

    def _claim(self):
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise Error(f"{self._directory}: another process fills this folder now") from None

    def _open(self, keys, origin):
        keys = np.array(keys, "S32")
        about = _read_about(self._directory)
        if about is None or about["count"] == 0:
            about = {"format": _FORMAT, "count": 0, "origin": origin, "fields": {}}
        else:
            self._check(about, keys, origin)
        self.about = about
        self._write_about()  # before all else: a folder with other files and without it is somebody else's
        self._grow(keys)
        self.status = np.lib.format.open_memmap(self._directory / "status.npy", "r+")[: len(keys)]  # longer, if a kill stopped _grow
        self._fields = {name: np.lib.format.open_memmap(self._directory / f"{name}.npy", "r+") for name in about["fields"]}

    def _check(self, about, keys, origin):
        for what, value in origin.items():
            if about["origin"].get(what, value) != value:
                raise ValueError(f"{self._directory}: its results are of another {what}: name another folder, or remove this one")
        before = np.load(self._directory / "keys.npy")[: about["count"]]
        if len(keys) < len(before) or (keys[: len(before)] != before).any():
            raise ValueError(f"{self._directory}: its results are of other items: they may only be continued by more at the end; "
                             "name another folder, or remove this one")

    def _grow(self, keys):
        """To as many rows; the count is written last, so that a kill between leaves what is done again."""
        count = len(keys)
        if self.about["count"] < count:
            _replace(self._directory / "keys.npy", lambda file: np.save(file, keys))
            for name, (dtype, shape) in {"status": ("u1", []), **self.about["fields"]}.items():
                path = self._directory / f"{name}.npy"
                rows = _empty((count, *shape), np.dtype(dtype))
                if path.exists():
                    old = np.load(path, mmap_mode="r")[: self.about["count"]]
                    rows[: len(old)] = old
                _replace(path, lambda file, rows=rows: np.save(file, rows))
            self.about["count"] = count
        self._write_about()

    def _write_about(self):
        _replace(self._directory / "map.json", lambda file: file.write(json.dumps(self.about, indent=1).encode() + b"\n"))

    def _add_fields(self, row):
        fields = {name: (array.dtype.str, list(array.shape)) for name, array in row.items()}
        for name, (dtype, shape) in fields.items():
            _replace(self._directory / f"{name}.npy",
                     lambda file, dtype=dtype, shape=shape: np.save(file, _empty((len(self.status), *shape), np.dtype(dtype))))
        self.about["fields"] = fields
        self._write_about()
        self._fields = {name: np.lib.format.open_memmap(self._directory / f"{name}.npy", "r+") for name in fields}

    def _check_row(self, row):
        if set(row) != set(self._fields):
            raise ValueError(f"the function returned {', '.join(sorted(row))}; the first result had {', '.join(sorted(self._fields))}")
        for name, array in row.items():
            field = self._fields[name]
            if array.shape != field.shape[1:] or not np.can_cast(array.dtype, field.dtype, "same_kind"):
                raise ValueError(f"the function returned {name!r} as {array.dtype} of shape {array.shape}; the first result had "
                                 f"{field.dtype} of shape {field.shape[1:]}")

    def put(self, index, row):
        """The row of an item; it counts from the next `commit` on. ValueError: it is not like the rows before."""
        if not self._fields:
            self._add_fields(row)
        self._check_row(row)
        for name, array in row.items():
            self._fields[name][index] = array

    def commit(self, good, failures):
        """Rows first, then the status that makes them count."""
        for field in self._fields.values():
            field.flush()
        if failures:
            with open(self._directory / "failures.jsonl", "a", encoding="utf-8") as file:
                for failure in failures:
                    file.write(json.dumps(failure.__dict__) + "\n")
                file.flush()
                os.fsync(file.fileno())
        self.status[[failure.index for failure in failures]] = _FAILED
        self.status[good] = _GOOD
        self.status.flush()

    def find_waiting(self, again=False):
        """Numbers of the items to be run, those that failed among them if `again`."""
        return [int(index) for index in np.flatnonzero(self.status != _GOOD if again else self.status == _WAITING)]

    def close(self):
        self._lock.close()


class Results(Sequence):
    """What `tetlap.map` has put into a folder: the good results, in the order of the items, as arrays.

        results = tetlap.Results("out/fingers")
        results["force"]                        # of all good ones, (n, 3)
        results[0]                              # {"force": (3), "pressure": (13, 13), …} of the first good one
        torch.utils.data.DataLoader(results, batch_size=64, shuffle=True, num_workers=2)

    It is what a DataLoader of PyTorch takes (`len` and numbers), and reads a row from its file when it is asked for. Failed items are in
    `failures`, never among the rows. What a map that goes on adds later is seen by opening the folder anew.

    directory: the folder
    count: of the items, whatever became of them
    index: numbers of the items that are good, (n)
    fields: names of the arrays
    failures: a list of Failure
    """

    def __init__(self, directory: str | os.PathLike, keeper=None):
        self.directory, self._keeper = Path(directory), keeper
        about = _read_about(self.directory)
        if about is None:
            raise FileNotFoundError(f"{directory}: has no map.json; expected a folder that tetlap.map wrote")
        begun = (self.directory / "status.npy").exists()
        status = np.load(self.directory / "status.npy")[: about["count"]] if begun else np.zeros(0, np.uint8)
        self.count: int = about["count"]
        self.index: np.ndarray = np.flatnonzero(status == _GOOD)
        self.fields: tuple[str, ...] = tuple(about["fields"])
        self.failures: list[Failure] = _read_failures(self.directory, status)
        self._waiting = int((status == _WAITING).sum())
        self._arrays = {name: np.load(self.directory / f"{name}.npy", mmap_mode="r") for name in self.fields}

    @property
    def waiting(self) -> int:
        """How many items have not been run yet."""
        return self._waiting

    def __len__(self) -> int:
        return len(self.index)

    def __getitem__(self, which: str | int | slice) -> np.ndarray | dict[str, np.ndarray] | list[dict[str, np.ndarray]]:
        """A field of all good results by its name, (n, …), read-only; or one result by its number, a dict of arrays."""
        if isinstance(which, str):
            return self._field(which)
        if isinstance(which, slice):
            return [self[k] for k in range(*which.indices(len(self)))]
        row = self.index[which]
        return {name: np.array(array[row]) for name, array in self._arrays.items()}

    def _field(self, name):
        if name not in self._arrays:
            raise UnknownNameError(f"there is no field {name!r}; there is {', '.join(self.fields) or 'none'}")
        array = self._arrays[name]
        if len(self.index) == len(array):
            return array
        return array[self.index]

    def __iter__(self) -> Iterator[dict[str, np.ndarray]]:
        return (self[k] for k in range(len(self)))

    def __reduce__(self):  # for the processes of a DataLoader: opened there
        return Results, (self.directory, self._keeper)

    def __repr__(self):
        return (f"<Results {os.fspath(self.directory)}: {len(self)} good, {len(self.failures)} failed, {self._waiting} waiting; "
                f"{', '.join(self.fields) or 'no fields'}>")
