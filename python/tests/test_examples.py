# SPDX-License-Identifier: Apache-2.0
"""The examples reach what they promise."""

import os
import subprocess
import sys
import tempfile
import types
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(os.environ["TETLAP_SOURCE_DIR"], "examples", "python")))


def write_box(file, low, high):
    """A box of six tetrahedra round its diagonal, as .msh 2.2."""
    corners = [[(low, high)[i >> axis & 1][axis] for axis in range(3)] for i in range(8)]
    ways = [(1, 3), (3, 2), (2, 6), (6, 4), (4, 5), (5, 1)]  # round 0 to 7
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", "8", *(f"{i + 1} {x} {y} {z}" for i, (x, y, z) in enumerate(corners)),
             "$EndNodes", "$Elements", "6", *(f"{k + 1} 4 2 0 1 1 {a + 1} {b + 1} 8" for k, (a, b) in enumerate(ways)), "$EndElements"]
    file.write_text("\n".join(lines) + "\n")


class Examples(unittest.TestCase):
    def test_remap_keeps_the_integral_and_constants(self):
        import remap

        for expected, (rows, orders) in remap.main((3, 6, 12)).items():
            for row in rows:
                self.assertLessEqual(row["integral"], 1e-12)
                self.assertLessEqual(row["constant"], 1e-12)
            for order in orders:
                self.assertGreaterEqual(order, expected - 0.15)

    def test_separate_finds_the_smallest_displacement(self):
        try:
            import torch
        except ImportError:
            self.skipTest("no python3-torch")
        import separate

        size, known, left = separate.main()
        self.assertEqual(left, 0)
        self.assertLessEqual(abs(size / known - 1), 0.01)
        self.assertLess(size, 0.9 * separate.DEPTH)

    def test_identify_finds_the_material_within_the_noise_from_every_start(self):
        import identify

        ends = identify.main()
        self.assertEqual(len(ends), 3)
        best = ends["near"][0]
        for material, misfit, spread in ends.values():
            self.assertLess(max(abs(material - best) / spread), 0.01)
            self.assertLess(max(abs(material - identify.TRUTH) / spread), 3)
            self.assertLess(max(spread / identify.TRUTH), 0.02)
            self.assertLess(misfit, 15)  # six numbers, two parameters

    def test_identify_finds_friction_and_damping_in_a_motion_too(self):
        import identify_motion

        (found, misfit, spread), = identify_motion.main(starts=["near"]).values()
        self.assertLess(max(abs(found - identify_motion.TRUTH) / spread), 3)
        self.assertLess(misfit, 20)  # eleven numbers, four parameters
        self.assertLess(max(spread / identify_motion.TRUTH), 0.1)

    def test_a_throw_gets_into_the_bowl_by_its_gradient(self):
        import throw

        points, values, way = throw.main(most=4)
        self.assertGreater(values[0], 40)
        self.assertLess(values[-1], 0.1 * values[0])
        self.assertLess(way[-1, 2], 0)  # below the table
        self.assertLess(np.linalg.norm(way[-1, :2] - throw.BOWL), 0.1)
        self.assertLess(np.linalg.norm(way[-1] - way[-6]), 0.05)  # in the last 0.1 s [m]

    def test_published_problems_are_read_from_their_folder_and_solved(self):
        import published

        with tempfile.TemporaryDirectory() as folder:
            rabbit = ([-0.05, 0, -0.05], [0.05, 0.1, 0.05])
            for name, ground, box in (("fig1_bunnies", "flat-pool", ([-10, -0.5, -10], [10, -0.01, 10])),
                                      ("fig21_friction_bunny", "slide", ([-4, -1, -4], [5, -0.14, 6]))):
                Path(folder, name).mkdir()
                write_box(Path(folder, name, "stanford-bunny.obj_.msh"), *rabbit)
                write_box(Path(folder, name, f"{ground}.msh"), *box)
            points, losses = published.main(folder, "slide", most=6)
            self.assertLess(abs(points[-1][0] - published.FRICTION), 0.01)
            self.assertLess(losses[-1], 0.01 * losses[0])
            points, losses = published.main(folder, "bunnies", most=2)
            self.assertLess(losses[-1], 0.5 * losses[0])

    def test_published_problems_that_are_not_named_are_asked_for(self):
        file = Path(os.environ["TETLAP_SOURCE_DIR"], "examples", "python", "published.py")
        for words, told in (((), "required: DATA, problem"), (("folder", "ball"), "invalid choice: 'ball'")):
            ended = subprocess.run([sys.executable, file, *words], capture_output=True, text=True, check=False)
            self.assertEqual(ended.returncode, 2)
            self.assertIn("usage: published.py [-h] DATA {bunnies,slide}", ended.stderr)
            self.assertIn(told, ended.stderr)

    def test_a_descent_refuses_a_start_without_a_value_and_ends_where_there_is_no_slope(self):
        import descent

        for start in (np.inf, np.nan):
            with self.assertRaisesRegex(ValueError, "not finite at the start"):
                descent.minimise(lambda x, value=start: (value, np.zeros(2)), [1, 2], longest=0.1)
        points, values = descent.minimise(lambda x: (x @ x, 2 * x), [0, 0], longest=0.1)
        np.testing.assert_array_equal(points, [[0, 0]])
        # What cannot be found within a way is stepped back from.
        points, values = descent.minimise(lambda x: (x @ x, 2 * x) if x[0] > -0.5 else (np.inf, np.zeros(2)), [1, 2], longest=5)
        np.testing.assert_allclose(points[-1], 0, atol=1e-3)

    def test_a_gripper_takes_only_a_solver_that_gave_up_for_a_fall(self):
        import grip_lightly

        import tetlap

        for code, refusal in ((65, tetlap.RunError), (grip_lightly.GAVE_UP, ValueError)):
            with unittest.mock.patch("tetlap.gradient", side_effect=tetlap.RunError("refused", code, None)):
                self.assertRaises(refusal, grip_lightly.grip, np.full(6, 0.6))

    def test_a_gripper_lifts_with_less_force_by_its_gradient(self):
        import grip_lightly

        _, values, forces, above = grip_lightly.main(most=3)
        self.assertLess(values[-1], 0.85 * values[0])
        self.assertLess(forces[1].mean(), 0.85 * forces[0].mean())
        self.assertTrue((forces[1][2:] > grip_lightly.needed(grip_lightly.TIMES[8::2])[2:]).all())
        self.assertGreater(above[1], -1e-3)

    def test_the_ridges_of_a_seal_press_as_prescribed(self):
        import seal

        points, values = seal.main(most=9)
        self.assertGreater(values[0], 0.1)
        np.testing.assert_allclose(seal.forces(points[-1]), seal.WANTED, rtol=0.02)
        np.testing.assert_allclose(points[-1], points[-1][::-1], atol=0.05)  # the strip is symmetric, its tetrahedra are not quite

    def test_forces_on_vertices_are_sums_over_pairs(self):
        import nodal_forces

        import tetlap

        scene = Path(os.environ["TETLAP_SOURCE_DIR"], "examples", "verdict", "press.yaml")
        with tempfile.TemporaryDirectory() as folder:
            told = list(nodal_forces.states(tetlap.run(scene, folder, overlap="clip", set={"output.frames": 2, "contact.stiffness": 2e7})))
        self.assertEqual(len(told), 2)
        for frame, state in told:
            self.assertGreater(len(state.pairs), 100)
            forces, found = frame["contact_force"], np.zeros_like(frame.points)
            found[:state.vertex.max() + 1] = 2e7 * state.forces(state.moments)
            self.assertGreater(abs(forces).max(), 0.1)
            np.testing.assert_allclose(found, forces, atol=1e-12 * abs(forces).max())

    def test_a_network_trained_in_place_has_smaller_errors_of_forces_in_the_program(self):
        try:
            import torch  # noqa: F401
        except ImportError:
            self.skipTest("no python3-torch")
        import nodal_forces
        import train_in_place

        import tetlap

        random = np.random.default_rng(3)
        states = list(train_in_place.states(train_in_place.random_scene(random) for _ in range(5)))
        with tempfile.TemporaryDirectory() as folder, unittest.mock.patch("train_in_place.states", lambda scenes: states):
            target = Path(folder, "new.safetensors")
            told = train_in_place.main(target, epochs=10)
            errors = np.zeros((2, len(states)))
            for n, model in enumerate(("geo-small", target)):
                for k, state in enumerate(states):
                    found = tetlap.overlap(state.pairs, model, 0, centroid=True)
                    moments = found.volume[:, None] * np.concatenate([nodal_forces.barycentric(state.pairs[:, side], found.centroid) for side in (0, 1)], 1)
                    errors[n, k] = np.linalg.norm(state.forces(moments - state.moments)) / np.linalg.norm(state.forces(state.moments))
        np.testing.assert_allclose(errors.mean(1), [told[0][0], told[-1][0]], rtol=1e-3)
        self.assertLess(told[-1][0], 0.9 * told[0][0])

    def test_the_gripper_lifts_the_cube_and_carries_its_weight(self):
        import grip

        told = grip.main(Path(grip.__file__).with_name("gripper.yaml"))
        self.assertAlmostEqual(told["height"], 0.07, delta=2e-3)
        self.assertAlmostEqual(told["carries"] / told["weight"], 1, delta=0.1)  # it still swings
        self.assertGreater(told["presses"], 0.9 * grip.GRIP)
        self.assertEqual(told["ground"], 0)

    def test_twenty_labelled_indentations_are_what_their_labels_say(self):
        import indent

        with tempfile.TemporaryDirectory() as folder:
            results = indent.main(folder, count=20, seed=7)
            self.assertEqual((len(results), results.failures), (20, []))
            pressure, position, force = results["pressure"], results["position"], -results["force"][:, 2]
            np.testing.assert_array_equal(position, [[p["x"], p["y"]] for p in indent.draw(30, 7)[:20]])
        integral = (pressure * indent.shares()).sum(axis=(1, 2))
        np.testing.assert_allclose(integral, force, rtol=1e-9)
        self.assertTrue((force > 0.01).all())
        axis = np.linspace(-indent.SIDE / 2, indent.SIDE / 2, indent.CELLS + 1)
        moments = np.einsum("nxy,xy,x->n", pressure, indent.shares(), axis), np.einsum("nxy,xy,y->n", pressure, indent.shares(), axis)
        cell = indent.SIDE / indent.CELLS
        np.testing.assert_allclose(np.stack(moments, 1) / integral[:, None], position, atol=0.3 * cell)
        # A ball that is pressed deeper presses more; Hertz has depth^1.5, and a thin pad more.
        order = np.argsort(results["depth"])
        self.assertGreater(np.corrcoef(results["depth"][order], force[order])[0, 1], 0.95)

    def test_the_environment_is_one_of_gymnasium_and_its_controller_reaches_the_mark(self):
        """Debian has no gymnasium: a stand-in has what the example takes from it."""

        class Env:
            def reset(self, *, seed=None, options=None):
                self.np_random = np.random.default_rng(seed)

        class Box:
            def __init__(self, low, high, shape):
                self.low, self.high, self.shape = low, high, shape

        gymnasium = types.SimpleNamespace(Env=Env, spaces=types.SimpleNamespace(Box=Box))
        with unittest.mock.patch.dict(sys.modules, gymnasium=gymnasium):
            import gym_push
        env = gym_push.Push()
        first, about = env.reset(seed=5)
        observed, reward, reached, late, _ = env.step(np.array([8.0]))
        self.assertEqual((first.shape, about, reached, late), ((3,), {}, False, False))
        self.assertGreater(observed[1], 0)
        self.assertLess(reward, 0)
        np.testing.assert_array_equal(env.reset(seed=5)[0], first)
        np.testing.assert_array_equal(env.step(np.array([8.0]))[0], observed)
        env.close()
        x, mark, reached = gym_push.main()
        self.assertTrue(reached)
        self.assertLess(abs(x - mark), 1.01e-3)


if __name__ == "__main__":
    unittest.main()
