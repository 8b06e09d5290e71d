# SPDX-License-Identifier: Apache-2.0
"""Overlap volumes as a function that PyTorch differentiates."""

import unittest

import numpy as np
import torch

import tetlap
import tetlap.torch
from test_overlap import SIMPLEX, overlapping_pairs, shifted


# Step of the differences, and what they may be off in V's first and second derivatives, of 0.03 and 0.4 here. Networks in
# single precision have V to some 1e-8, which a short step would blow up.
DOUBLE, SINGLE = (1e-5, 1e-8, 1e-7), (1e-3, 5e-5, 1e-3)


class Derivatives(unittest.TestCase):
    def test_gradcheck_and_gradgradcheck(self):
        for name in [model.name for model in tetlap.models() if model.has_hessian]:
            with self.subTest(model=name):
                step, first, second = SINGLE if name in ("tpn-scene", "hybrid") else DOUBLE
                x = torch.tensor(overlapping_pairs(4), requires_grad=True)

                def volume(x):
                    return tetlap.torch.overlap(x, name)

                self.assertTrue(torch.autograd.gradcheck(volume, (x,), eps=step, atol=first, rtol=1e-6))
                self.assertTrue(torch.autograd.gradgradcheck(volume, (x,), eps=step, atol=second, rtol=1e-6))

    def test_gradcheck_of_models_without_hessian(self):
        x = torch.tensor(overlapping_pairs(4), requires_grad=True)
        self.assertTrue(torch.autograd.gradcheck(lambda x: tetlap.torch.overlap(x, "exact"), (x,), eps=1e-6, atol=1e-7))

    def test_a_model_without_hessian_refuses_a_second_derivative(self):
        x = torch.tensor(shifted(0.5), requires_grad=True)
        (gradient,) = torch.autograd.grad(tetlap.torch.overlap(x, "exact"), x, create_graph=True)
        with self.assertRaisesRegex(ValueError, "'exact' has no hessian; expected one of clip, "):
            gradient.square().sum().backward()

    def test_numbers_are_those_of_arrays(self):
        x = overlapping_pairs(8)
        expected = tetlap.overlap(x)
        tensor = torch.tensor(x, requires_grad=True)
        volume = tetlap.torch.overlap(tensor)
        np.testing.assert_array_equal(volume.detach().numpy(), expected.volume)
        (gradient,) = torch.autograd.grad(volume.sum(), tensor, create_graph=True)
        np.testing.assert_array_equal(gradient.detach().numpy(), expected.gradient)
        hessian = torch.autograd.functional.hessian(lambda x: tetlap.torch.overlap(x), tensor.detach()[0]).reshape(24, 24)
        np.testing.assert_allclose(hessian.numpy(), tetlap.overlap(x[0], order=2).hessian, atol=1e-12)

    def test_the_chain_rule_goes_on_beyond(self):
        """V of the shift s is (1 - s)³ / 6; its square's derivatives by s are known."""
        s = torch.tensor(0.25, dtype=torch.float64, requires_grad=True)
        simplex, axis = torch.tensor(SIMPLEX), torch.tensor([1.0, 0, 0], dtype=torch.float64)
        square = tetlap.torch.overlap(torch.stack([simplex, simplex + s * axis])) ** 2
        (first,) = torch.autograd.grad(square, s, create_graph=True)
        self.assertAlmostEqual(square.item(), 0.75**6 / 36, delta=1e-15)
        self.assertAlmostEqual(first.item(), -(0.75**5) / 6, delta=1e-14)


class Tensors(unittest.TestCase):
    def test_any_leading_shape_and_both_dtypes(self):
        for dtype in (torch.float64, torch.float32):
            for lead in ((), (1,), (2, 3), (3, 1, 2)):
                x = torch.rand(lead + (2, 4, 3), dtype=dtype, requires_grad=True)
                volume = tetlap.torch.overlap(x)
                self.assertEqual((volume.shape, volume.dtype), (torch.Size(lead), dtype))
                volume.sum().backward()
                self.assertEqual((x.grad.shape, x.grad.dtype), (x.shape, dtype))

    def test_single_precision_is_computed_in_double(self):
        x = torch.tensor(overlapping_pairs(8), dtype=torch.float32, requires_grad=True)
        array = x.detach().numpy().astype(float)
        expected = tetlap.overlap(array)
        volume = tetlap.torch.overlap(x)
        np.testing.assert_array_equal(volume.detach().numpy(), expected.volume.astype(np.float32))
        (gradient,) = torch.autograd.grad(volume.sum(), x, create_graph=True)
        np.testing.assert_array_equal(gradient.detach().numpy(), expected.gradient.astype(np.float32))
        (product,) = torch.autograd.grad(gradient.sum(), x)
        np.testing.assert_allclose(product.numpy().reshape(8, 24), tetlap.overlap(array, order=2).hessian.sum(axis=2), rtol=1e-5, atol=1e-5)

    def test_strides_do_not_matter(self):
        x = torch.tensor(overlapping_pairs(6))
        turned = x.permute(3, 2, 1, 0).contiguous().permute(3, 2, 1, 0).requires_grad_(True)
        self.assertFalse(turned.is_contiguous())
        volume = tetlap.torch.overlap(turned)
        self.assertTrue(torch.equal(volume, tetlap.torch.overlap(x)))
        volume.sum().backward()
        np.testing.assert_array_equal(turned.grad.numpy(), tetlap.overlap(x.numpy()).gradient)

    def test_nothing_is_kept_where_nothing_is_differentiated(self):
        volume = tetlap.torch.overlap(torch.tensor(shifted(0.5)))
        self.assertFalse(volume.requires_grad)

    def test_what_is_wrong_is_said(self):
        with self.assertRaisesRegex(TypeError, "x is a tensor that requires grad; expected x.detach"):
            tetlap.overlap(torch.tensor(shifted(0.5), requires_grad=True))
        for kind, text, bad in (
            (TypeError, "x is a ndarray; expected a torch.Tensor", shifted(0.5)),
            (TypeError, "x has dtype torch.int64; expected torch.float64 or torch.float32", torch.zeros((2, 4, 3), dtype=torch.int64)),
            (TypeError, "x has dtype torch.float16", torch.zeros((2, 4, 3), dtype=torch.float16)),
            (ValueError, "on meta; expected a dense one on the CPU", torch.zeros((2, 4, 3), device="meta")),
            (ValueError, r"x has shape \(0, 2, 4, 3\), no pair at all", torch.zeros((0, 2, 4, 3))),
            (ValueError, r"x has shape \(4, 3\); expected", torch.zeros((4, 3))),
            (ValueError, "pair 0, tetrahedron 0, vertex 0: coordinate x is", torch.full((2, 4, 3), float("nan"))),
        ):
            with self.subTest(text=text), self.assertRaisesRegex(kind, text):
                tetlap.torch.overlap(bad)


if __name__ == "__main__":
    unittest.main()
