# SPDX-License-Identifier: Apache-2.0
"""examples/models/geo.py, `geo` in PyTorch: the same V, centroid and gradient, and the same run."""

import os
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import torch

import tetlap
from tetlap.serve import Model, ModelError

ROOT = Path(os.environ["TETLAP_SOURCE_DIR"])
sys.path.insert(0, str(ROOT / "examples" / "models"))
import geo  # noqa: E402


def some_pairs(count):
    """A third in general position, a third with a face of one nearly in a face's plane of the other, a third too flat for a frame."""
    random = np.random.default_rng(7)
    x = random.normal(size=(3, count, 2, 4, 3))
    x[..., 1, :, :] = x[..., 1, :, :] * random.uniform(0.3, 1.5, (3, count, 1, 1)) + 0.5 * random.normal(size=(3, count, 1, 3))
    flat = x[1, :, :, :3]
    flat[..., 2] = 1e-3 * random.normal(size=flat.shape[:-1])
    x[2, :, 0, 3] = x[2, :, 0, :3].mean(1) + 1e-7 * random.normal(size=(count, 3))
    return 0.01 * x.reshape(-1, 2, 4, 3)


class Doubtful(torch.nn.Module):
    """V = w Σ x², with a doubt that follows the first coordinate alone."""

    range = "radius 0 to 9, first volume 0 to 9, second volume 0 to 9, overlap to 9"

    def __init__(self):
        super().__init__()
        self.weight = torch.nn.Parameter(torch.tensor(0.5, dtype=torch.float64))

    def forward(self, pairs):
        return {"volume": self.weight * (pairs**2).sum((1, 2, 3)), "doubt": pairs[:, 0, 0, 0] ** 2}


class Module(unittest.TestCase):
    def test_the_gradients_of_volume_and_doubt_come_by_autograd(self):
        model, pairs = Model(Doubtful, "it"), some_pairs(5)
        self.assertEqual(model.gives, 1 | 8 | 128)
        self.assertTrue(model.range.startswith("radius 0 to 9"))
        answer, slope = model(pairs, ("volume", "gradient", "doubt_gradient")), np.zeros_like(pairs)
        slope[:, 0, 0, 0] = 2 * pairs[:, 0, 0, 0]
        np.testing.assert_allclose(answer["gradient"], pairs)
        np.testing.assert_allclose(answer["doubt_gradient"], slope)
        self.assertNotIn("doubt_gradient", model(pairs, ("gradient",)))


    def test_a_volume_that_does_not_follow_the_pairs_has_no_gradient(self):
        class Detached(torch.nn.Module):
            @torch.no_grad()
            def forward(self, pairs):
                return {"volume": (pairs**2).sum((1, 2, 3))}

        self.assertEqual(Model(Detached, "it").gives, 0)

    def test_a_module_may_change_its_pairs_in_place(self):
        class Shifting(torch.nn.Module):
            def forward(self, pairs):
                pairs += 1
                return (pairs**2).sum((1, 2, 3))

        pairs = some_pairs(5)
        np.testing.assert_allclose(Model(Shifting, "it")(pairs, ("gradient",))["gradient"], 2 * (pairs + 1))

    def test_a_tuple_is_told_to_be_a_dict(self):
        class Both(torch.nn.Module):
            def forward(self, pairs):
                return pairs.sum((1, 2, 3)), pairs.mean((1, 2))

        with self.assertRaisesRegex(ModelError, "it returned a tuple as volume.*dict"):
            Model(Both, "it")


class Geo(unittest.TestCase):
    def test_volume_centroid_and_gradient_are_geos(self):
        pairs = some_pairs(400)
        for name in ("geo", "geo-small"):
            x = torch.tensor(pairs, requires_grad=True)
            got, wanted = geo.Geo(name)(x), tetlap.overlap(pairs, name, centroid=True)
            (gradient,) = torch.autograd.grad(got["volume"].sum(), x)
            there = wanted.volume > 0
            volume, size = wanted.volume[there], np.abs(wanted.gradient[there]).max((1, 2))
            self.assertGreater(min(there[:400].sum(), there[400:800].sum(), there[800:].sum()), 50)
            np.testing.assert_array_equal(got["volume"].detach().numpy() > 0, there)
            self.assertLess(np.abs(got["volume"].detach().numpy()[there] / volume - 1).max(), 1e-8)
            self.assertLess((np.abs(got["centroid"].detach().numpy() - wanted.centroid)[there].max(1) / 0.01).max(), 1e-8)
            self.assertLess((np.abs(gradient.numpy() - wanted.gradient)[there].max((1, 2)) / size).max(), 1e-6)

    def test_a_run_is_that_of_geo(self):
        scene, histories = ROOT / "examples" / "02_two_blocks.yaml", []
        os.environ["TETLAP_PYTHON"] = sys.executable
        for model in ("geo", f"{ROOT}/examples/models/geo.py:Geo"):
            with tempfile.TemporaryDirectory() as folder:
                run = tetlap.run(scene, folder, overlap=model, set={"time.end": 0.05, "output.vtu": False})
                self.assertGreater(run.summary["contact_force_max"], 1)
                histories.append(np.genfromtxt(Path(folder, "history.csv"), delimiter=",", names=True))
        ours, theirs = histories
        self.assertEqual(len(ours), len(theirs))
        names = [name for name in ours.dtype.names if name.endswith("_J") or name.startswith("centre_")]
        self.assertGreater(len(names), 5)
        for name in names:
            scale = np.abs(ours["total_J" if name.endswith("_J") else name]).max()
            self.assertLess(np.abs(ours[name] - theirs[name]).max(), 1e-6 * scale, name)


if __name__ == "__main__":
    unittest.main()
