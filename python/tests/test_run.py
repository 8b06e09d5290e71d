# SPDX-License-Identifier: Apache-2.0
"""Runs of the program, and what they wrote."""

import copy
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import unittest.mock
import warnings
from pathlib import Path

import numpy as np

import tetlap
from tetlap import serve

try:
    import torch
except ImportError:
    torch = None

DROP = {
    "time": {"end": 0.1},
    "effects": {"gravity": [0, 0, -9.81]},
    "bodies": [
        {
            "name": "block",
            "mesh": {"box": {"size": [0.2, 0.2, 0.2], "cells": 2}},
            "place": {"translate": [0, 0, 0.005]},
            "material": {"young": 1e5, "poisson": 0.3, "density": 1000},
        }
    ],
    "obstacles": [{"name": "ground", "halfspace": {"point": [0, 0, 0], "normal": [0, 0, 1]}}],
    "contact": {"stiffness": 1e6},
    "output": {"frames": 5},
}

TWO = copy.deepcopy(DROP)
TWO["bodies"].append(dict(DROP["bodies"][0], name="upper", place={"translate": [0.03, 0.02, 0.21]}))
del TWO["contact"]["stiffness"]

ENDLESS = copy.deepcopy(DROP)
ENDLESS["time"] = {"end": 1e3, "max_step": 1e-3}
ENDLESS["output"] = {"frames": 1_000_000}


