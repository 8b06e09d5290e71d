# SPDX-License-Identifier: Apache-2.0
"""Many poses of a body."""

import unittest

import numpy as np

import tetlap

SOFT = {"young": 1e5, "poisson": 0.3, "density": 1000}
BLOCKS = {
    "time": {"end": 1},
    "bodies": [
        {"name": "upper", "mesh": {"box": {"size": [1, 1, 1], "cells": 4}}, "place": {"translate": [-0.4, -0.3, 0]}, "material": SOFT},
        {"name": "lower", "mesh": {"box": {"size": [2, 2, 2], "cells": 3}}, "place": {"translate": [-1, -1, -2]}, "material": SOFT},
    ],
}


def shifts(*ways):
    matrices = np.tile(np.eye(4), (len(ways), 1, 1))
    matrices[:, :3, 3] = ways
    return matrices


class Poses(unittest.TestCase):
    def test_blocks_overlap_as_a_hand_computes(self):
        answers = tetlap.poses(BLOCKS, shifts([0, 0, 0.5], [0.01, -0.02, -0.2]))
        np.testing.assert_allclose(answers.volume, [0, 0.2], atol=1e-12)
        np.testing.assert_allclose(answers.force, [[0, 0, 0], [0, 0, 1]], atol=1e-12)
        np.testing.assert_allclose(answers.moment, np.zeros((2, 3)), atol=1e-12)

    def test_shapes_of_poses_mean_the_same(self):
        whole = shifts([0.01, -0.02, -0.2], [0, 0.1, -0.3])
        rows = np.concatenate([whole[:, :3, :3].reshape(-1, 9), whole[:, :3, 3]], axis=1)
        expected = tetlap.poses(BLOCKS, whole)
        # 1 m² by what it is deep: the blocks overlap, so that equal answers say something
        np.testing.assert_allclose(expected.volume, [0.2, 0.3], atol=1e-12)
        for form in (rows, whole[:, :3]):
            for a, b in zip(expected, tetlap.poses(BLOCKS, form)):
                np.testing.assert_array_equal(a, b)

    def test_a_device_gives_the_same_bits(self):
        options = {"random": 6, "shift": 0.1, "set": {"bodies[0].place.translate": [-0.4, -0.3, -0.3]}}
        expected = tetlap.poses(BLOCKS, **options)
        self.assertGreater(expected.volume.min(), 0.1)
        for a, b in zip(expected, tetlap.poses(BLOCKS, device="host", **options)):
            np.testing.assert_array_equal(a, b)

    def test_the_other_body_feels_the_opposite(self):
        still = shifts([0, 0, 0])
        options = {"set": {"bodies[0].place.translate": [-0.4, -0.3, -0.3]}}
        upper, lower = (tetlap.poses(BLOCKS, still, body=body, **options) for body in ("upper", "lower"))
        np.testing.assert_allclose(upper.volume, [0.3], atol=1e-12)  # 1 m² by 0.3 m
        np.testing.assert_allclose(lower.volume, upper.volume, rtol=1e-13)
        np.testing.assert_allclose(upper.force, [[0, 0, 1]], atol=1e-12)
        np.testing.assert_allclose(upper.force, -lower.force, atol=1e-13)

    def test_what_is_wrong_is_said(self):
        with self.assertRaisesRegex(ValueError, "expected \\(n, 12\\)"):
            tetlap.poses(BLOCKS, np.zeros((3, 3)))
        with self.assertRaisesRegex(TypeError, "either poses or random"):
            tetlap.poses(BLOCKS)
        with self.assertRaisesRegex(tetlap.RunError, "not a rotation"):
            tetlap.poses(BLOCKS, np.zeros((1, 12)))
        with self.assertRaisesRegex(tetlap.RunError, "no body 'none'"):
            tetlap.poses(BLOCKS, random=1, body="none")


if __name__ == "__main__":
    unittest.main()
