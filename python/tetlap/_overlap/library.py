# SPDX-License-Identifier: Apache-2.0
"""The C API, include/tetlap/overlap.h, by ctypes. Nothing is loaded before it is needed."""

from __future__ import annotations

import ctypes
import functools
import os
import weakref
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_int32, c_size_t, c_uint, c_void_p

import numpy as np

from .. import _locate
from .._errors import Error

INVALID, NO_FILE, MEMORY, INTERNAL, DEVICE = 1, 2, 3, 4, 5
VOLUME, GRADIENT, HESSIAN, CENTROID = 1 << 0, 1 << 1, 1 << 2, 1 << 3
_MOST = 2**31 - 1  # pairs in a batch


class _Sized(ctypes.Structure):
    """A struct that carries its size."""

    def __init__(self, **fields):
        super().__init__(size=ctypes.sizeof(type(self)), **fields)


class Options(_Sized):
    _fields_ = [("size", c_size_t), ("model", c_char_p), ("weights", c_char_p), ("threads", c_int)]


class Info(_Sized):
    _fields_ = [("size", c_size_t), ("name", c_char_p), ("description", c_char_p), ("gives", c_uint), ("threads", c_int),
                ("seconds_per_pair", c_double)]


class Batch(_Sized):
    _fields_ = [("size", c_size_t), ("count", c_size_t), ("pairs", c_void_p), ("volume", c_void_p), ("gradient", c_void_p),
                ("hessian", c_void_p), ("centroid", c_void_p), ("direction", c_void_p), ("product", c_void_p),
                ("flags", c_void_p)]


class Mesh(_Sized):
    _fields_ = [("size", c_size_t), ("point_count", c_size_t), ("points", c_void_p), ("tet_count", c_size_t), ("tets", c_void_p)]


class List(ctypes.Structure):
    _fields_ = [("size", c_size_t), ("count", c_size_t), ("first", POINTER(c_int32)), ("second", POINTER(c_int32)),
                ("volume", POINTER(c_double)), ("gradient", POINTER(c_double)), ("centroid", POINTER(c_double)),
                ("flags", POINTER(c_uint)), ("candidates", c_size_t)]


_FUNCTIONS = {
    "version": (c_char_p, []),
    "message": (c_char_p, []),
    "model": (c_char_p, [c_int]),
    "open_with": (c_int, [POINTER(c_void_p), POINTER(Options)]),
    "close": (None, [c_void_p]),
    "info": (c_int, [c_void_p, POINTER(Info)]),
    "eval": (c_int, [c_void_p, POINTER(Batch)]),
    "meshes": (c_int, [c_void_p, POINTER(Mesh), POINTER(Mesh), c_uint, POINTER(POINTER(List))]),
    "list_free": (None, [POINTER(List)]),
}


@functools.lru_cache(maxsize=None)
def _function(name):
    function = getattr(_load(), f"tetlap_overlap_{name}")
    function.restype, function.argtypes = _FUNCTIONS[name]
    return function


@functools.lru_cache(maxsize=None)
def _load():
    path = _locate.library()
    try:
        return ctypes.CDLL(path)
    except OSError as error:
        raise Error(f"the library of overlap volumes cannot be loaded ({error}); build or install tetlap, or name the "
                    "library by TETLAP_LIBRARY") from None


def version():
    """The library's, which is the program's."""
    return _function("version")().decode()


def _call(name, *arguments):
    status = _function(name)(*arguments)
    if status == 0:
        return
    message = _function("message")().decode()
    raise {INVALID: ValueError, NO_FILE: OSError, MEMORY: MemoryError}.get(status, Error)(message)


def _address(array):
    return None if array is None else array.ctypes.data


def _mesh(points, tets):
    return Mesh(point_count=len(points), points=points.ctypes.data, tet_count=len(tets), tets=tets.ctypes.data)


def _copy(pointer, *shape):
    """An array of our own; None of NULL, which an empty list may have."""
    if 0 in shape:
        return np.empty(shape, np.dtype(pointer._type_))
    return np.ctypeslib.as_array(pointer, shape).copy() if pointer else None


class Model:
    """An overlap model, which may be used by several threads at once.

    model: a name (tetlap.models() lists them), or the path of a weights file
    weights: of a learned model, a file or the name of one that ships; None: its own
    threads: how many evaluate a batch; 0: all

    name, description: of the model; has_hessian: whether it gives that
    """

    def __init__(self, model: str | os.PathLike = "clip", *, weights: str | os.PathLike | None = None, threads: int = 0):
        if not isinstance(threads, (int, np.integer)) or threads < 0:
            raise ValueError(f"threads is {threads!r}; expected 0 (all) or how many")
        handle, info = c_void_p(), Info()
        _call("open_with", byref(handle), byref(Options(model=os.fsencode(model), threads=threads,
                                                        weights=None if weights is None else os.fsencode(weights))))
        weakref.finalize(self, _function("close"), handle).atexit = False  # other threads may still use it then
        _call("info", handle, byref(info))
        self._handle = handle
        self.name, self.description = info.name.decode(), info.description.decode()
        self.has_hessian = bool(info.gives & HESSIAN)
        self.threads = info.threads

    def __repr__(self):
        return f"<tetlap.Model {self.name}: {self.description}>"

    def _evaluate(self, pairs, direction, outputs):
        """Fills the arrays of `outputs` (an Overlap), all contiguous, where they are not None."""
        count = pairs.size // 24
        if count > _MOST:
            raise ValueError(f"x has {count} pairs; expected at most {_MOST}")
        _call("eval", self._handle, byref(Batch(
            count=count, pairs=_address(pairs), volume=_address(outputs.volume), gradient=_address(outputs.gradient),
            hessian=_address(outputs.hessian), centroid=_address(outputs.centroid), direction=_address(direction),
            product=_address(outputs.product), flags=_address(outputs.flags))))

    def _evaluate_meshes(self, points_a, tets_a, points_b, tets_b, wanted):
        """Of meshes with int32 vertices: first, second, volume, gradient or None, centroid or None, flags."""
        found = POINTER(List)()
        _call("meshes", self._handle, byref(_mesh(points_a, tets_a)), byref(_mesh(points_b, tets_b)), wanted, byref(found))
        try:
            entries, n = found.contents, found.contents.count
            return (_copy(entries.first, n), _copy(entries.second, n), _copy(entries.volume, n),
                    _copy(entries.gradient, n, 2, 4, 3) if wanted & GRADIENT else None,
                    _copy(entries.centroid, n, 3) if wanted & CENTROID else None, _copy(entries.flags, n))
        finally:
            _function("list_free")(found)


def models() -> list[Model]:
    """The library's models, the fastest first."""
    names, name = [], _function("model")(0)
    while name:
        names.append(name.decode())
        name = _function("model")(len(names))
    return [Model(name) for name in names]
