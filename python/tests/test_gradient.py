# SPDX-License-Identifier: Apache-2.0
"""Exact derivatives of static scenes, as arrays and as a function that PyTorch differentiates."""

import tempfile
import unittest

import numpy as np

import tetlap

SCENE = {
    "time": {"end": 1, "static": True},
    "output": {"frames": 2},
    "effects": {"gravity": [0, 0, -9.81]},
    "bodies": [
        {"name": "block", "mesh": {"box": {"size": [0.2, 0.2, 0.1], "cells": [2, 2, 1]}},
         "material": {"young": 1e5, "poisson": 0.3, "density": 1000}, "fixed": [{"group": "z_max", "components": ["x", "y"]}]},
    ],
    "obstacles": [{"name": "ground", "halfspace": {"point": [0, 0, 0], "normal": [0, 0, 1]}}],
    "contact": {"stiffness": 1e7},
}
DENSITY, YOUNG, DAMPING = (f"bodies.block.material.{name}" for name in ("density", "young", "damping"))


TWO = {**SCENE, "obstacles": [], "bodies": [
    {**SCENE["bodies"][0], "fixed": [{"group": "z_min"}]},
    {**SCENE["bodies"][0], "name": "upper", "place": {"translate": [0.013, 0.017, 0.098]}},
]}


