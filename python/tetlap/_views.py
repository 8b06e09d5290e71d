# SPDX-License-Identifier: Apache-2.0
"""What a notebook shows, and meshes and tables as other packages have them."""

from __future__ import annotations

import html
from importlib import import_module

import numpy as np

from ._errors import Error

_VTK_TRIANGLE, _VTK_TETRA = 5, 10


def need(package: str):
    """A package that is not tetlap's own requirement."""
    try:
        return import_module(package)
    except ImportError as error:
        raise Error(f"this needs the package {package}, which cannot be imported ({error}); install it, as by `pip install {package}`") from None


def table_html(title, rows):
    """Rows of (what, value)."""
    cells = "".join(f"<tr><th style='text-align:left'>{html.escape(str(name))}</th><td style='text-align:left'>{html.escape(str(value))}</td></tr>"
                    for name, value in rows)
    return f"<div><b>{html.escape(title)}</b><table>{cells}</table></div>"


def grid_html(title, names, rows):
    """A table with a line of names."""
    head = "".join(f"<th>{html.escape(str(name))}</th>" for name in names)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(str(value))}</td>" for value in row) + "</tr>" for row in rows)
    return f"<div><b>{html.escape(title)}</b><table><tr>{head}</tr>{body}</table></div>"


def page_html(page, height=640):
    """A whole page within a notebook's."""
    return f"<iframe srcdoc=\"{html.escape(page)}\" style='width:100%;height:{height}px;border:0'></iframe>"


def digits(value):
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)


def outline_svg(points, tets, colours, size=320):
    """The surface of tetrahedra seen from the front (x to the right, z up), the far triangles first; colours in [0, 1] of vertices."""
    faces = np.concatenate([tets[:, order] for order in ([1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1])])
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    faces = faces[first[count == 1]]
    faces = faces[np.argsort(-points[faces, 1].mean(axis=1))]
    flat = points[:, [0, 2]]
    low, width = flat.min(axis=0), max(np.ptp(flat, axis=0).max(), 1e-300)
    x, y = ((flat - low) / width * size).T
    triangles = "".join(f"<polygon points='{' '.join(f'{x[v]:.1f},{size - y[v]:.1f}' for v in face)}' "
                        f"fill='hsl({220 - 220 * colours[face].mean():.0f},60%,60%)' stroke='#0003'/>" for face in faces)
    return f"<svg width='{size}' height='{size}' viewBox='-2 -2 {size + 4} {size + 4}'>{triangles}</svg>"


def show_html(text, handle=None):
    """Shows it in a notebook; in the place of what the handle showed before. The display handle."""
    need("IPython")
    display = import_module("IPython.display")
    if handle is None:
        return display.display(display.HTML(text), display_id=True)
    handle.update(display.HTML(text))
    return handle


def to_meshio(points, cells, point_data, cell_data):
    kind = "tetra" if cells.shape[1] == 4 else "triangle"
    return need("meshio").Mesh(points, [(kind, cells)], point_data=point_data, cell_data={name: [values] for name, values in cell_data.items()})


def to_pyvista(points, cells, point_data, cell_data):
    lines = np.column_stack([np.full(len(cells), cells.shape[1]), cells]).ravel()
    kinds = np.full(len(cells), _VTK_TETRA if cells.shape[1] == 4 else _VTK_TRIANGLE, np.uint8)
    grid = need("pyvista").UnstructuredGrid(lines, kinds, points)
    for name, values in point_data.items():
        grid.point_data[name] = values
    for name, values in cell_data.items():
        grid.cell_data[name] = values
    return grid
