# SPDX-License-Identifier: Apache-2.0
"""The examples reach what they promise."""

import os
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(os.environ["TETLAP_SOURCE_DIR"], "examples", "python")))


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


if __name__ == "__main__":
    unittest.main()
