# SPDX-License-Identifier: Apache-2.0
"""What a notebook shows, and meshes and tables for other packages. Debian 12 has neither pyvista nor what the tests may rely on of meshio and
xarray: stand-ins keep what they are given, in the form that those packages document."""

import importlib.util
import inspect
import os
import sys
import types
import unittest
import unittest.mock
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

import tetlap

SCENE = Path(os.environ["TETLAP_SOURCE_DIR"], "tests", "scenes", "hand.yaml")


class Kept:
    def __init__(self, *values, **named):
        self.values, self.named, self.point_data, self.cell_data = values, named, {}, {}


def stand_in(**names):
    return unittest.mock.patch.dict(sys.modules, {name: types.SimpleNamespace(**what) for name, what in names.items()})


class Views(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_of_hand = tetlap.run({"bodies": [{"name": "block", "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": 1}},
                                                  "material": {"young": 1e5, "poisson": 0.3, "density": 1000}}],
                                      "effects": {"gravity": [0, 0, -9.81]}, "time": {"end": 0.01}, "output": {"frames": 2}})

    def test_a_frame_is_a_mesh_of_meshio(self):
        frame = self.run_of_hand.frames[-1]
        with stand_in(meshio={"Mesh": Kept}):
            mesh = frame.to_meshio()
        points, [(kind, cells)] = mesh.values
        self.assertEqual(kind, "tetra")
        np.testing.assert_array_equal(points, frame.points)
        np.testing.assert_array_equal(cells, frame.cells)
        np.testing.assert_array_equal(mesh.named["cell_data"]["stress"][0], frame["stress"])

    def test_a_frame_is_a_grid_of_pyvista(self):
        frame = self.run_of_hand.frames[-1]
        with stand_in(pyvista={"UnstructuredGrid": Kept}):
            grid = frame.to_pyvista()
        cells, kinds, points = grid.values
        np.testing.assert_array_equal(cells.reshape(-1, 5), np.column_stack([np.full(len(frame.cells), 4), frame.cells]))
        self.assertEqual(kinds.tolist(), [10] * len(frame.cells))
        np.testing.assert_array_equal(points, frame.points)
        np.testing.assert_array_equal(grid.point_data["velocity"], frame["velocity"])

    def test_a_run_is_a_dataset_of_xarray(self):
        with stand_in(xarray={"Dataset": Kept}):
            data = self.run_of_hand.to_xarray()
        (columns,) = data.values
        np.testing.assert_array_equal(data.named["coords"]["time_s"], self.run_of_hand.history["time_s"])
        np.testing.assert_array_equal(columns["total_J"][1], self.run_of_hand.history["total_J"])
        self.assertEqual(columns["points"][1].shape, (3, 8, 3))

    def test_a_body_of_a_simulation_is_a_copy_of_the_present(self):
        with tetlap.Simulation(SCENE, threads=1) as sim, stand_in(meshio={"Mesh": Kept}):
            sim.advance(0.02)
            mesh = sim.bodies["block"].to_meshio()
            points = mesh.values[0].copy()
            sim.advance(0.02)
            np.testing.assert_array_equal(mesh.values[0], points)
            self.assertGreater(np.abs(sim.bodies["block"].points - points).max(), 0)
            self.assertEqual(mesh.named["point_data"]["contact_pressure"].shape, (64,))

    def test_a_missing_package_is_named(self):
        for package, call in (("meshio", self.run_of_hand.frames[0].to_meshio), ("pyvista", self.run_of_hand.frames[0].to_pyvista),
                              ("xarray", self.run_of_hand.to_xarray)):
            with unittest.mock.patch.dict(sys.modules, {package: None}), self.assertRaisesRegex(tetlap.Error, f"needs the package {package}"):
                call()

    def test_a_notebook_shows_the_page_of_a_run_or_a_table(self):
        self.assertIn("<iframe srcdoc=", self.run_of_hand._repr_html_())
        with unittest.mock.patch.dict(os.environ, TETLAP_PROGRAM="/bin/false"):
            table = ElementTree.fromstring(self.run_of_hand._repr_html_())
        shown = {row[0].text: row[1].text for row in table.iter("tr")}
        self.assertEqual((shown["outcome"], shown["frames"], shown["end_time"]), ("finished", "3", "0.01"))
        self.assertLessEqual({"steps", "wall_s", "contact_force_max"}, set(shown))

    def test_a_notebook_shows_what_a_simulation_does_now(self):
        with tetlap.Simulation(SCENE, threads=1) as sim:
            sim.advance(0.05)
            shown = ElementTree.fromstring(f"<p>{sim._repr_html_()}</p>")
            self.assertIn("block, floor", "".join(shown.itertext()))
            # A cube of 3 x 3 x 3 cells has 6 faces of 3 x 3 x 2 triangles.
            self.assertEqual(len(shown.findall(".//polygon")), 108)
        ElementTree.fromstring(sim._repr_html_())

    def test_a_notebook_follows_a_simulation(self):  # a stand-in: Debian's IPython is no requirement
        class Handle:
            def update(self, shown):
                texts.append(shown)

        texts = []
        display = types.SimpleNamespace(HTML=str, display=lambda text, display_id: texts.append(text) or Handle())
        package = types.SimpleNamespace(display=display)
        with unittest.mock.patch.dict(sys.modules, {"IPython": package, "IPython.display": display}), \
                tetlap.Simulation(SCENE, threads=1) as sim:
            self.assertIsInstance(sim.show(every=0), Handle)
            steps = []
            sim.on_step(lambda it: steps.append(it.time))
            sim.advance(0.05)
            self.assertEqual(len(texts), 1 + len(steps))
            self.assertIn(f"t = {steps[-1]:.6g} of", texts[-1])

    def test_a_notebook_shows_a_comparison(self):
        row = {"model": "a<b", "outcome": "finished", "force_error_l2": 0.25}
        shown = ElementTree.fromstring(tetlap.Comparison(x=tetlap.Compared("a<b", row, None))._repr_html_())
        self.assertIn("a<b", "".join(shown.itertext()))
        self.assertIn("0.25", "".join(shown.itertext()))


def find_functions(module):
    """Every public function, method and property of a module, with its name."""
    for name in module.__all__:
        thing = getattr(module, name)
        if not inspect.isclass(thing):
            yield name, thing
        for key, member in vars(thing).items() if inspect.isclass(thing) else ():
            function = member.fget if isinstance(member, property) else member
            if inspect.isfunction(function) and (not key.startswith("_") or key in ("__getitem__", "__setitem__")):
                yield f"{name}.{key}", function


class Help(unittest.TestCase):
    def test_every_public_name_is_described_and_in_the_list_of_the_package(self):
        for name in tetlap.__all__:
            thing = getattr(tetlap, name)
            self.assertTrue(inspect.getdoc(thing), name)
            if inspect.isfunction(thing):
                self.assertIn(name, tetlap.__doc__.replace(",", " ").split())

    def test_every_function_has_a_text_and_types(self):
        modules = [tetlap]
        if importlib.util.find_spec("torch"):
            modules.append(tetlap.torch)
        found = [pair for module in modules for pair in find_functions(module)]
        self.assertGreater(len(found), 60)
        for name, function in found:
            self.assertTrue(function.__doc__ or name.endswith("__setitem__"), name)
            signature = inspect.signature(function)
            self.assertIsNot(signature.return_annotation, signature.empty, f"what {name} returns")
            for key, it in signature.parameters.items():
                self.assertTrue(key == "self" or it.annotation is not it.empty, f"{key} of {name}")


if __name__ == "__main__":
    unittest.main()