class RunsOfTheProgram(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.directory = Path(holder.name, "out")

    def test_a_dict_is_a_scene(self):
        run = tetlap.run(DROP, self.directory)
        self.assertEqual(run.outcome, "finished")
        self.assertEqual(len(run.frames), 6)
        np.testing.assert_allclose(run.frames.times, np.linspace(0, 0.1, 6), rtol=1e-14)

    def test_a_function_is_an_overlap_model(self):
        def clip(pairs):
            found = tetlap.overlap(pairs, centroid=True)
            calls.append(len(pairs))
            return {"volume": found.volume, "centroid": found.centroid}

        calls = []
        own = tetlap.run(TWO, self.directory)
        ours = tetlap.run(TWO, self.directory.with_name("ours"), overlap=clip)
        self.assertGreater(sum(calls), 1000)
        self.assertEqual(json.loads(Path(ours.directory, "summary.json").read_text())["overlap"], "clip")
        np.testing.assert_array_equal(ours.frames[-1].points, own.frames[-1].points)

    def test_a_function_of_volumes_alone_runs_with_a_wrapper(self):
        def volumes(pairs):
            return tetlap.overlap(pairs).volume

        ours = tetlap.run(TWO, self.directory, overlap=tetlap.wrapped("placed=", volumes))
        self.assertEqual(json.loads(Path(ours.directory, "summary.json").read_text())["overlap"], "placed=volumes")
        own = tetlap.run(TWO, self.directory.with_name("own"))
        np.testing.assert_array_equal(ours.frames[-1].points, own.frames[-1].points)
        with self.assertRaisesRegex(ValueError, "no wrappers"):
            tetlap.wrapped("placed", volumes)
        with self.assertRaisesRegex(TypeError, "both=clip as one text"):
            tetlap.wrapped("both=", "clip")

    def test_what_the_function_raises_is_the_cause(self):
        def broken(pairs):
            if len(pairs) > 1:
                raise ValueError("no more than one")
            return {"volume": np.zeros(1), "centroid": np.zeros((1, 3))}

        with self.assertRaisesRegex(tetlap.RunError, "(?s)broken.*no more than one") as failed:
            tetlap.run(TWO, self.directory, overlap=broken)
        self.assertIsInstance(failed.exception.__cause__, ValueError)
        with self.assertRaisesRegex(tetlap.RunError, "volume of shape"):
            tetlap.run(TWO, self.directory, overlap=lambda pairs: pairs[0])

    def test_a_function_that_hangs_does_not_hold_the_caller(self):
        def hang(pairs):
            if len(pairs) > 1:
                time.sleep(30)
            return {"volume": np.zeros(1), "centroid": np.zeros((1, 3))}

        with unittest.mock.patch.dict(os.environ, TETLAP_MODEL_SECONDS="0.3"):
            began = time.monotonic()
            with self.assertRaisesRegex(tetlap.RunError, r"hang: the model has not answered within 0\.3 s\. ") as failed:
                tetlap.run(TWO, self.directory, overlap=hang)
        self.assertEqual(failed.exception.code, 69)
        self.assertLess(time.monotonic() - began, 25)

    def test_a_run_is_stopped_while_a_function_computes(self):
        def hang(pairs):
            if len(pairs) > 1:
                is_asked.set()
                time.sleep(30)
            return {"volume": np.zeros(1), "centroid": np.zeros((1, 3))}

        is_asked = threading.Event()
        run = tetlap.run(TWO, self.directory, overlap=hang, on_frame=lambda frame: not is_asked.wait(20))
        self.assertTrue(is_asked.is_set())
        self.assertEqual(run.outcome, "interrupted")

    @unittest.skipUnless(torch, "needs PyTorch")
    def test_a_module_answers_in_evaluation_mode(self):
        layers = torch.nn.Sequential(torch.nn.Flatten(), torch.nn.Linear(24, 64), torch.nn.Dropout(0.5), torch.nn.Linear(64, 1),
                                     torch.nn.Flatten(0))
        model = serve.Model(layers, "layers")
        pairs = np.random.default_rng(1).random((50, 2, 4, 3))
        once, again = (model(pairs, ("gradient",)) for _ in range(2))
        np.testing.assert_array_equal(once["volume"], again["volume"])
        np.testing.assert_array_equal(once["gradient"], again["gradient"])
        self.assertGreater(np.abs(once["gradient"]).min(), 0)

    def test_a_network_of_onnx_needs_its_runtime(self):
        file = self.directory / "net.onnx"
        file.parent.mkdir(exist_ok=True)
        file.write_bytes(b"")
        with unittest.mock.patch.dict(sys.modules, {"onnxruntime": None}), self.assertRaisesRegex(serve.ModelError, "no ONNX Runtime .*python3-onnxruntime"):
            serve.load(str(file))

    def test_arrays_have_the_shapes_of_the_mesh(self):
        frame = tetlap.run(DROP, self.directory).frames[-1]
        self.assertEqual(frame.points.shape, (27, 3))
        self.assertEqual(frame.cells.shape, (48, 4))
        self.assertEqual(frame["velocity"].shape, (27, 3))
        self.assertEqual(frame["stress"].shape, (48, 6))
        self.assertEqual(frame["body"].tolist(), [0] * 48)
        self.assertEqual(frame.obstacles[0].cells.shape[1], 3)

    def test_a_frame_in_pieces_is_that_of_one_file(self):
        whole = tetlap.run(DROP, self.directory / "whole").frames[-1]
        frame = tetlap.run(DROP, self.directory / "pieces", set={"output.pieces": True}).frames[-1]
        self.assertEqual(frame.path.name, "frame_00005.pvtu")
        self.assertEqual(frame.names, whole.names)
        np.testing.assert_array_equal(frame.cells, whole.cells)
        np.testing.assert_array_equal(frame.points, whole.points)
        for name in whole.names:
            np.testing.assert_array_equal(frame[name], whole[name])

    def test_frames_and_history_tell_the_same(self):
        """The centre of mass from the points by hand: elements of one density, a quarter of each to its vertices."""
        run = tetlap.run(DROP, self.directory)
        first = run.frames[0]
        edges = first.points[first.cells[:, 1:]] - first.points[first.cells[:, :1]]
        mass = np.zeros(len(first.points))
        np.add.at(mass, first.cells, np.abs(np.linalg.det(edges))[:, None] / 24)
        points = run.frames.array("points")
        centres = np.einsum("v,fvc->fc", mass / mass.sum(), points)
        for c, axis in enumerate("xyz"):
            np.testing.assert_allclose(run.history[f"centre_block_{axis}_m"], centres[:, c], rtol=1e-12)

    def test_the_body_falls_and_is_held(self):
        run = tetlap.run(DROP, self.directory, set={"time.end": 0.2})
        free = run.history["time_s"] < np.sqrt(2 * 0.005 / 9.81)
        fallen = 0.105 - run.history["centre_block_z_m"]
        np.testing.assert_allclose(fallen[free], 9.81 / 2 * run.history["time_s"][free] ** 2, atol=2e-5)
        self.assertGreater(run.history["force_block_ground_z_N"].max(), 8 * 9.81)

    def test_displacement_is_points_minus_rest(self):
        run = tetlap.run(DROP, self.directory)
        rest = run.frames[0].points - run.frames[0]["displacement"]
        np.testing.assert_allclose(run.frames[3].points, rest + run.frames[3]["displacement"], atol=1e-15)

    def test_values_are_set(self):
        for given in ({"output.frames": 2, "bodies.block.velocity": np.array([0, 0, -1.0])},
                      ["output.frames=2", "bodies.block.velocity=[0, 0, -1]"]):
            run = tetlap.run(DROP, self.directory, set=given)
            self.assertEqual(len(run.frames), 3)
            np.testing.assert_array_equal(run.frames[0]["velocity"], np.tile([0, 0, -1.0], (27, 1)))

    def test_each_frame_is_handed_over_once_and_in_order(self):
        times = []
        run = tetlap.run(DROP, self.directory, on_frame=lambda frame: times.append(frame.time))
        self.assertEqual(times, [frame.time for frame in run.frames])
        again = []
        tetlap.run(DROP, self.directory, set={"output.frames": 2}, on_frame=lambda frame: again.append(frame.time))
        self.assertEqual(len(again), 3)

    def test_a_function_that_returns_false_stops_the_run(self):
        run = tetlap.run(ENDLESS, self.directory, on_frame=lambda frame: frame.time < 0.02)
        self.assertEqual(run.outcome, "interrupted")
        self.assertLess(run.summary["end_time"], 1e3)

    def test_a_function_that_raises_stops_the_run(self):
        def refuse(frame):
            raise LookupError("enough")

        with self.assertRaisesRegex(LookupError, "enough"):
            tetlap.run(ENDLESS, self.directory, on_frame=refuse)
        self.assertEqual(tetlap.read(self.directory).outcome, "interrupted")

    def test_a_run_without_frames_says_that_no_function_was_called(self):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            run = tetlap.run(DROP, self.directory, set={"output.vtu": False}, on_frame=print)
        self.assertIn("on_frame was not called", str(told[0].message))
        self.assertEqual(len(run.frames), 0)
        self.assertEqual(len(run.history), 6)

    def test_an_interrupt_of_python_alone_stops_the_run(self):
        """SIGINT to the Python process only, as an editor or a notebook sends it."""
        self.interrupt(os.kill)

    def test_an_interrupt_of_both_stops_the_run(self):
        """SIGINT to Python and to what it started, as a terminal sends it."""
        self.interrupt(os.killpg)

    def interrupt(self, send):
        Path(self.directory).mkdir()
        scene = self.directory / "endless.json"
        scene.write_text(json.dumps(ENDLESS))
        words = [sys.executable, "-c", "import sys, tetlap; tetlap.run(sys.argv[1], sys.argv[2])", scene, self.directory]
        python = subprocess.Popen(words, stderr=subprocess.PIPE, text=True, start_new_session=True)
        try:
            while not (self.directory / "frames.pvd").exists():
                self.assertIsNone(python.poll(), "the run ended by itself")
                time.sleep(0.02)
            send(python.pid, signal.SIGINT)
            _, told = python.communicate()
        finally:
            python.kill()
        self.assertIn("KeyboardInterrupt", told)
        self.assertEqual(python.returncode, -signal.SIGINT)
        self.assertEqual(tetlap.read(self.directory).outcome, "interrupted")
        # Nobody of that session is left: the run has ended, not only Python.
        with self.assertRaises(ProcessLookupError):
            os.killpg(python.pid, 0)

    def test_a_temporary_folder_lives_as_long_as_its_frames(self):
        frames = tetlap.run(DROP).frames
        folder = frames[0].path.parent
        self.assertEqual(len(frames.array("det_F")), 6)
        del frames
        self.assertFalse(folder.exists())

    def test_meshes_of_a_dict_count_from_the_current_directory(self):
        mesh = Path(os.environ["TETLAP_SOURCE_DIR"], "meshes", "sphere.msh")
        scene = copy.deepcopy(DROP)
        scene["bodies"][0]["mesh"] = os.path.relpath(mesh)
        scene["bodies"][0]["place"] = {"translate": [0, 0, 5]}
        run = tetlap.run(scene, self.directory, set={"time.end": 1e-3})
        self.assertEqual(run.outcome, "finished")


class WhatIsWrong(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.directory = Path(holder.name)

    def test_the_programs_message_and_code_are_raised(self):
        with self.assertRaisesRegex(tetlap.RunError, "unknown key 'en' in time; did you mean 'end'") as caught:
            tetlap.run(DROP, self.directory, set={"time.en": 1})
        self.assertEqual(caught.exception.code, 64)
        with self.assertRaisesRegex(tetlap.RunError, "scene.yaml:1:.*: time.end: expected a number") as caught:
            tetlap.run({**DROP, "time": {"end": -1}}, self.directory)
        self.assertEqual(caught.exception.code, 65)

    def test_a_value_that_no_scene_has_is_named(self):
        with self.assertRaisesRegex(TypeError, r"the scene\.time\.end is a complex; expected"):
            tetlap.run({"time": {"end": 1j}})
        with self.assertRaisesRegex(ValueError, r"the scene\.time\.end is NaN"):
            tetlap.run({"time": {"end": float("nan")}})
        with self.assertRaisesRegex(TypeError, "set is 'a=1'; expected a dict"):
            tetlap.run(DROP, self.directory, set="a=1")

    def test_a_folder_without_a_run_is_refused(self):
        with self.assertRaisesRegex(tetlap.Error, "expected frames.pvd, history.csv or summary.json"):
            tetlap.read(self.directory)
        with self.assertRaisesRegex(FileNotFoundError, "no such folder"):
            tetlap.read(self.directory / "none")

    def test_a_folder_of_another_format_is_refused(self):
        summary = tetlap.run(DROP, self.directory).directory / "summary.json"
        text = summary.read_text()
        for old, found in ((text.replace('"format": 1,', ""), "has no format number"),
                           (text.replace('"format": 1,', '"format": 7,'), "is of format 7")):
            self.assertNotEqual(old, text)
            summary.write_text(old)
            with self.assertRaisesRegex(tetlap.Error, f"summary.json: {found}, expected format 1: use the package"):
                tetlap.read(self.directory)

    def test_a_torn_frame_is_refused(self):
        run = tetlap.run(DROP, self.directory)
        frame = run.frames[0].path
        text = frame.read_text()
        frame.write_text(text[: len(text) // 2])
        with self.assertRaisesRegex(tetlap.Error, "frame_00000.vtu: is no whole XML file"):
            run.frames[0]
        frame.write_text(text.replace("AQAAAAAAAA", "AQAAAAAAAB", 1))
        with self.assertRaisesRegex(tetlap.Error, "frame_00000.vtu: is no frame as tetlap writes it"):
            run.frames[0]

    def test_half_a_line_at_the_end_of_a_history_is_left_out(self):
        history = tetlap.run(DROP, self.directory).directory / "history.csv"
        history.write_text(history.read_text() + "0.12,3")
        self.assertEqual(len(tetlap.read(self.directory).history), 6)

    def wait_for_threads(self):
        for thread in threading.enumerate():
            if thread is not threading.current_thread():
                thread.join(60)  # a function that hangs does so for 30 s

    def test_a_function_leaves_no_file_open_where_there_is_no_program(self):
        self.wait_for_threads()  # of earlier tests, with their files
        before = len(os.listdir("/proc/self/fd")), threading.active_count()
        with unittest.mock.patch.dict(os.environ, TETLAP_PROGRAM=str(self.directory / "none")):
            for _ in range(5):
                with self.assertRaisesRegex(tetlap.Error, "which is no file"):
                    tetlap.run(DROP, self.directory, overlap=print)
        self.wait_for_threads()
        self.assertEqual((len(os.listdir("/proc/self/fd")), threading.active_count()), before)

    def test_a_program_that_is_not_there_is_named(self):
        before = os.environ.get("TETLAP_PROGRAM")
        os.environ["TETLAP_PROGRAM"] = str(self.directory / "none")
        try:
            with self.assertRaisesRegex(tetlap.Error, "TETLAP_PROGRAM names .*none, which is no file"):
                tetlap.run(DROP, self.directory)
        finally:
            del os.environ["TETLAP_PROGRAM"]
            if before is not None:
                os.environ["TETLAP_PROGRAM"] = before


if __name__ == "__main__":
    unittest.main()
