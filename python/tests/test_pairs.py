# SPDX-License-Identifier: Apache-2.0
"""Labelled pairs as arrays, and models of one's own measured on them."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

import tetlap

COUNT = 4000


def clip(pairs):
    r = tetlap.overlap(pairs, model="clip", order=1, centroid=True)
    return {"volume": r.volume, "gradient": r.gradient, "centroid": r.centroid}


class Pairs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.file = Path(cls.folder.name, "pairs.h5")
        subprocess.run([os.environ["TETLAP_PROGRAM"], "datagen", "--law", "scene", "--count", str(COUNT), "--gradient", "exact", "--seed", "5",
                        "-o", cls.file, "-q"], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_the_labels_are_those_of_the_library(self):
        pairs = tetlap.load_pairs(self.file)
        self.assertEqual(pairs.shape, (COUNT,))
        r = tetlap.overlap(pairs["coordinates"], model="exact", order=0, centroid=True)
        np.testing.assert_allclose(pairs["volume"], r.volume, rtol=1e-12, atol=0)
        np.testing.assert_allclose(pairs["centroid"], r.centroid, rtol=1e-9, atol=1e-12)
        touching = pairs["status"] == 1
        self.assertGreater(touching.sum(), COUNT // 2)
        self.assertTrue((pairs["volume"][~touching] == 0).all())
        self.assertEqual(pairs["gradient"].shape, (COUNT, 2, 4, 3))

    def test_the_rows_of_numbers_begin_at_whole_numbers(self):
        pairs = tetlap.load_pairs(self.file, count=20)
        for name in ("coordinates", "volume", "gradient"):
            self.assertTrue(all(step % 8 == 0 for step in pairs[name].strides), name)  # else torch.tensor refuses the array

    def test_a_range_is_the_same_pairs(self):
        whole, part = tetlap.load_pairs(self.file), tetlap.load_pairs(self.file, first=990, count=20)
        self.assertTrue((whole[990:1010] == part).all())
        with self.assertRaisesRegex(tetlap.RunError, f"has {COUNT} pairs; 20 from pair {COUNT - 10} on are not there"):
            tetlap.load_pairs(self.file, first=COUNT - 10, count=20)

    def test_a_function_is_graded_as_the_model_it_asks(self):
        ours, theirs = tetlap.evaluate(clip, self.file), tetlap.evaluate("clip", self.file)
        for key in ("count", "count_with_volume", "volume_error_sum", "moment_error", "gradient_error"):
            self.assertEqual(ours[key], theirs[key], key)

    def test_a_wrong_function_is_seen(self):
        double = tetlap.evaluate(lambda pairs: {**clip(pairs), "volume": 2 * clip(pairs)["volume"]}, self.file)
        self.assertAlmostEqual(double["volume_error_sum"], 1, delta=1e-9)

    def test_arrays_are_labelled_anew(self):
        pairs = tetlap.load_pairs(self.file, count=500)
        for data in (pairs, pairs["coordinates"]):
            self.assertLess(tetlap.evaluate(clip, data)["volume_error_sum"], 1e-9)
        with self.assertRaisesRegex(ValueError, r"\(500, 24\), expected \(n, 2, 4, 3\)"):
            tetlap.evaluate(clip, pairs["coordinates"].reshape(500, 24))

    def test_a_law_draws_pairs(self):
        got = tetlap.evaluate("geo", law="scene", mix={"scene": 1}, seed=3, count=1000)
        self.assertEqual(got["count"], 1000)
        self.assertTrue(1e-4 < got["volume_error_sum"] < 2e-2)

    def test_what_a_function_raises_is_the_cause(self):
        def broken(pairs):
            raise KeyError("weights")

        with self.assertRaisesRegex(tetlap.RunError, "broken: KeyError") as caught:
            tetlap.evaluate(broken, self.file)
        self.assertIsInstance(caught.exception.__cause__, KeyError)

    def test_wrong_calls(self):
        with self.assertRaisesRegex(TypeError, "either data or law"):
            tetlap.evaluate(clip)
        with self.assertRaisesRegex(tetlap.RunError, "is not a data set of pairs"):
            tetlap.load_pairs(__file__)


if __name__ == "__main__":
    unittest.main()
