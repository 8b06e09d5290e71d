# SPDX-License-Identifier: Apache-2.0
"""Frames (.vtu) and their list (.pvd) as the program writes them, docs/output.md, into NumPy arrays.

A data array is base64 text of VTK's header, [blocks, bytes of a block, bytes of a shorter last one, compressed
bytes of each block] as unsigned 64-bit numbers, and then of the blocks, each compressed by zlib.
"""

import base64
import binascii
import struct
import zlib
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from ._errors import Error

_TYPES = {"Float64": "f8", "Float32": "f4", "Int64": "i8", "Int32": "i4", "UInt8": "u1", "UInt64": "u8"}
_CORNERS = {5: 3, 10: 4}  # VTK_TRIANGLE, VTK_TETRA


def _root(path, kind):
    try:
        root = ElementTree.parse(path).getroot()
    except ElementTree.ParseError as error:
        raise Error(f"{path}: is no whole XML file ({error})") from None
    if root.tag != "VTKFile" or root.get("type") != kind:
        raise Error(f"{path}: expected a VTK file of type {kind}")
    return root


def _base64_length(bytes_count):
    return 4 * ((bytes_count + 2) // 3)


def _unpack(text):
    """The bytes of a compressed data array."""
    (blocks,) = struct.unpack("<Q", base64.b64decode(text[:12])[:8])
    header_length = _base64_length(8 * (3 + blocks))
    header = struct.unpack(f"<{3 + blocks}Q", base64.b64decode(text[:header_length]))
    packed, parts, begin = base64.b64decode(text[header_length:]), [], 0
    for size in header[3:]:
        parts.append(zlib.decompress(packed[begin : begin + size]))
        begin += size
    return b"".join(parts)


def _read_array(element):
    components = int(element.get("NumberOfComponents", "1"))
    dtype = np.dtype(_TYPES[element.get("type")])
    text = "".join((element.text or "").split())
    if element.get("format") == "ascii":
        values = np.array(element.text.split(), dtype=dtype)
    elif text:
        values = np.frombuffer(bytearray(_unpack(text)), dtype=dtype.newbyteorder("<")).astype(dtype, copy=False)
    else:
        values = np.empty(0, dtype)
    return values.reshape(-1, components) if components > 1 else values


def _read_section(piece, name):
    section = piece.find(name)
    return {} if section is None else {array.get("Name"): _read_array(array) for array in section}


def _read_piece(root):
    if root.get("byte_order") != "LittleEndian" or root.get("compressor") != "vtkZLibDataCompressor":
        raise ValueError("expected little-endian data compressed by zlib")
    piece, time = root.find("UnstructuredGrid/Piece"), root.find("UnstructuredGrid/FieldData/DataArray")
    if piece is None:
        raise ValueError("expected one piece of an unstructured grid")
    cells = _read_section(piece, "Cells")
    kinds = np.unique(cells["types"])
    if len(kinds) > 1 or (len(kinds) == 1 and int(kinds[0]) not in _CORNERS):
        raise ValueError("expected tetrahedra or triangles alone")
    corners = _CORNERS[int(kinds[0])] if len(kinds) else 4
    return {
        "time": None if time is None else float(time.text),
        "points": _read_section(piece, "Points")["Points"],
        "cells": cells["connectivity"].reshape(-1, corners),
        "point_data": _read_section(piece, "PointData"),
        "cell_data": _read_section(piece, "CellData"),
    }


def _take_numbers(piece):
    """The numbers of a piece's vertices and elements in the whole."""
    return piece["point_data"].pop("vertex"), piece["cell_data"].pop("element")


def _place(parts, numbers):
    """What each part has at its numbers."""
    whole = np.empty((1 + max(own.max(initial=-1) for own in numbers), *parts[0].shape[1:]), parts[0].dtype)
    for part, own in zip(parts, numbers):
        whole[own] = part
    return whole


def _join(pieces):
    numbers = [_take_numbers(piece) for piece in pieces]
    vertices, elements = [own for own, _ in numbers], [own for _, own in numbers]
    if any(len(np.unique(np.concatenate(own))) != 1 + max(part.max(initial=-1) for part in own)
           for own in (vertices, elements)):
        raise ValueError("vertices or elements are in none of the pieces")
    return {
        "time": pieces[0]["time"],
        "points": _place([piece["points"] for piece in pieces], vertices),
        "cells": _place([own[piece["cells"]] for piece, own in zip(pieces, vertices)], elements),
        "point_data": {name: _place([piece["point_data"][name] for piece in pieces], vertices)
                       for name in pieces[0]["point_data"]},
        "cell_data": {name: _place([piece["cell_data"][name] for piece in pieces], elements)
                      for name in pieces[0]["cell_data"]},
    }


def _read_pieces(path):
    sources = [piece.get("Source") for piece in _root(path, "PUnstructuredGrid").iter("Piece")]
    if not sources or any(source is None or "/" in source for source in sources):
        raise ValueError("expected pieces beside the list")
    return _join([_read_piece(_root(Path(path).with_name(source), "UnstructuredGrid")) for source in sources])


def read_vtu(path):
    """time (or None), points (n, 3), cells (m, 4) or (m, 3), point_data and cell_data by name, in a dict; also of a
    frame in pieces (.pvtu)."""
    try:
        return _read_pieces(path) if Path(path).suffix == ".pvtu" else _read_piece(_root(path, "UnstructuredGrid"))
    except (ValueError, KeyError, IndexError, struct.error, binascii.Error, zlib.error) as error:
        raise Error(f"{path}: is no frame as tetlap writes it: {error}") from None


def read_pvd(path):
    """For each time (time, [file of the bodies, files of obstacles …])."""
    times = []
    for entry in _root(path, "Collection").iter("DataSet"):
        time, part = float(entry.get("timestep")), int(entry.get("part", "0"))
        if part == 0:
            times.append((time, []))
        if not times or part != len(times[-1][1]):
            raise Error(f"{path}: expected the same parts at every time, in order")
        times[-1][1].append(entry.get("file"))
    return times
