# SPDX-License-Identifier: Apache-2.0
"""Overlap volumes of arrays of pairs, and of two meshes."""

from __future__ import annotations

import contextlib
import enum
import functools
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Optional

import numpy as np

from . import library as _library

if TYPE_CHECKING:
    import scipy.sparse


class Flag(enum.IntFlag):
    """What a model says of a pair besides its numbers; include/tetlap/overlap.h."""

    DISJOINT = 1 << 0  # no common interior: all outputs are exactly 0
    FLAT = 1 << 1  # a tetrahedron has no volume: all outputs are exactly 0
    FALLBACK = 1 << 2  # answered by a more careful model than the one asked
    ENCLOSED = 1 << 3  # one tetrahedron lies wholly inside the other
    BLENDED = 1 << 4  # answered partly by a more careful model
    NET = 1 << 5  # a TetrahedronPairNet's volume is part of the answer
    BEYOND = 1 << 6  # unlike the pairs that network was trained on


@dataclass(frozen=True)
class Overlap:
    """Of pairs x (…, 2, 4, 3); what was not asked for is None.

    volume: V (…)
    flags: bits of `Flag` (…), uint32
    gradient: dV/dx (…, 2, 4, 3)
    hessian: d²V/dx² (…, 24, 24), symmetric
    product: its product with `vector` (…, 2, 4, 3)
    centroid: of the common part (…, 3)
    """

    volume: np.ndarray
    flags: np.ndarray
    gradient: Optional[np.ndarray] = None
    hessian: Optional[np.ndarray] = None
    product: Optional[np.ndarray] = None
    centroid: Optional[np.ndarray] = None


@functools.lru_cache(maxsize=32)
def _model_of_name(name, threads, _):
    return _library.Model(name, threads=threads)


def _stamp(name):
    """Of the file that a name ends in, so that one which was written anew is read anew; None: it names no file."""
    path = os.fsdecode(name).rpartition("=")[2]
    for file in (path, path.rpartition(":")[0]):
        with contextlib.suppress(OSError):
            known = os.stat(file)
            return known.st_dev, known.st_ino, known.st_mtime_ns, known.st_size
    return None


def _model(model, threads):
    if isinstance(model, _library.Model):
        if threads:
            raise ValueError(f"threads is {threads} beside a tetlap.Model; expected tetlap.Model(…, threads={threads})")
        return model
    if not isinstance(model, (str, os.PathLike)):
        raise TypeError(f"model is {model!r}; expected a name, a file, or a tetlap.Model (a function answers in tetlap.run and tetlap.evaluate)")
    name = os.fspath(model)
    return _model_of_name(name, threads, _stamp(name))


def _check_hessian(model):
    if not model.has_hessian:
        able = [other.name for other in _library.models() if other.has_hessian]
        raise ValueError(f"model '{model.name}' has no hessian; expected one of {', '.join(able)}")


def _real(array, name):
    """As float64, contiguous; the array itself where it is that already."""
    if getattr(array, "requires_grad", False):
        raise TypeError(f"{name} is a tensor that requires grad; expected {name}.detach(), or tetlap.torch.overlap, which goes on with the gradient")
    array = np.asarray(array)
    if array.dtype.kind not in "fiu" or array.dtype.itemsize > 8:
        raise TypeError(f"{name} has dtype {array.dtype}; expected float64, or real numbers that convert to it")
    return np.ascontiguousarray(array, np.float64)


def _pairs(x, name="x"):
    x = _real(x, name)
    if x.shape[-3:] != (2, 4, 3):
        raise ValueError(f"{name} has shape {x.shape}; expected (…, 2, 4, 3): two tetrahedra of four vertices")
    if x.size == 0:
        raise ValueError(f"{name} has shape {x.shape}, no pair at all; expected one at least")
    return x


def _outputs(lead, order, has_product, has_centroid):
    """Shape and dtype of each array of the answer for pairs of this leading shape."""
    shapes = {"volume": (lead, np.float64), "flags": (lead, np.uint32)}
    if order >= 1:
        shapes["gradient"] = (lead + (2, 4, 3), np.float64)
    if order == 2:
        shapes["hessian"] = (lead + (24, 24), np.float64)
    if has_product:
        shapes["product"] = (lead + (2, 4, 3), np.float64)
    if has_centroid:
        shapes["centroid"] = (lead + (3,), np.float64)
    return shapes


def _check_out(out, outputs, *inputs):
    """That C may write into these arrays."""
    if not isinstance(out, Overlap):
        raise TypeError(f"out is a {type(out).__name__}; expected what an earlier tetlap.overlap returned")
    for name in Overlap.__dataclass_fields__:
        array = getattr(out, name)
        if (array is not None) != (name in outputs):
            raise ValueError(f"out has {'no' if array is None else 'a'} {name}; expected the result of a call that asked the same")
        if array is None:
            continue
        shape, dtype = outputs[name]
        if array.shape != shape or array.dtype != dtype or not (array.flags.c_contiguous and array.flags.writeable):
            raise ValueError(f"out.{name} is {array.dtype} of shape {array.shape}; expected {np.dtype(dtype)} of shape {shape}, "
                             "contiguous and writeable")
        if any(given is not None and np.may_share_memory(array, given) for given in inputs):
            raise ValueError(f"out.{name} lies where x or vector does; expected other memory")


