# SPDX-License-Identifier: Apache-2.0
"""Weights files: read, changed, written, and run by the program."""

import json
import tempfile
import unittest
from pathlib import Path

import numpy as np

import tetlap
from test_compare import SCENE


def silu(x):
    return x / (1 + np.exp(np.minimum(-x, 700)))


class Files(unittest.TestCase):
    def test_what_is_read_and_written_reads_the_same_and_is_the_same_model(self):
        weights = tetlap.read_weights("geo-small")
        self.assertEqual(weights.shape["kind"], "mlp")
        self.assertEqual(weights["layer.0.weight"].shape, (weights.shape["hidden"][0], weights.shape["inputs"]))
        self.assertIn("geo-small by tetlap", weights.provenance)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "same.safetensors")
            tetlap.write_weights(path, weights)
            again = tetlap.read_weights(path)
            self.assertEqual((again.shape, again.normalisation, again.range, again.provenance),
                             (weights.shape, weights.normalisation, weights.range, weights.provenance))
            for name, value in weights.items():
                np.testing.assert_array_equal(again[name], value)
                self.assertEqual(again[name].dtype, value.dtype)
            ours, theirs = (tetlap.evaluate(str(model), law="scene", seed=3, count=300, threads=1) for model in (path, "geo-small"))
            self.assertEqual(ours["volume_error_sum"], theirs["volume_error_sum"])
            self.assertEqual(ours["gradient_error"], theirs["gradient_error"])

    def test_a_changed_network_drives_a_scene_otherwise(self):
        weights = tetlap.read_weights("geo-small")
        last = f"layer.{len(weights.shape['hidden'])}.weight"
        weights[last] = np.float32(1.2) * weights[last]
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "mine.safetensors")
            tetlap.write_weights(path, weights, provenance="by hand")
            got = tetlap.compare(SCENE, {"geo-small": "geo-small", "mine": str(path)}, audit=1, threads=1)
            self.assertEqual(got["mine"].outcome, "finished")
            self.assertGreater(got["mine"].errors["audit_volume_error"], 0.01)

    def test_a_newer_file_and_one_of_another_kind_are_refused(self):
        weights = tetlap.read_weights("geo-small")
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "new.safetensors")
            tetlap.write_weights(path, weights)
            data = path.read_bytes()
            path.write_bytes(data.replace(b'"tetlap-net 1"', b'"tetlap-net 2"'))
            with self.assertRaisesRegex(tetlap.Error, "is of version 2 of the format, this package reads up to 1"):
                tetlap.read_weights(path)
            with self.assertRaisesRegex(tetlap.RunError, "tetlap-net 2"):
                tetlap.evaluate(str(path), law="scene", count=10, threads=1)
            path.write_bytes(b"\x02" + 7 * b"\0" + b"{}")
            with self.assertRaisesRegex(tetlap.Error, "its metadata have no format"):
                tetlap.read_weights(path)
            path.write_bytes(data.replace(b'"shape"', b'"shake"', 1))
            with self.assertRaisesRegex(tetlap.Error, "its metadata have no format or no shape"):
                tetlap.read_weights(path)
            path.write_bytes(data[:100])
            with self.assertRaisesRegex(tetlap.Error, "no safetensors file"):
                tetlap.read_weights(path)
            with self.assertRaisesRegex(tetlap.Error, "No such file"):
                tetlap.read_weights(Path(folder, "none.safetensors"))

    def test_what_cannot_be_a_network_is_not_written(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "bad.safetensors")
            for kind, text, tensors in ((TypeError, "layer.0.bias is of int64", {"layer.0.bias": np.array([1])}),
                                        (ValueError, "three|one or two dimensions", {"a": np.zeros((1, 1, 1))}),
                                        (ValueError, "not finite", {"a": np.array([np.nan])})):
                with self.assertRaisesRegex(kind, text):
                    tetlap.write_weights(path, tensors, {"kind": "mlp"})
            with self.assertRaisesRegex(TypeError, "shape must be a dict"):
                tetlap.write_weights(path, {})
            self.assertEqual(list(Path(folder).iterdir()), [])

    def test_tensors_that_the_shape_does_not_ask_for_are_told_by_the_program(self):
        weights = tetlap.read_weights("geo-small")
        del weights["layer.0.bias"]
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "short.safetensors")
            tetlap.write_weights(path, weights)
            with self.assertRaisesRegex(tetlap.RunError, "layer.0.bias"):
                tetlap.evaluate(str(path), law="scene", count=10, threads=1)


class Torch(unittest.TestCase):
    def test_a_module_of_the_weights_is_the_network_and_goes_back(self):
        try:
            import torch
        except ImportError:
            self.skipTest("no PyTorch")
        import tetlap.torch

        weights = tetlap.read_weights("geo-small")
        net = tetlap.torch.network(weights)
        x = np.random.default_rng(1).normal(size=(5, weights.shape["inputs"]))
        expected = x  # the layers written out
        for k in range(len(weights.shape["hidden"])):
            expected = silu(expected @ weights[f"layer.{k}.weight"].T.astype(float) + weights[f"layer.{k}.bias"])
        k = len(weights.shape["hidden"])
        expected = expected @ weights[f"layer.{k}.weight"].T.astype(float) + weights[f"layer.{k}.bias"]
        np.testing.assert_allclose(net.double()(torch.from_numpy(x)).detach().numpy(), expected, rtol=1e-12, atol=1e-12)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "back.safetensors")
            tetlap.write_weights(path, tetlap.torch.network(weights).state_dict(), weights.shape, normalisation=weights.normalisation, range=weights.range)
            again = tetlap.read_weights(path)
            self.assertEqual(list(again), list(weights))
            for name, value in weights.items():
                np.testing.assert_array_equal(again[name], value)
            self.assertEqual(json.dumps(again.shape), json.dumps(weights.shape))

    def test_a_network_of_another_kind_is_refused(self):
        try:
            import tetlap.torch
        except ImportError:
            self.skipTest("no PyTorch")
        with self.assertRaisesRegex(ValueError, "a network of kind 'tpn'; expected 'mlp'"):
            tetlap.torch.network(tetlap.read_weights("tpn"))


if __name__ == "__main__":
    unittest.main()
