# SPDX-License-Identifier: Apache-2.0
"""Many runs side by side, and the folder of arrays that they fill."""

import functools
import json
import logging
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import textwrap
import threading
import time
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

import tetlap

try:
    import torch
except ImportError:
    torch = None

SCENE = Path(os.environ["TETLAP_SOURCE_DIR"], "tests", "scenes", "hand.yaml")


def press(sim, p):
    sim.drive.set("plate", [0, 0, -0.01 * p["depth"]], ramp=0.02)
    sim.advance(0.02)
    return {"force": sim.contacts["block", "floor"].force, "points": sim.bodies["block"].points, "depth": p["depth"]}


def fail_at_two(sim, p):
    if p["depth"] == 2:
        sim.drive["nobody"] = [0, 0, 0]
    return press(sim, p)


PARAMETERS = [{"depth": float(k)} for k in range(5)]


class InFolder(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name, "results")


class Maps(InFolder):
    def test_results_are_rows_whatever_the_number_of_processes(self):
        one = tetlap.map(PARAMETERS, press, scene=SCENE, processes=1, threads=1)
        many = tetlap.map(PARAMETERS, press, self.folder, scene=SCENE, processes=3, threads=1)
        self.assertEqual((len(many), many.count, many.waiting, many.failures), (5, 5, 0, []))
        self.assertEqual(many["points"].shape, (5, 64, 3))
        for name in many.fields:
            np.testing.assert_array_equal(one[name], many[name])
        np.testing.assert_array_equal(many["depth"], np.arange(5.0))
        with tetlap.Simulation(SCENE, threads=1) as sim:
            sim.state()  # as a map begins: the integrator anew
            np.testing.assert_array_equal(press(sim, PARAMETERS[3])["points"], many[3]["points"])
        self.assertGreater(np.abs(np.diff(many["points"], axis=0)).max(), 1e-6)
        self.assertTrue((many["force"][:, 2] > 0).all(), "the block stands on the floor")

    def test_items_may_be_scenes_or_give_them(self):
        def height(sim, _):
            return {"height": sim.bodies["block"].points[:, 2].max()}

        def scene(size):
            return {"bodies": [{"name": "block", "mesh": {"box": {"size": [0.1, 0.1, size], "cells": 1}},
                                "material": {"young": 1e5, "poisson": 0.3, "density": 1000}}], "time": {"end": 1}}

        self.assertEqual(tetlap.map([scene(0.1), scene(0.2)], height)["height"].tolist(), [0.1, 0.2])
        self.assertEqual(tetlap.map([0.1, 0.2], height, scene=scene)["height"].tolist(), [0.1, 0.2])
        self.assertEqual(len(tetlap.map([SCENE], height, set={"time.end": 0.1})), 1)

    def test_callbacks_of_one_item_do_not_meet_the_next(self):
        times = []

        def watched(sim, p):
            begin = len(times)
            sim.on_step(lambda it: times.append(it.time))
            press(sim, p)
            return {"steps": len(times) - begin}

        results = tetlap.map(PARAMETERS[:1] * 3, watched, scene=SCENE, processes=1)
        self.assertGreater(results["steps"][0], 0)
        self.assertEqual(len(set(results["steps"].tolist())), 1)

    def test_a_failed_item_is_kept_apart_and_told(self):
        with self.assertLogs("tetlap", "WARNING") as said:
            results = tetlap.map(PARAMETERS, fail_at_two, self.folder, scene=SCENE)
        self.assertIn("item 2 failed: UnknownNameError", said.output[0])
        self.assertEqual(results.index.tolist(), [0, 1, 3, 4])
        self.assertEqual(results["depth"].tolist(), [0, 1, 3, 4])
        (failure,) = results.failures
        self.assertEqual((failure.index, failure.kind), (2, "UnknownNameError"))
        self.assertIn("'plate'", failure.message)
        self.assertTrue(np.isnan(np.load(self.folder / "force.npy")[2]).all())
        self.assertEqual(np.load(self.folder / "status.npy").tolist(), [1, 1, 2, 1, 1])

    def test_a_lost_program_is_a_failure_and_the_next_item_has_a_new_one(self):
        def lose(sim, p):
            if p["depth"] == 1:
                sim._channel._process.kill()
            return press(sim, p)

        with self.assertLogs("tetlap", "WARNING"):
            results = tetlap.map(PARAMETERS[:3], lose, scene=SCENE, processes=1)
        self.assertEqual(results.index.tolist(), [0, 2])
        self.assertIn("killed by signal 9", results.failures[0].message)

    def test_it_goes_on_where_it_was_and_takes_more_items(self):
        calls = []

        def counted(sim, p):
            calls.append(p["depth"])
            if p["depth"] == 1 and len(calls) < 5:
                raise ArithmeticError("not today")
            return press(sim, p)

        with self.assertLogs("tetlap", "WARNING"):
            first = tetlap.map(PARAMETERS[:2], counted, self.folder, scene=SCENE)
        before = first[0]
        with self.assertNoLogs("tetlap", "WARNING"):
            more = tetlap.map(PARAMETERS[:3], counted, self.folder, scene=SCENE)
        self.assertEqual(sorted(calls), [0, 1, 2])
        self.assertEqual((more.index.tolist(), [failure.index for failure in more.failures]), ([0, 2], [1]))
        np.testing.assert_array_equal(more[0]["points"], before["points"])
        calls += [0, 0]
        again = tetlap.map(PARAMETERS[:3], counted, self.folder, scene=SCENE, again=True)
        self.assertEqual((again.index.tolist(), again.failures, calls[5:]), ([0, 1, 2], [], [1]))

    def test_a_result_unlike_the_first_fails(self):
        def odd(_, p):
            return {"a": np.zeros(3 if p == 1 else 2)} if p < 2 else {"b": 1} if p < 3 else 7

        with self.assertLogs("tetlap", "WARNING"):
            results = tetlap.map(range(4), odd, scene=SCENE, processes=1)
        self.assertEqual(results.index.tolist(), [0])
        for failure, words in zip(results.failures, (r"of shape (3,)", "the first result had a", "expected a dict")):
            self.assertIn(words, failure.message)

    def test_a_dataset_of_pytorch(self):
        results = pickle.loads(pickle.dumps(tetlap.map(PARAMETERS, press, self.folder, scene=SCENE)))
        self.assertEqual([row["depth"].item() for row in results], [0, 1, 2, 3, 4])
        self.assertTrue(results[1]["force"].flags.writeable)
        if torch is None:
            self.skipTest("no python3-torch: a loader is not tried")
        for workers in 0, 2:
            loader = torch.utils.data.DataLoader(results, batch_size=2, num_workers=workers)
            batches = list(loader)
            self.assertEqual([batch["depth"].tolist() for batch in batches], [[0, 1], [2, 3], [4]])
            self.assertEqual(batches[0]["points"].shape, (2, 64, 3))