class Gradient(unittest.TestCase):
    def test_what_rests_on_the_ground_weighs_by_its_density(self):
        found = tetlap.gradient(SCENE, ["force:block:ground:z", "energy"], [DENSITY, YOUNG, DAMPING, "effects.gravity[2]"])
        weight = 0.2 * 0.2 * 0.1 * 1000 * 9.81
        self.assertEqual(found["derivative"].shape, (2, 4))
        self.assertAlmostEqual(found["value"][0], weight, delta=1e-9 * weight)
        np.testing.assert_allclose(found["derivative"][0], [weight / 1000, 0, 0, -weight / 9.81], rtol=0, atol=1e-9 * weight)
        np.testing.assert_allclose(found["share"][0, [0, 3]], 1, rtol=1e-9)
        np.testing.assert_array_equal(found["parameter"][[0, 1, 3]], [1000, 1e5, -9.81])
        self.assertEqual(found["parameter"][2], 0)
        self.assertEqual(list(found["does_not_act"]), [DAMPING])
        self.assertEqual(found["contact_stiffness"], "given")
        self.assertEqual((found["unit"], found["parameter_unit"][:2]), (["N", "J"], ["kg/m³", "Pa"]))
        self.assertLess(max(found["adjoint_residual"].max(), found["force_residual"]), 1e-10)

    def test_one_key_with_a_kink_is_told_and_the_others_are_answered(self):
        scene = {**TWO, "bodies": [{**TWO["bodies"][0], "mesh": {"box": {"size": [0.2, 0.2, 0.1], "cells": [4, 4, 2]}}}, TWO["bodies"][1]]}
        keys = ["bodies.block.place.scale[2]", "bodies.block.place.scale"]
        found = tetlap.gradient(scene, "force:block:upper:z", keys)
        self.assertEqual(list(found["no_derivative"]), keys[:1])
        self.assertIn("equally far", found["no_derivative"][keys[0]])
        self.assertTrue(np.isnan(found["derivative"][0, 0]) and np.isfinite(found["derivative"][0, 1]))

    def test_one_quantity_by_one_parameter_with_a_value_replaced(self):
        found = tetlap.gradient(SCENE, "force:block:z", DENSITY, set={DENSITY: 2000})
        self.assertEqual(found["derivative"].shape, (1, 1))
        self.assertEqual(found["parameter"][0], 2000)

    def test_quantities_at_earlier_times(self):
        of = ["force:ground:block:z@0.5", "force:ground:block:z"]
        moved = {**SCENE, "effects": {}, "obstacles": [{**SCENE["obstacles"][0], "motion": {"velocity": [0, 0, 1e-3]}}]}
        moved["bodies"] = [{**SCENE["bodies"][0], "fixed": [{"group": "z_max"}]}]
        both = tetlap.gradient(moved, of, YOUNG)
        early = tetlap.gradient(moved, of, YOUNG, at=0.75)
        np.testing.assert_allclose(early["value"][0], both["value"][0], rtol=1e-9)
        np.testing.assert_allclose(early["derivative"][0], both["derivative"][0], rtol=1e-9)
        self.assertTrue(abs(both["value"][0]) < abs(early["value"][1]) < abs(both["value"][1]))
        with self.assertRaisesRegex(tetlap.RunError, "not within the run"):
            tetlap.gradient(moved, of, YOUNG, at=2)

    def test_a_check_compares_with_other_runs(self):
        found = tetlap.gradient(SCENE, ["displacement:block:z", "energy"], [YOUNG, DENSITY], check=True)
        self.assertNotIn("halved", tetlap.gradient(SCENE, "energy", YOUNG))
        self.assertEqual(found["halved"].shape, (2, 2))
        self.assertLess(found["halved"].max(), 1e-8)
        np.testing.assert_allclose(found["along_by_runs"], found["along_by_derivatives"], rtol=1e-6)

    def test_a_check_keeps_shapes_by_which_other_runs_differ_otherwise(self):
        chosen = {**TWO, "contact": {}}
        for scene, shape in ((chosen, "bodies.upper.place.scale"), (TWO, "bodies.upper.rest[1][2]")):
            found = tetlap.gradient(scene, "energy:contact", [shape, "bodies.upper.material.density"], check=True)
            self.assertNotEqual(found["derivative"][0, 0], 0)
            np.testing.assert_allclose(found["along_by_runs"], found["along_by_derivatives"], rtol=1e-5)

    def test_slopes_by_weights_lead_to_other_quantities(self):
        scene, of = TWO, ["displacement:upper:z", "moment:upper:block:x"]
        found = tetlap.gradient(scene, of, [], set={"contact.overlap": "geo-small"}, weights=True)
        weights, share = tetlap.read_weights("geo-small"), 3e-8
        slope = found["weights"][1]
        self.assertEqual({name: tensor.shape for name, tensor in slope.items()}, {name: tensor.shape for name, tensor in weights.items()})
        last = sorted(weights)[-1]  # of the layer in which V's logarithm is linear
        moved = {name: tensor.astype(np.float64) for name, tensor in weights.items()}
        moved[last] += share * slope[last] * np.linalg.norm(moved[last]) / np.linalg.norm(slope[last])
        with tempfile.TemporaryDirectory() as folder:
            path = f"{folder}/moved.safetensors"
            tetlap.write_weights(path, moved, weights.shape, normalisation=weights.normalisation)
            other = tetlap.gradient(scene, of, "contact.stiffness", set={"contact.overlap": path})
        for goal in range(2):
            expected = np.vdot(found["weights"][goal][last], moved[last] - weights[last])
            self.assertAlmostEqual(other["value"][goal] - found["value"][goal], expected, delta=2e-3 * abs(expected))

    def test_a_motion_that_goes_on_from_another_run(self):
        place, velocity = [0, 0, 0.004], [0, 0, -0.3]
        bodies = [{**SCENE["bodies"][0], "fixed": [], "place": {"translate": place}}]
        scene = {**SCENE, "time": {"end": 0.02, "tolerance": 1e-6}, "bodies": [{**bodies[0], "velocity": velocity}]}
        of, by = ["displacement:block:z", "energy:elastic"], [YOUNG, "effects.gravity[2]"]
        with tempfile.TemporaryDirectory() as folder:
            tetlap.run(scene, f"{folder}/first")
            scene.update(bodies=bodies, start=f"{folder}/first")
            found = tetlap.gradient(scene, of, by)
            ended = tetlap.run(scene, f"{folder}/second")
            moved = ended.frames[-1].points.mean(0)[2] - 0.05 - place[2]
            sides = [tetlap.gradient(scene, of, by, set={YOUNG: young})["value"] for young in (0.99e5, 1.01e5)]
        self.assertAlmostEqual(found["value"][0], moved, delta=1e-3 * abs(moved))
        self.assertAlmostEqual(found["value"][1], ended.history["elastic_J"][-1], delta=0.01 * found["value"][1])
        np.testing.assert_allclose(found["derivative"][:, 0] * 2e3, sides[1] - sides[0], rtol=0.02)

    def test_a_motion_with_as_little_memory_as_is_needed(self):
        bodies = [{**SCENE["bodies"][0], "fixed": [], "place": {"translate": [0, 0, 0.004]}, "velocity": [0, 0, -0.3]}]
        scene = {**SCENE, "time": {"end": 0.02, "tolerance": 1e-6}, "bodies": bodies}
        whole = tetlap.gradient(scene, "energy:elastic", YOUNG)
        with self.assertRaisesRegex(tetlap.RunError, "MB at least") as refused:
            tetlap.gradient(scene, "energy:elastic", YOUNG, memory=1e-6)
        least = float(str(refused.exception).split("keeps ")[1].split()[0])
        found = tetlap.gradient(scene, "energy:elastic", YOUNG, memory=least)
        np.testing.assert_array_equal(found["derivative"], whole["derivative"])
        with self.assertRaisesRegex(tetlap.RunError, "--memory"):
            tetlap.gradient(scene, "energy:elastic", YOUNG, memory=0)

    def test_what_has_no_gradient_says_why(self):
        ball = {"name": "ball", "sphere": {"centre": [0, 0, -1], "radius": 1}}
        with self.assertRaisesRegex(tetlap.RunError, "friction on a sphere"):
            tetlap.gradient({**SCENE, "obstacles": [ball], "contact": {"stiffness": 1e7, "friction": 0.3}}, "energy", DENSITY)
        with self.assertRaisesRegex(tetlap.RunError, "there are block"):
            tetlap.gradient(SCENE, "displacement:brick:z", DENSITY)
        with self.assertRaisesRegex(TypeError, r"of is \[3\]"):
            tetlap.gradient(SCENE, [3], DENSITY)