def overlap(x: np.ndarray, model: str | os.PathLike | _library.Model = "clip", order: int = 1, *, vector: np.ndarray | None = None,
            centroid: bool = False, threads: int = 0, out: Overlap | None = None) -> Overlap:
    """Overlap volumes of pairs of tetrahedra and their derivatives, an `Overlap`.

    x: vertices (…, 2, 4, 3); float64 without a copy where it is contiguous, other real numbers are converted
    model: a name (tetlap.models() lists them), a weights file, or a tetlap.Model
    order: 0: V; 1: and ∇V; 2: and ∇²V, of models that have it
    vector: (…, 2, 4, 3): also the product of ∇²V with it, without making ∇²V
    centroid: also the centroids of the common parts
    threads: 0: all
    out: what an earlier call with the same shape and wishes returned: its arrays are filled anew and returned

    TypeError, ValueError: wrong dtype, shape or order, no pair, a coordinate that is not finite (the message names the
    pair), an unknown model, or one without what was asked for.
    """
    if order not in (0, 1, 2):
        raise ValueError(f"order is {order!r}; expected 0 (V), 1 (and the gradient) or 2 (and the Hessian)")
    x = _pairs(x)
    if vector is not None:
        vector = _pairs(vector, "vector")
        if vector.shape != x.shape:
            raise ValueError(f"vector has shape {vector.shape}; expected that of x, {x.shape}")
    model = _model(model, threads)
    if order == 2 or vector is not None:
        _check_hessian(model)
    outputs = _outputs(x.shape[:-3], order, vector is not None, centroid)
    if out is None:
        out = Overlap(**{name: np.empty(*shape_and_dtype) for name, shape_and_dtype in outputs.items()})
    else:
        _check_out(out, outputs, x, vector)
    model._evaluate(x, vector, out)
    return out


class MeshPairs(NamedTuple):
    """The pairs of tetrahedra of two meshes that overlap, sorted by i, then j.

    i, j: tetrahedron of the first mesh, of the second (pairs)
    volume: V (pairs)
    gradient: dV/d(vertices) (pairs, 2, 4, 3), or None
    centroid: of what the two share (pairs, 3), or None
    flags: bits of `Flag` (pairs)
    shape: (tetrahedra of the first mesh, of the second)
    """

    i: np.ndarray
    j: np.ndarray
    volume: np.ndarray
    gradient: Optional[np.ndarray]
    centroid: Optional[np.ndarray]
    flags: np.ndarray
    shape: tuple


def _mesh(points, tets, name):
    points, tets = _real(points, f"points_{name}"), np.asarray(tets)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points_{name} has shape {points.shape}; expected (points, 3)")
    if tets.dtype.kind not in "iu":
        raise TypeError(f"tets_{name} has dtype {tets.dtype}; expected integers")
    if tets.ndim != 2 or tets.shape[1] != 4:
        raise ValueError(f"tets_{name} has shape {tets.shape}; expected (tetrahedra, 4)")
    if tets.size == 0:
        raise ValueError(f"tets_{name} has no tetrahedron; expected one at least")
    if tets.min() < 0 or tets.max() >= len(points):
        raise ValueError(f"tets_{name} names vertices {tets.min()} to {tets.max()}; expected 0 to {len(points) - 1}")
    if not np.isfinite(points).all():
        raise ValueError(f"points_{name}[{np.flatnonzero(~np.isfinite(points).all(axis=1))[0]}] is not finite")
    return points, np.ascontiguousarray(tets, np.int32)


def mesh_pairs(points_a: np.ndarray, tets_a: np.ndarray, points_b: np.ndarray, tets_b: np.ndarray, model: str | os.PathLike | _library.Model = "clip",
               order: int = 0, *, centroid: bool = False, threads: int = 0) -> MeshPairs:
    """Which tetrahedra of two meshes overlap and by how much, a `MeshPairs`; order=1: with the gradients.

    points: (points, 3); tets: (tetrahedra, 4), vertices from 0
    """
    if order not in (0, 1):
        raise ValueError(f"order is {order!r}; expected 0 (V) or 1 (and the gradient)")
    model = _model(model, threads)
    a, b = _mesh(points_a, tets_a, "a"), _mesh(points_b, tets_b, "b")
    wanted = _library.VOLUME | (_library.GRADIENT if order else 0) | (_library.CENTROID if centroid else 0)
    found = model._evaluate_meshes(*a, *b, wanted)
    return MeshPairs(*found, (len(a[1]), len(b[1])))


def mesh_overlap(points_a: np.ndarray, tets_a: np.ndarray, points_b: np.ndarray, tets_b: np.ndarray, model: str | os.PathLike | _library.Model = "clip",
                 *, threads: int = 0) -> scipy.sparse.csr_matrix | MeshPairs:
    """The overlap volumes of two meshes, a sparse matrix (tetrahedra of a, of b): scipy.sparse.csr_matrix where SciPy is
    installed, else what `mesh_pairs` gives."""
    pairs = mesh_pairs(points_a, tets_a, points_b, tets_b, model, threads=threads)
    try:
        from scipy import sparse
    except ImportError:
        return pairs
    return sparse.csr_matrix((pairs.volume, (pairs.i, pairs.j)), shape=pairs.shape)
