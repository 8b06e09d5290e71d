# SPDX-License-Identifier: Apache-2.0
"""Overlap volumes of arrays of pairs and of meshes."""

import dataclasses
import os
import re
import subprocess
import sys
import tempfile
import threading
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

import tetlap
from tetlap._overlap import library as _library

SIMPLEX = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)


def shifted(s):
    """A unit simplex and the same moved along x by s: what they share is a simplex of edge 1 - s."""
    return np.stack([SIMPLEX, SIMPLEX + [s, 0, 0]])


def overlapping_pairs(count, share=0.02, seed=7):
    """Pairs at random that share more than `share` of the smaller tetrahedron, and in which no vertex nears a face of
    the other: V is smooth about them."""
    x = np.random.default_rng(seed).random((60 * count, 2, 4, 3))
    found = tetlap.overlap(x, order=0)
    sizes = np.abs(np.linalg.det(x[:, :, 1:] - x[:, :, :1])).min(axis=1) / 6
    good = (found.volume > share * sizes) & (sizes > 0.02)
    assert good.sum() >= count
    return x[good][:count]


class Pairs(unittest.TestCase):
    def test_two_simplices_share_a_smaller_one(self):
        s = np.array([0.0, 0.25, 0.5, 0.9])
        result = tetlap.overlap(np.stack([shifted(value) for value in s]), order=1)
        np.testing.assert_allclose(result.volume, (1 - s) ** 3 / 6, rtol=1e-14)
        # Moving the second one along x changes V by d/ds of that; s = 0 is a kink.
        np.testing.assert_allclose(result.gradient[1:, 1, :, 0].sum(axis=1), -((1 - s[1:]) ** 2) / 2, rtol=1e-12)

    def test_derivatives_of_a_volume_are_homogeneous(self):
        """V is of degree 3: H x = 2 ∇V, and x · ∇V = 3 V."""
        x = overlapping_pairs(20)
        result = tetlap.overlap(x, order=2)
        flat = x.reshape(20, 24)
        np.testing.assert_allclose(np.einsum("nij,nj->ni", result.hessian, flat), 2 * result.gradient.reshape(20, 24), atol=1e-11)
        np.testing.assert_allclose((x * result.gradient).sum(axis=(1, 2, 3)), 3 * result.volume, atol=1e-14)

    def test_derivatives_are_those_of_differences(self):
        x, step = overlapping_pairs(20), 1e-6
        result = tetlap.overlap(x, order=2)
        for k in range(24):
            moved = np.zeros(24)
            moved[k] = step
            above, below = (tetlap.overlap(x + sign * moved.reshape(2, 4, 3)) for sign in (1, -1))
            np.testing.assert_allclose((above.volume - below.volume) / (2 * step), result.gradient.reshape(20, 24)[:, k], atol=1e-8)
            np.testing.assert_allclose((above.gradient - below.gradient).reshape(20, 24) / (2 * step), result.hessian[:, :, k], atol=1e-6)

    def test_a_product_with_the_hessian_is_that_product(self):
        x = overlapping_pairs(10)
        vector = np.random.default_rng(3).standard_normal(x.shape)
        result = tetlap.overlap(x, order=2, vector=vector)
        expected = np.einsum("nij,nj->ni", result.hessian, vector.reshape(10, 24)).reshape(x.shape)
        np.testing.assert_allclose(result.product, expected, atol=1e-12)
        np.testing.assert_array_equal(tetlap.overlap(x, order=0, vector=vector).product, result.product)

    def test_any_leading_shape(self):
        x = np.random.default_rng(1).random((6, 2, 4, 3))
        flat = tetlap.overlap(x, order=2)
        for lead in ((), (1,), (2, 3), (3, 1, 2)):
            count = int(np.prod(lead))
            result = tetlap.overlap(x[:count].reshape(lead + (2, 4, 3)), order=2)
            self.assertEqual(result.volume.shape, lead)
            self.assertEqual(result.flags.shape, lead)
            self.assertEqual(result.gradient.shape, lead + (2, 4, 3))
            self.assertEqual(result.hessian.shape, lead + (24, 24))
            np.testing.assert_array_equal(result.volume.ravel(), flat.volume[:count])
            np.testing.assert_array_equal(result.hessian.reshape(-1, 24, 24), flat.hessian[:count])

    def test_order_says_what_is_computed(self):
        x = shifted(0.5)
        result = tetlap.overlap(x, order=0)
        self.assertIsNone(result.gradient)
        self.assertIsNone(tetlap.overlap(x).hessian)
        self.assertIsNotNone(tetlap.overlap(x).gradient)
        self.assertIsNone(result.product)
        self.assertIsNone(result.centroid)

    def test_flags_tell_what_a_pair_is(self):
        flat = SIMPLEX.copy()
        flat[3] = [1, 1, 0]
        inner = 0.1 + 0.1 * SIMPLEX
        flags = tetlap.overlap(np.stack([shifted(2), np.stack([SIMPLEX, flat]), np.stack([SIMPLEX, inner])])).flags
        self.assertTrue(flags[0] & tetlap.Flag.DISJOINT)
        self.assertTrue(flags[1] & tetlap.Flag.FLAT)
        self.assertTrue(flags[2] & tetlap.Flag.ENCLOSED)

    def test_what_is_float64_and_contiguous_is_not_copied(self):
        from tetlap._overlap.volumes import _pairs

        x = np.random.default_rng(1).random((100, 2, 4, 3))
        x.flags.writeable = False
        self.assertTrue(np.shares_memory(_pairs(x), x))
        self.assertFalse(np.shares_memory(_pairs(x[::2]), x))
        np.testing.assert_array_equal(tetlap.overlap(x[::2]).volume, tetlap.overlap(x).volume[::2])

    def test_an_earlier_result_is_filled_anew(self):
        x = np.random.default_rng(1).random((2, 50, 2, 4, 3))
        earlier = tetlap.overlap(x[0])
        again = tetlap.overlap(x[1], out=earlier)
        self.assertIs(again, earlier)
        np.testing.assert_array_equal(again.gradient, tetlap.overlap(x[1]).gradient)

    def test_other_real_numbers_are_converted(self):
        x = shifted(0.5)
        for other in (x.astype(np.float32), x.astype(">f8"), np.asfortranarray(x), x.tolist()):
            self.assertEqual(tetlap.overlap(other).volume, tetlap.overlap(x).volume)
        whole = np.rint(4 * x).astype(int)
        self.assertEqual(tetlap.overlap(whole).volume, tetlap.overlap(whole.astype(float)).volume)

    def test_every_model_answers_and_can_what_it_says(self):
        x = overlapping_pairs(5)
        expected = tetlap.overlap(x, "exact", order=0).volume
        models = tetlap.models()
        self.assertIn("geo", [model.name for model in models])
        for model in models:
            with self.subTest(model=model.name):
                result = tetlap.overlap(x, model.name)
                # As its authors train it, it errs by 3e-3 of the unit cube on average, whatever the volume (docs/models.md).
                most = 2e-2 if model.name == "tpn-published" else 1e-3
                np.testing.assert_allclose(result.volume, expected, rtol=0.2, atol=most)
                self.assertTrue(np.isfinite(result.gradient).all())
                centroid = tetlap.overlap(x, model.name, centroid=True).centroid
                is_inside = (x.min(-2).max(-2) <= centroid) & (centroid <= x.max(-2).min(-2))
                self.assertTrue(is_inside[result.volume > 0].all())
                if model.has_hessian:
                    hessian = tetlap.overlap(x, model.name, order=2).hessian
                    np.testing.assert_allclose(hessian, hessian.transpose(0, 2, 1), atol=1e-9 * np.abs(hessian).max())
                else:
                    with self.assertRaisesRegex(ValueError, f"'{model.name}' has no hessian; expected one of clip"):
                        tetlap.overlap(x, model.name, order=2)

    def test_centroids_are_those_of_what_is_shared(self):
        s = np.array([0.25, 0.5, 0.9])
        result = tetlap.overlap(np.stack([shifted(value) for value in s]), centroid=True)
        # Of a simplex of edge 1 - s whose corner is at (s, 0, 0).
        expected = np.repeat((1 - s)[:, None] / 4, 3, axis=1)
        expected[:, 0] += s
        np.testing.assert_allclose(result.centroid, expected, rtol=1e-13)
        self.assertEqual(tetlap.overlap(shifted(2), centroid=True).centroid.tolist(), [0, 0, 0])

    def test_threads_of_python_share_a_model(self):
        x = np.random.default_rng(5).random((4, 5000, 2, 4, 3))
        model, results = tetlap.Model("clip", threads=1), [None] * 4

        def work(k):
            results[k] = [tetlap.overlap(x[k], model).gradient for _ in range(3)][-1]

        workers = [threading.Thread(target=work, args=(k,)) for k in range(4)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        for k in range(4):
            np.testing.assert_array_equal(results[k], tetlap.overlap(x[k]).gradient)


class WhatIsWrongWithPairs(unittest.TestCase):
    def refused(self, kind, text, *arguments, **options):
        with self.assertRaisesRegex(kind, text):
            tetlap.overlap(*arguments, **options)

    def test_shapes(self):
        self.refused(ValueError, r"x has shape \(5, 24\); expected \(…, 2, 4, 3\)", np.zeros((5, 24)))
        self.refused(ValueError, r"x has shape \(4, 3\); expected", SIMPLEX)
        self.refused(ValueError, r"vector has shape \(1, 2, 4, 3\); expected that of x", shifted(0), vector=shifted(0)[None])

    def test_an_empty_batch(self):
        self.refused(ValueError, r"x has shape \(0, 2, 4, 3\), no pair at all; expected one", np.zeros((0, 2, 4, 3)))

    def test_dtypes(self):
        for dtype in (complex, bool, object, np.longdouble):
            self.refused(TypeError, "x has dtype .*; expected float64", shifted(0.5).astype(dtype))
        self.refused(TypeError, "x has dtype .*; expected float64", np.full((2, 4, 3), "a"))

    def test_numbers_that_are_not_finite(self):
        for value in (np.nan, np.inf, -np.inf):
            x = np.random.default_rng(1).random((10, 2, 4, 3))
            x[7, 1, 2, 1] = value
            self.refused(ValueError, "pair 7, tetrahedron 1, vertex 2: coordinate y is", x)

    def test_an_earlier_result_of_another_kind(self):
        earlier = tetlap.overlap(shifted(0.5))
        self.refused(TypeError, "out is a ndarray; expected what an earlier", shifted(0), out=earlier.volume)
        self.refused(ValueError, r"out.volume is float64 of shape \(\); expected float64 of shape \(1,\)", shifted(0)[None], out=earlier)
        narrow = dataclasses.replace(earlier, gradient=earlier.gradient.astype(np.float32))
        self.refused(ValueError, "out.gradient is float32", shifted(0), out=narrow)
        turned = dataclasses.replace(earlier, gradient=np.zeros((3, 4, 2)).T)
        self.refused(ValueError, "out.gradient .* contiguous and writeable", shifted(0), out=turned)
        self.refused(ValueError, "out.gradient lies where x or vector does", earlier.gradient, out=earlier)
        self.refused(ValueError, "out has no hessian; expected the result", shifted(0), order=2, out=earlier)
        self.refused(ValueError, "out has a gradient; expected the result", shifted(0), order=0, out=earlier)

    def test_orders_and_models(self):
        self.refused(ValueError, r"order is 3; expected 0 \(V\), 1", shifted(0), order=3)
        self.refused(ValueError, "clipp.*clip", shifted(0), "clipp")
        self.refused(ValueError, "'exact' has no hessian; expected one of clip, ", shifted(0), "exact", order=2)
        self.refused(ValueError, "'exact' has no hessian; expected one of clip, ", shifted(0), "exact", vector=shifted(0))
        self.refused(ValueError, "threads is -1; expected", shifted(0), threads=-1)
        self.refused(ValueError, "threads is 2 beside a tetlap.Model", shifted(0), tetlap.Model(), threads=2)
        self.refused(OSError, "none.safetensors", shifted(0), "/nowhere/none.safetensors")
        self.refused(TypeError, "expected a name, a file, or a tetlap.Model .a function", shifted(0), np.sum)

    def test_a_file_that_was_written_anew_is_read_anew(self):
        weights = tetlap.read_weights("geo-small")
        with tempfile.TemporaryDirectory() as folder:
            file, volumes, x = Path(folder, "ä.safetensors"), [], np.random.default_rng(3).random((20, 2, 4, 3))
            for _ in range(2):
                tetlap.write_weights(file, weights)
                volumes.append(tetlap.overlap(x, f"both={file}").volume.sum())
                weights["layer.0.bias"] *= 1.5
        self.assertNotEqual(*volumes)


def cube(cells, origin=0.0):
    """A unit cube from `origin` on as cells³ cubes of six tetrahedra."""
    axis = origin + np.linspace(0, 1, cells + 1)
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange((cells + 1) ** 3).reshape((cells + 1,) * 3)
    corner = np.stack(np.meshgrid(*[np.arange(cells)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    tets = []
    for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)):
        path = [corner]
        for direction in order:
            path.append(path[-1] + np.eye(3, dtype=int)[direction])
        tets.append(np.stack([number[tuple(vertex.T)] for vertex in path], axis=1))
    return points, np.concatenate(tets)


class Meshes(unittest.TestCase):
    def test_two_meshes_of_one_cube_cover_each_other(self):
        pairs = tetlap.mesh_pairs(*cube(2), *cube(3))
        self.assertEqual(pairs.shape, (48, 162))
        np.testing.assert_allclose(np.bincount(pairs.i, pairs.volume), np.full(48, 1 / 48), rtol=1e-12)
        np.testing.assert_allclose(np.bincount(pairs.j, pairs.volume), np.full(162, 1 / 162), rtol=1e-12)

    def test_every_pair_that_overlaps_is_found(self):
        random = np.random.default_rng(2)
        points_a, points_b = random.random((60, 3)), random.random((60, 3))
        tets_a, tets_b = (np.stack([random.permutation(60)[:4] for _ in range(40)]) for _ in range(2))
        x = np.stack(np.broadcast_arrays(points_a[tets_a][:, None], points_b[tets_b][None]), axis=2)
        expected = tetlap.overlap(x, order=1)
        pairs = tetlap.mesh_pairs(points_a, tets_a, points_b, tets_b, order=1)
        found = np.zeros((40, 40))
        found[pairs.i, pairs.j] = pairs.volume
        np.testing.assert_array_equal(found, expected.volume)
        np.testing.assert_array_equal(pairs.gradient, expected.gradient[pairs.i, pairs.j])
        self.assertTrue((np.diff(pairs.i * 40 + pairs.j) > 0).all())

    def test_scipy_gets_a_matrix(self):
        try:
            from scipy import sparse
        except ImportError:
            self.skipTest("no python3-scipy")
        a, b = cube(2), cube(2, origin=0.5)
        matrix = tetlap.mesh_overlap(*a, *b)
        self.assertTrue(sparse.issparse(matrix))
        self.assertEqual(matrix.shape, (48, 48))
        self.assertAlmostEqual(matrix.sum(), 1 / 8, delta=1e-15)

    def test_without_scipy_it_is_the_pairs(self):
        with mock.patch.dict(sys.modules, {"scipy": None}):
            pairs = tetlap.mesh_overlap(*cube(1), *cube(1, origin=0.5))
        self.assertIsInstance(pairs, tetlap.MeshPairs)
        self.assertAlmostEqual(pairs.volume.sum(), 1 / 8, delta=1e-15)

    def test_meshes_that_do_not_meet_share_nothing(self):
        pairs = tetlap.mesh_pairs(*cube(1), *cube(1, origin=5.0), order=1)
        self.assertEqual((len(pairs.i), len(pairs.volume), pairs.gradient.shape), (0, 0, (0, 2, 4, 3)))
        self.assertIsNone(pairs.centroid)

    def test_what_is_wrong_with_a_mesh_is_said(self):
        points, tets = cube(1)
        for kind, text, bad in (
            (ValueError, r"points_b has shape \(24,\); expected \(points, 3\)", (points.ravel(), tets)),
            (ValueError, r"tets_b has shape \(24,\); expected \(tetrahedra, 4\)", (points, tets.ravel())),
            (TypeError, r"tets_b has dtype float64; expected integers", (points, tets.astype(float))),
            (ValueError, r"tets_b names vertices 1 to 8; expected 0 to 7", (points, tets + 1)),
            (ValueError, r"tets_b has no tetrahedron", (points, tets[:0])),
            (ValueError, r"points_b.* is not finite", (np.where(points == points[3], np.nan, points), tets)),
            (TypeError, r"points_b has dtype complex128", (points.astype(complex), tets)),
        ):
            with self.subTest(text=text), self.assertRaisesRegex(kind, text):
                tetlap.mesh_pairs(points, tets, *bad)
        with self.assertRaisesRegex(ValueError, "order is 2; expected 0"):
            tetlap.mesh_pairs(points, tets, points, tets, order=2)


class TheLibrary(unittest.TestCase):
    def setUp(self):
        self.header = Path(os.environ["TETLAP_SOURCE_DIR"], "include", "tetlap", "overlap.h").read_text()

    def fields_of(self, name):
        body = re.search(r"typedef struct %s \{(.*?)\} %s;" % (name, name), self.header, re.S).group(1)
        body = re.sub(r"/\*.*?\*/", "", body, flags=re.S)
        return [line.split()[-1].lstrip("*") for line in body.split(";") if line.strip()]

    def test_structs_are_those_of_the_header(self):
        for name in ("Options", "Info", "Batch", "Mesh", "List"):
            mirrored = [field[0] for field in getattr(_library, name)._fields_]
            self.assertEqual(mirrored, self.fields_of("TetlapOverlap" + name))

    def test_constants_are_those_of_the_header(self):
        constants = {name: eval(value) for name, value in re.findall(r"TETLAP_OVERLAP_(\w+) = ([0-9 <]+),", self.header)}
        self.assertEqual({flag.name: constants[flag.name] for flag in tetlap.Flag}, {flag.name: int(flag) for flag in tetlap.Flag})
        mirrored = ("INVALID", "NO_FILE", "MEMORY", "INTERNAL", "DEVICE", "VOLUME", "GRADIENT", "HESSIAN", "CENTROID")
        self.assertEqual({name: getattr(_library, name) for name in mirrored}, {name: constants[name] for name in mirrored})
        self.assertEqual(set(constants), {*mirrored, "OK", *(flag.name for flag in tetlap.Flag)})

    def test_every_function_that_is_called_is_in_the_header(self):
        for name in _library._FUNCTIONS:
            self.assertRegex(self.header, rf"\btetlap_overlap_{name}\(")

    def test_the_version_is_that_of_the_tree(self):
        source = Path(os.environ["TETLAP_SOURCE_DIR"], "CMakeLists.txt").read_text()
        self.assertEqual(tetlap.__version__, re.search(r"project\(tetlap VERSION ([0-9.]+)", source).group(1))

    def test_reading_a_run_loads_no_library(self):
        words = "import os, tetlap; assert 'libtetlap' not in open('/proc/self/maps').read()"
        subprocess.run([sys.executable, "-c", words], check=True)

    def test_a_python_without_numpy_is_told_to_install_it(self):
        words = "import sys; sys.modules['numpy'] = None; import tetlap"
        told = subprocess.run([sys.executable, "-c", words], capture_output=True, text=True, check=False).stderr
        self.assertIn("tetlap needs NumPy", told.splitlines()[-1])
        self.assertNotIn("_compare.py", told)

    def test_a_library_that_is_not_there_is_named(self):
        words = """if True:
            import os
            os.environ["TETLAP_LIBRARY"] = "/nowhere/lib.so"
            import numpy, tetlap
            try:
                tetlap.overlap(numpy.zeros((1, 2, 4, 3)))
            except tetlap.Error as error:
                assert "TETLAP_LIBRARY names /nowhere/lib.so, which is no file" in str(error), error
            else:
                raise SystemExit("no error")
        """
        subprocess.run([sys.executable, "-c", words], check=True)


if __name__ == "__main__":
    unittest.main()