class Torch(unittest.TestCase):
    def setUp(self):
        try:
            import torch
        except ImportError:
            self.skipTest("no python3-torch")
        self.torch = torch

    def test_a_loss_goes_back_through_the_run(self):
        torch = self.torch
        density = torch.tensor(1000.0, dtype=torch.float64, requires_grad=True)
        young = torch.tensor(1e5, requires_grad=True)
        q = tetlap.torch.run(SCENE, {DENSITY: density, YOUNG: young}, ["force:block:z", "displacement:block:z"])
        (q[0] ** 2).backward()
        weight = 39.24
        self.assertAlmostEqual(density.grad.item(), 2 * weight * weight / 1000, delta=1e-9 * weight * weight)
        self.assertEqual(young.grad.dtype, torch.float32)
        self.assertLess(abs(young.grad.item()), 1e-9)
        self.assertEqual(tetlap.torch.run(SCENE, {YOUNG: young}, "force:block:z", at=0.5).shape, (1,))

    def test_gradcheck(self):
        torch = self.torch
        scale = torch.ones(2, dtype=torch.float64, requires_grad=True)

        def displacement(scale):
            return 1e6 * tetlap.torch.run(SCENE, {YOUNG: 1e5 * scale[0], DENSITY: 1000 * scale[1]}, "displacement:block:z")

        self.assertTrue(torch.autograd.gradcheck(displacement, (scale,), eps=1e-4, rtol=1e-6, atol=1e-4))

    def test_a_loss_goes_back_to_a_network(self):
        weights = tetlap.read_weights("geo-small")
        net = tetlap.torch.network(weights)
        density = self.torch.tensor(1000.0, requires_grad=True)
        of, upper = ["displacement:upper:z", "moment:upper:block:x"], "bodies.upper.material.density"
        q = tetlap.torch.run(TWO, {upper: density}, of, network=net)
        (3 * q[0] - q[1]).backward()
        found = tetlap.gradient(TWO, of, upper, set={"contact.overlap": "geo-small"}, weights=True)
        for name, tensor in net.named_parameters():
            expected = 3 * found["weights"][0][name] - found["weights"][1][name]
            np.testing.assert_allclose(tensor.grad.numpy(), expected, rtol=1e-3, atol=1e-4 * np.abs(expected).max())
        self.assertAlmostEqual(density.grad.item(), 3 * found["derivative"][0, 0] - found["derivative"][1, 0], delta=1e-4 * abs(density.grad.item()))
        with self.assertRaisesRegex(TypeError, "tetlap.torch.network"):
            tetlap.torch.run(TWO, {}, of, network=self.torch.nn.Linear(2, 2))

    def test_a_chosen_stiffness_follows_the_material_and_warns_of_others(self):
        torch = self.torch
        scene = {**SCENE, "contact": {}}
        young = torch.tensor(1e5, dtype=torch.float64, requires_grad=True)
        displaced = tetlap.torch.run(scene, {YOUNG: young}, "displacement:block:z")
        displaced.sum().backward()
        # Linear up to the shape of a body this stiff: all of it is inverse to E.
        self.assertAlmostEqual(young.grad.item() * 1e5 / displaced.item(), -1, delta=0.02)
        with self.assertWarnsRegex(UserWarning, "density"):
            tetlap.torch.run(scene, {DENSITY: torch.tensor(1000.0)}, "displacement:block:z")

    def test_wrong_parameters_are_refused(self):
        with self.assertRaisesRegex(TypeError, "expected a torch.Tensor"):
            tetlap.torch.run(SCENE, {YOUNG: 1e5}, "energy")
        with self.assertRaisesRegex(ValueError, "one number"):
            tetlap.torch.run(SCENE, {YOUNG: self.torch.ones(2)}, "energy")
        with self.assertRaisesRegex(ValueError, "no value of a scene"):
            tetlap.torch.run(SCENE, {"bodies.block.rest[3][2]": self.torch.tensor(0.1)}, "energy")


if __name__ == "__main__":
    unittest.main()
