# SPDX-License-Identifier: Apache-2.0
"""Networks in files of ONNX as overlap models; run by Pythons that have onnx and ONNX Runtime."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper

from tetlap import serve

AXES = helper.make_tensor("axes", TensorProto.INT64, [3], [1, 2, 3])
SHAPE = ["n", 2, 4, 3]


def network(path, kind=TensorProto.DOUBLE, shape=SHAPE, outputs=("volume",), inputs=("pairs",)):
    """Writes a file whose first output is Σ x², and whose second, if there is one, 2 x."""
    nodes = [helper.make_node("Mul", [inputs[0], inputs[0]], ["squares"]),
             helper.make_node("ReduceSum", ["squares", "axes"], [outputs[0]], keepdims=0)]
    results = [helper.make_tensor_value_info(outputs[0], kind, ["n"])]
    if len(outputs) > 1:
        nodes.append(helper.make_node("Add", [inputs[0], inputs[0]], [outputs[1]]))
        results.append(helper.make_tensor_value_info(outputs[1], kind, shape))
    given = [helper.make_tensor_value_info(name, kind, shape) for name in inputs]
    graph = helper.make_graph(nodes, "test", given, results, [AXES])
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)])
    model.ir_version = 7
    onnx.save(model, str(path))
    return str(path)


class Onnx(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name, "net.onnx")
        self.pairs = np.random.default_rng(3).random((20, 2, 4, 3))

    def test_a_single_output_is_the_volume(self):
        model = serve.load(network(self.path, TensorProto.FLOAT, outputs=("V",)))
        np.testing.assert_allclose(model(self.pairs)["volume"], (self.pairs**2).sum(axis=(1, 2, 3)), rtol=1e-5)
        self.assertEqual((model.name, model.gives), ("net.onnx", 0))

    def test_outputs_go_by_their_names(self):
        model = serve.load(network(self.path, outputs=("volume", "gradient")))
        answer = model(self.pairs, ("gradient",))
        np.testing.assert_allclose(answer["volume"], (self.pairs**2).sum(axis=(1, 2, 3)), rtol=1e-14)
        np.testing.assert_array_equal(answer["gradient"], 2 * self.pairs)
        self.assertEqual(model.gives, 1)

    def test_the_program_asks_it(self):
        network(self.path, outputs=("volume", "gradient"))
        file = self.path.with_name("pairs.npy")
        np.save(file, 0.1 * self.pairs.reshape(20, 24))
        out = self.path.with_name("told.npy")
        subprocess.run([os.environ["TETLAP_PROGRAM"], "overlap", "-q", "-m", f"keep={self.path}", str(file), "-o", str(out)], check=True,
                       env=dict(os.environ, TETLAP_PYTHON=sys.executable))
        told = np.load(out)
        np.testing.assert_allclose(told["volume"] if told.dtype.names else told[:, 0], 0.01 * (self.pairs**2).sum(axis=(1, 2, 3)), rtol=1e-12)

    def test_what_does_not_fit_is_told(self):
        for wrong, options in (("shape \\(n, 2, 4, 3\\); it has 'pairs' tensor\\(double\\)", {"shape": ["n", 24, 1, 1]}),
                               ("expected one input", {"inputs": ("pairs", "more")}), ("its input has 5 pairs", {"shape": [5, 2, 4, 3]}),
                               ("none of its outputs is named volume; it has V, gradient", {"outputs": ("V", "gradient")}),
                               ("returned 'slope'", {"outputs": ("volume", "slope")})):
            with self.subTest(wrong), self.assertRaisesRegex(serve.ModelError, wrong):
                serve.load(network(self.path, **options))
        self.path.write_bytes(b"no network")
        with self.assertRaisesRegex(serve.ModelError, "ONNX Runtime cannot read it"):
            serve.load(str(self.path))
        with self.assertRaisesRegex(serve.ModelError, "there is no such file"):
            serve.load("missing.onnx")


if __name__ == "__main__":
    unittest.main()