ENDLESS = """
import os, sys, tetlap
def f(sim, k):
    if k >= 2:
        os.write(1, b"%d\\n" % sim._channel._process.pid)
        while True:
            sim.restore(begin := sim.state()); sim.advance(0.01); sim.restore(begin)
    return {"k": float(k)}
tetlap.map(range(6), f, sys.argv[1], scene=sys.argv[2], processes=2)
"""


class Ends(InFolder):
    def begin(self):
        child = subprocess.Popen([sys.executable, "-c", textwrap.dedent(ENDLESS), str(self.folder), str(SCENE)], text=True,
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        for end in child.stdout.close, child.stderr.close, child.wait, child.kill:  # the last first
            self.addCleanup(end)
        programs = [int(child.stdout.readline()) for _ in range(2)]
        return child, programs

    def assert_ended(self, programs):
        end = time.monotonic() + 20
        while any(Path(f"/proc/{pid}").exists() for pid in programs) and time.monotonic() < end:
            time.sleep(0.02)
        self.assertFalse([pid for pid in programs if Path(f"/proc/{pid}").exists()])

    def test_ctrl_c_ends_all_and_leaves_whole_rows(self):
        child, programs = self.begin()
        end = time.monotonic() + 30
        while tetlap.Results(self.folder).waiting > 4 and time.monotonic() < end:  # until the two that ended are written
            time.sleep(0.05)
        child.send_signal(signal.SIGINT)
        self.assertEqual(child.wait(30), -signal.SIGINT)
        self.assertIn("KeyboardInterrupt", child.stderr.read())
        self.assert_ended(programs)
        results = tetlap.Results(self.folder)
        self.assertEqual((results["k"].tolist(), results.waiting, results.failures), ([0, 1], 4, []))

    def test_after_a_kill_what_was_not_committed_is_waiting(self):
        child, programs = self.begin()
        child.kill()
        child.wait()
        self.assert_ended(programs)
        results = tetlap.Results(self.folder)
        self.assertEqual(len(results) + results.waiting, 6)
        self.assertTrue(set(results.index) <= {0, 1})

    def test_a_row_that_the_stop_cut_short_does_not_count(self):
        entered = threading.Event()

        def endure(sim, k):
            if k == 0:
                entered.wait()
                sys.exit(3)
            entered.set()
            try:
                while True:
                    sim.restore(begin := sim.state())
                    sim.advance(0.01)
                    sim.restore(begin)
            except tetlap.RunError:
                return {"k": k}

        with self.assertRaises(SystemExit):
            tetlap.map(range(2), endure, self.folder, scene=SCENE, processes=2)
        results = tetlap.Results(self.folder)
        self.assertEqual((len(results), results.waiting, results.failures), (0, 2, []))

    def test_after_a_kill_in_the_middle_of_a_line_or_of_growing(self):
        def fail(_, k):
            if k == 1:
                raise ArithmeticError("not this one")
            return {"k": k}

        with self.assertLogs("tetlap", "WARNING"):
            tetlap.map(range(2), fail, self.folder, scene=SCENE)
        (self.folder / "failures.jsonl").write_text('{"index": 1, "ki')
        np.save(self.folder / "status.npy", np.array([1, 2, 0], np.uint8))
        results = tetlap.map(range(2), fail, self.folder, scene=SCENE)
        self.assertEqual((results.index.tolist(), [failure.index for failure in results.failures]), ([0], [1]))
        self.assertIn("does not say why", results.failures[0].message)

    def test_a_function_that_exits_ends_the_map(self):
        def leave(sim, k):
            if k == 1:
                sys.exit(3)
            return {"k": k}

        with self.assertRaises(SystemExit):
            tetlap.map(range(2), leave, self.folder, scene=SCENE, processes=1)
        self.assertEqual(tetlap.Results(self.folder)["k"].tolist(), [0])


class Refusals(InFolder):
    def test_a_folder_is_of_one_function_scene_and_list(self):
        def other(sim, p):
            return press(sim, p)

        tetlap.map(PARAMETERS[:2], press, self.folder, scene=SCENE)
        before = (self.folder / "map.json").read_bytes()
        for words, items, f, arguments in (("another function", PARAMETERS[:2], other, {}), ("other items", PARAMETERS[1:3], press, {}),
                                           ("other items", PARAMETERS[:1], press, {}),
                                           ("another scene", PARAMETERS[:2], press, {"set": {"time.end": 0.1}}),
                                           ("another overlap model", PARAMETERS[:2], press, {"overlap": "exact"})):
            with self.assertRaisesRegex(ValueError, words):
                tetlap.map(items, f, self.folder, **{"scene": SCENE, **arguments})
        self.assertEqual((self.folder / "map.json").read_bytes(), before)

    def test_arguments_of_a_partial_are_of_the_function(self):
        def scaled(factor, sim, p, unit="m"):
            return {"depth": factor * p}

        tetlap.map([1.0], functools.partial(scaled, 2, unit="mm"), self.folder, scene=SCENE)
        again = tetlap.map([1.0, 2.0], functools.partial(scaled, 2, unit="mm"), self.folder, scene=SCENE)
        self.assertEqual(again["depth"].tolist(), [2, 4])
        for other in functools.partial(scaled, 3, unit="mm"), functools.partial(scaled, 2), scaled:
            with self.assertRaisesRegex(ValueError, "another function"):
                tetlap.map([1.0], other, self.folder, scene=SCENE)

    def test_a_mesh_that_has_changed_is_another(self):
        mesh = self.folder.with_name("a.msh")
        scene = {"bodies": [{"name": "a", "mesh": str(mesh), "material": {"young": 1e5, "poisson": 0.3, "density": 1000}}], "time": {"end": 1}}
        nodes = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 {}\n$EndNodes\n$Elements\n1\n1 4 2 0 1 1 2 3 4\n$EndElements\n"

        def mass(sim, _):
            return {"mass": sim.bodies["a"].mass}

        mesh.write_text(nodes.format(1))
        tetlap.map([0], mass, self.folder, scene=scene)
        mesh.write_text(nodes.format(2))
        with self.assertRaisesRegex(ValueError, "another mesh"):
            tetlap.map([0], mass, self.folder, scene=scene)

    def test_folders_of_others_are_left_alone(self):
        self.folder.mkdir()
        (self.folder / "precious").write_text("x")
        with self.assertRaisesRegex(tetlap.Error, "not empty"):
            tetlap.map(PARAMETERS, press, self.folder, scene=SCENE)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["precious"])
        with self.assertRaisesRegex(FileNotFoundError, "map.json"):
            tetlap.Results(self.folder)
        (self.folder / "map.json").write_text(json.dumps({"format": "tetlap-map 9"}))
        with self.assertRaisesRegex(tetlap.Error, "tetlap-map 9"):
            tetlap.Results(self.folder)

    def test_a_folder_is_its_own_even_if_a_kill_left_nothing_in_it(self):
        with unittest.mock.patch("tetlap._table.Table._grow", side_effect=KeyboardInterrupt), self.assertRaises(KeyboardInterrupt):
            tetlap.map([1], press, self.folder, scene=SCENE)
        self.assertEqual(len(tetlap.Results(self.folder)), 0)
        self.assertEqual(len(tetlap.map(PARAMETERS[:1], press, self.folder, scene=SCENE)), 1)

    def test_one_map_at_a_time_fills_a_folder(self):
        def meddle(_, p):
            with self.assertRaisesRegex(tetlap.Error, "another process"):
                tetlap.map([1], meddle, self.folder, scene=SCENE)
            return {"p": p}

        self.assertEqual(len(tetlap.map([1], meddle, self.folder, scene=SCENE)), 1)

    def test_wrong_calls(self):
        with self.assertRaisesRegex(FileNotFoundError, "no_such"):
            tetlap.map([1], press, self.folder, scene="no_such.yaml")
        with self.assertRaisesRegex(tetlap.RunError, "yuong"):
            tetlap.map([1], press, self.folder, scene={"bodies": [{"name": "a", "mesh": "a.msh", "material": {"yuong": 1}}]})
        with self.assertRaisesRegex(ValueError, "no items"):
            tetlap.map([], press, self.folder, scene=SCENE)
        self.assertFalse(self.folder.exists())
        with self.assertRaisesRegex(TypeError, "item 0 .object."):
            tetlap.map([object()], press, scene=SCENE)
        for arguments in {"processes": 0}, {"threads": 1.5}:
            with self.assertRaisesRegex(ValueError, "at least 1"):
                tetlap.map(PARAMETERS, press, scene=SCENE, **arguments)
        with self.assertRaisesRegex(KeyError, "there is force, points, depth"):
            tetlap.map(PARAMETERS[:1], press, scene=SCENE)["fource"]


if __name__ == "__main__":
    logging.basicConfig()
    unittest.main()
