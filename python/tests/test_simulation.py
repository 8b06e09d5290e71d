# SPDX-License-Identifier: Apache-2.0
"""A run that Python steps."""

import copy
import gc
import os
import pickle
import signal
import subprocess
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy as np

import tetlap

SCENE = Path(os.environ["TETLAP_SOURCE_DIR"], "tests", "scenes", "hand.yaml")


#: What is stretched by its end's displacement, without a lateral contraction.
BAR = {"bodies": [{"name": "bar", "mesh": {"box": {"size": [0.1, 0.1, 0.5], "cells": [1, 1, 5]}}, "material": {"young": 1e6, "poisson": 0, "density": 1000},
                   "fixed": [{"group": "z_min"}], "driven": [{"group": "z_max", "external": True}]}], "time": {"end": 1, "static": True}}


def opened(**arguments):
    return tetlap.Simulation(SCENE, threads=1, **arguments)


def press(sim, until):
    """Presses the plate down and pulls the block aside, in steps of .01 s."""
    while sim.time < until:
        sim.drive["plate"] = [0, 0, -0.05 * (sim.time + 0.01)]
        sim.loads["block"] = [0.5, 0, 0]
        sim.advance(0.01)


class Stepping(unittest.TestCase):
    def test_views_show_the_present_and_cannot_be_written(self):
        with opened() as sim:
            block = sim.bodies["block"]
            points, before = block.points, block.points.copy()
            self.assertEqual(points.shape, (64, 3))
            sim.advance(0.02)
            self.assertIs(block.points, points)
            self.assertLess((points - before)[:, 2].mean(), 0)
            self.assertLess(block.velocities[:, 2].min(), 0)
            self.assertFalse(points.flags.owndata or points.flags.writeable)
            self.assertEqual(block.tets.max(), 63)
            self.assertAlmostEqual(block.mass, 1, 12)
            for name in ("points", "forces", "position"):
                with self.assertRaises(AttributeError):
                    setattr(block, name, before)
            self.assertIs(block.points, points)

    def test_forces_are_those_of_the_vertices_and_opposite_on_the_other(self):
        with opened() as sim:
            press(sim, 0.12)
            floor, plate = sim.contacts["block", "floor"], sim.contacts["plate", "block"]
            self.assertTrue(floor.touches and plate.touches)
            np.testing.assert_array_equal(plate.force, -sim.contacts["block", "plate"].force)
            with opened() as apart:
                self.assertFalse(np.signbit(apart.contacts["plate", "block"].force).any())
            total = floor.force - plate.force
            np.testing.assert_allclose(sim.bodies["block"].forces.sum(axis=0), total, atol=1e-9 * np.abs(total).max())
            self.assertGreater(sim.bodies["block"].pressure.max(), 0)
            self.assertGreaterEqual(floor.slip, 0)
            self.assertGreater(sim.bodies["block"].von_mises.max(), 100)

    def test_the_end_is_reached_by_sums_of_steps(self):
        with opened() as sim:
            steps = 0
            while sim.time < sim.end:
                sim.advance(sim.end / 30)
                steps += 1
            self.assertEqual((sim.time, steps), (sim.end, 30))

    def test_states_go_on_to_the_same_bits_here_and_in_a_fork(self):
        with opened() as sim:
            press(sim, 0.1)
            state = sim.state()
            with sim.fork() as other:
                sim.advance(0.03)
                first = sim.bodies["block"].points.copy()
                sim.restore(state)
                self.assertEqual(sim.time, state.time)
                sim.advance(0.03)
                np.testing.assert_array_equal(sim.bodies["block"].points, first)
                other.advance(0.03)
                self.assertEqual(other.time, sim.time)
        del state
        gc.collect()

    def test_what_was_set_can_be_read_and_is_that_of_the_state(self):
        with opened() as sim, tempfile.TemporaryDirectory() as folder:
            np.testing.assert_array_equal(sim.drive["plate"], [0, 0, 0])
            sim.drive["plate"] = [0, 0, -0.001]
            sim.advance(0.01)
            state = sim.state()
            state.write(Path(folder, "state.h5"))
            sim.drive["plate"], sim.loads["block"] = [0, 0, -0.002], [1, 0, 0]
            with self.assertRaises(ValueError):
                sim.drive["plate"] = [np.nan, 0, 0]
            np.testing.assert_array_equal(sim.drive["plate"], [0, 0, -0.002])
            with sim.fork() as other:
                np.testing.assert_array_equal(other.loads["block"], [1, 0, 0])
            sim.restore(state)
            np.testing.assert_array_equal(sim.drive["plate"], [0, 0, -0.001])
            np.testing.assert_array_equal(sim.loads["block"], [0, 0, 0])
            sim.restore(sim.read_state(Path(folder, "state.h5")))
            self.assertTrue(np.isnan(sim.drive["plate"]).all())
            with self.assertRaisesRegex(tetlap.UnknownNameError, "'plate'"):
                sim.drive["plat"]

    def test_a_state_of_a_file_is_of_its_scene(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "state.h5")
            with opened() as sim:
                sim.advance(0.05)
                sim.state().write(path)
                sim.advance(0.05)
                points = sim.bodies["block"].points.copy()
            with opened() as sim:
                sim.restore(sim.read_state(path))
                sim.advance(0.05)
                np.testing.assert_array_equal(sim.bodies["block"].points, points)
            with opened(set={"contact.friction.coefficient": 0.1}) as sim:
                with self.assertRaisesRegex(ValueError, "the scene has changed"):
                    sim.read_state(path)
                with self.assertRaisesRegex(tetlap.RunError, "no_such.h5"):
                    sim.read_state("no_such.h5")
                with self.assertRaisesRegex(ValueError, "hand.yaml"):
                    sim.read_state(SCENE)
                self.assertEqual(sim.advance(0.01), 0.01)

    def replay(self, folder, *lines):
        """The program's run of a record: exit code and messages."""
        if lines:
            Path(folder, "record.jsonl").write_text("\n".join(lines) + "\n", encoding="utf-8")
        done = subprocess.run([os.environ["TETLAP_PROGRAM"], "run", SCENE, "--replay", Path(folder, "record.jsonl"), "-o", Path(folder, "out"),
                               "--threads=1", "-q"], capture_output=True, text=True, check=False)
        return done.returncode, done.stderr

    def test_the_program_does_again_what_was_recorded(self):
        with tempfile.TemporaryDirectory() as folder, opened() as sim:
            press(sim, 0.05)
            with sim.fork() as other:  # what led to a fork is of its record, too
                press(other, 0.1)
                other.loads["block"] = [0, 0, 0, 0, 1e-3, 0]
                other.advance(until=0.15, stop=lambda it: it.contacts["plate", "block"].force[2] > 20)
                other.advance(until=other.end)
                other.record(Path(folder, "record.jsonl"))
                self.assertEqual(self.replay(folder), (0, ""))
                np.testing.assert_array_equal(tetlap.read(Path(folder, "out")).frames[-1].points, other.bodies["block"].points)

    def test_a_record_that_does_not_fit_is_told_with_its_line(self):
        first = '{"format": 1, "vertices": 64}'
        with tempfile.TemporaryDirectory() as folder:
            for lines, words in ((("{}",), "1: is no record of a run"), (('{"format": 1, "vertices": 8}',), "1: is of a scene with 8 vertices, this one has 64"),
                                 ((first, '{"drive": "plat", "to": [0, 0, 0]}'), "2: nothing that is driven.*there is 'plate'"),
                                 ((first, '{"load": "block", "to": [0, 0], "ramp": 0}'), "2: 'block': a load has 3 values"),
                                 ((first, '{"load": "block", "to": [0, 0, "x"], "ramp": 0}'), "2: 'block': value 2 is nan"),
                                 ((first, '{"advance": 0.01}', '{"advance": 0.001}'), "3: the run is at.*cannot go back"),
                                 ((first, '{"leap": 1}'), "2: expected drive, load, advance or anew"), ((first, "{"), "record.jsonl")):
                code, said = self.replay(folder, *lines)
                self.assertEqual(code, 65, said)
                self.assertRegex(said, words)

    def test_callbacks_see_every_step_and_may_end_the_advance(self):
        with opened() as sim:
            times, events = [], []
            sim.on_step(lambda it: times.append((it.time, it.bodies["block"].stress.shape)))
            sim.on_contact(lambda _, contact, begins: events.append((contact.a, contact.b, begins)))
            sim.advance(0.05)
            self.assertGreater(len(times), 3)
            self.assertTrue(all(a < b for a, b in zip(times, times[1:])))
            self.assertEqual(events[0], ("block", "floor", True))
            reached = sim.advance(until=sim.end, stop=lambda it: it.contacts["block", "floor"].force[2] > 12)
            self.assertGreater(sim.contacts["block", "floor"].force[2], 12)
            self.assertLess(reached, sim.end)
            self.assertEqual(times[-1][0], reached)

    def test_scenes_may_be_dicts_and_static(self):
        scene = {"bodies": [{"name": "bar", "mesh": {"box": {"size": [0.1, 0.1, 0.5], "cells": [1, 1, 5]}},
                             "material": {"young": 1e6, "poisson": 0, "density": 1000},
                             "fixed": [{"box": {"min": [-1, -1, -1], "max": [1, 1, 1e-9]}}],
                             "loads": [{"box": {"min": [-1, -1, 0.5 - 1e-9], "max": [1, 1, 1]}, "external": True}]}],
                 "time": {"end": 1, "static": True}}
        with tetlap.Simulation(scene) as sim:
            for k in 1, 2:
                sim.loads["bar"] = [0, 0, 10.0 * k]
                sim.advance(0.25)
                stretch = sim.bodies["bar"].points[:, 2].max() - 0.5
                # F L / (E A), but for the last row, whose corners do not share F as an even traction would
                self.assertAlmostEqual(stretch / (0.5 * 10 * k / (1e6 * 0.01)), 1, 1)
            centres = sim.bodies["bar"].points[sim.bodies["bar"].tets].mean(axis=1)[:, 2]
            middle = sim.bodies["bar"].stress[(centres > 0.2) & (centres < 0.3), 2]
            self.assertAlmostEqual(middle.mean() / (20 / 0.01), 1, 2)

    def test_a_static_scene_goes_from_one_prescribed_displacement_to_the_next(self):
        steps = []
        with tetlap.Simulation(BAR, set={"output.frames": 1}) as sim:
            sim.on_step(lambda it: steps.append(it.time))
            for k in 1, 2, -1:
                sim.drive["bar"] = [0, 0, 1e-3 * k]
                sim.advance(0.25)
                self.assert_stretched(sim, 1e-3 * k)
        self.assertEqual(steps, [0.25, 0.5, 0.75])  # with one frame no load steps but those that were asked for

    def assert_stretched(self, sim, by):
        self.assertAlmostEqual(np.ptp(sim.bodies["bar"].points[:, 2]) - 0.5, by, 12)
        # Hooke's law, to the first order in a strain of .4 %.
        np.testing.assert_allclose(sim.bodies["bar"].stress[:, 2], 1e6 * by / 0.5, rtol=1e-2)

    def test_a_simulation_begins_where_another_run_ended(self):
        pulled = [{**BAR["bodies"][0], "driven": [{"group": "z_max", "table": [[0, 0, 0, 0], [1, 0, 0, 1e-3]]}]}]
        with tempfile.TemporaryDirectory() as folder:
            tetlap.run({**BAR, "bodies": pulled}, Path(folder, "pulled"))
            start = os.path.relpath(Path(folder, "pulled"))  # of a dict, from here
            with tetlap.Simulation({**BAR, "start": start}) as sim:
                self.assert_stretched(sim, 1e-3)
                sim.drive["bar"] = [0, 0, 1e-3]  # from where the vertices are at the start
                sim.advance(0.5)
                self.assert_stretched(sim, 2e-3)
                with sim.fork() as other:
                    self.assert_stretched(other, 2e-3)
            run = tetlap.run(SCENE, Path(folder, "stood"), set={"time.end": 0.1})
            with opened(set={"start": Path(folder, "stood")}) as sim:
                self.assertEqual(sim.time, 0)
                np.testing.assert_allclose(sim.bodies["block"].points, run.frames[-1].points, rtol=0, atol=1e-12)
                np.testing.assert_allclose(sim.bodies["block"].velocities, run.frames[-1]["velocity"], rtol=0, atol=1e-12)
                press(sim, 0.05)
                self.assertTrue(sim.contacts["plate", "block"].touches or sim.contacts["block", "floor"].touches)

    def test_a_models_own_function_answers(self):
        pairs = []

        def volume(x):
            pairs.append(len(x))
            result = tetlap.overlap(x, "clip", order=1)
            return {"volume": result.volume, "gradient": result.gradient}

        two = {"bodies": [{"name": name, "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": 1}}, "place": {"translate": [0.01 * z, 0, z]},
                           "material": {"young": 1e5, "poisson": 0.3, "density": 1000}} for name, z in (("low", 0), ("high", 0.099))],
               "contact": {}, "time": {"end": 0.01}}
        with tetlap.Simulation(two, overlap=volume) as sim:
            sim.advance(0.001)
            self.assertGreater(sim.contacts["high", "low"].force[2], 0)
            self.assertGreater(sum(pairs), 0)
            with self.assertRaisesRegex(tetlap.Error, "cannot fork"):
                sim.fork()


class Refusals(unittest.TestCase):
    def test_names_that_are_not_there_are_told_with_those_that_are(self):
        with opened() as sim:
            for call, words in ((lambda: sim.bodies["ball"], "'block'"), (lambda: sim.contacts["block", "ball"], "'block', 'floor'"),
                                (lambda: sim.drive.set("block", [0, 0, 0]), "'plate'"), (lambda: sim.loads.set("plate", [0, 0, 0]), "'block'")):
                with self.assertRaisesRegex(KeyError, words):
                    call()
        with tetlap.Simulation(BAR) as sim, self.assertRaisesRegex(KeyError, "no entry of.*loads"):
            sim.loads["bar"] = [0, 0, 1]
        with tetlap.Simulation({**BAR, "bodies": [{**BAR["bodies"][0], "driven": []}]}) as sim, self.assertRaisesRegex(KeyError, "obstacle's"):
            sim.drive["bar"] = [0, 0, 1]

    def test_values_that_make_no_sense_leave_the_run_as_it_was(self):
        with opened() as sim:
            sim.advance(0.01)
            for call, words in ((lambda: sim.drive.set("plate", [0, 0]), r"shape \(2,\); expected \(3,\)"),
                                (lambda: sim.drive.set("plate", [0, 0, np.nan]), "value 2 is nan"),
                                (lambda: sim.loads.set("block", np.zeros((3, 2))), r"expected \(3,\) or \(6,\) or \(64, 3\)"),
                                (lambda: sim.loads.set("block", 5), r"shape \(\); expected"),
                                (lambda: sim.drive.set("plate", [0, 0, 0], ramp=0), "cannot jump"),
                                (lambda: sim.advance(until=0.001), "cannot go back"), (lambda: sim.advance(-0.001), "cannot go back"),
                                (lambda: sim.advance(10), "ends at t = 0.2 s"), (lambda: sim.advance(until=np.nan), "not nan"),
                                (lambda: sim.loads.set("block", [0, 0, 0], ramp=-1), "0 seconds or more, not -1")):
                with self.assertRaisesRegex(ValueError, words):
                    call()
            for call in (lambda: sim.advance(0.01, stop=5), lambda: sim.on_step(5), lambda: sim.on_contact(None),
                         lambda: sim.advance(), lambda: sim.advance(0.1, until=1), lambda: sim.drive.set("plate", "up"), lambda: sim.restore(3),
                         lambda: sim.advance("x"), lambda: sim.loads.set("block", [0, 0, 0], ramp="x")):
                with self.assertRaises(TypeError):
                    call()
            sim.advance(0.01)
            self.assertAlmostEqual(sim.time, 0.02, 12)

    def test_a_scene_that_is_wrong_is_told_by_the_program(self):
        with self.assertRaisesRegex(tetlap.RunError, "no_such.yaml"):
            tetlap.Simulation("no_such.yaml")
        with self.assertRaisesRegex(tetlap.RunError, "yuong"):
            tetlap.Simulation({"bodies": [{"name": "a", "mesh": "a.msh", "material": {"yuong": 1}}]})
        with self.assertRaisesRegex(tetlap.RunError, "--threads is '-1'"):
            tetlap.Simulation(SCENE, threads=-1)

    def test_closed_foreign_and_lost_ones_are_told(self):
        with opened() as sim, opened() as other:
            with self.assertRaisesRegex(ValueError, "another Simulation"):
                sim.restore(other.state())
            other._channel._process.kill()
            with self.assertRaisesRegex(tetlap.RunError, "killed by signal 9"):
                other.advance(0.01)
        for closed in sim, other:
            with self.assertRaisesRegex(tetlap.Error, "closed"):
                closed.advance(0.01)

    def test_a_fork_of_the_interpreter_may_not_use_it(self):
        with opened() as sim:
            child = os.fork()
            if child == 0:
                try:
                    sim.advance(0.001)
                except tetlap.Error as error:
                    os._exit(7 if "fork of the interpreter" in str(error) else 8)
                os._exit(9)
            self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 7)
            sim.advance(0.001)

    def test_a_fork_that_drops_its_copy_leaves_the_run_and_its_scene_alone(self):
        scene = {"bodies": [{"name": "block", "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": 1}},
                             "material": {"young": 1e5, "poisson": 0.3, "density": 1000}}], "time": {"end": 0.01}}
        with tetlap.Simulation(scene, threads=1) as sim:
            child = os.fork()
            if child == 0:
                del sim
                gc.collect()
                os._exit(0)
            os.waitpid(child, 0)
            with sim.fork() as other:  # opens the dict's file again
                self.assertEqual(other.advance(0.001), sim.advance(0.001))

    def test_one_thread_at_a_time(self):
        with opened() as sim:
            seen = []

            def meddle(it):
                thread = threading.Thread(target=lambda: seen.append(self.catch(lambda: it.advance(0.001))))
                thread.start()
                thread.join()
                seen.append(self.catch(lambda: it.advance(0.001)))
                return True

            sim.on_step(meddle)
            sim.advance(0.01)
            self.assertEqual(len(seen), 2)
            self.assertTrue(all("one at a time" in str(error) for error in seen))

    def catch(self, call):
        try:
            call()
        except tetlap.Error as error:
            return error
        return None

    def test_what_a_callback_raises_comes_out_and_the_run_goes_on_from_that_step(self):
        with opened() as sim:
            times = []

            def fail_at_the_third(it):
                times.append(it.time)
                if len(times) == 3:
                    raise LookupError("no target")

            sim.on_step(fail_at_the_third)
            with self.assertRaisesRegex(LookupError, "no target"):
                sim.advance(0.05)
            self.assertEqual((len(times), sim.time), (3, times[-1]))
            sim.advance(until=0.05)
            self.assertEqual(sim.time, 0.05)
            self.assertGreater(len(times), 3)

    def test_one_that_a_callback_closes_is_closed(self):
        sim = opened()
        sim.on_step(lambda it: it.close())
        for _ in range(2):
            with self.assertRaisesRegex(tetlap.Error, "is closed$"):
                sim.advance(0.05)

    def test_what_a_callback_raises_after_it_closed_is_raised(self):
        def leave(it):
            it.close()
            raise KeyError("mine")

        sim = opened()
        sim.on_step(leave)
        with self.assertRaisesRegex(KeyError, "mine"):
            sim.advance(0.05)
        with self.assertRaisesRegex(tetlap.Error, "is closed$"):
            sim.advance(0.05)

    def test_copies_are_refused_and_leave_the_run_alone(self):
        with opened() as sim:
            for it, words in ((sim, "fork"), (sim.state(), "State.write")):
                for make in (copy.copy, copy.deepcopy, pickle.dumps):
                    with self.assertRaisesRegex(TypeError, words):
                        make(it)
            gc.collect()
            sim.advance(0.01)

    def test_ctrl_c_ends_the_program(self):
        sim = opened()
        process = sim._channel._process
        sim.on_step(lambda _: os.kill(os.getpid(), signal.SIGINT) or time.sleep(0.1))
        with self.assertRaises(KeyboardInterrupt):
            sim.advance(0.1)
        self.assertIsNotNone(process.wait(10))
        with self.assertRaisesRegex(tetlap.Error, "closed: it was ended by KeyboardInterrupt"):
            sim.advance(0.1)


if __name__ == "__main__":
    unittest.main()
