# SPDX-License-Identifier: Apache-2.0
"""The smallest rigid displacement that ends an overlap, by a PyTorch optimiser through tetlap's volumes.

    python3 separate.py

A beam lies over the edge of a block and dips into it with one end:

        ┌──────────────────────────────┐
        │ beam                         │            u: displacement of the beam's points; its size is the
        └────────────────────┲━━━━━━━━━┽┐           root of the mean of |u|² over the beam's volume
                             ┃ block    │
                             ┗━━━━━━━━━━┷

Straight up by the depth d ends the overlap. A beam that also turns, its far end sinking, gets away with less. The six
unknowns are a rotation vector and a translation; minimised is |u|²/d² + μ V, for rising weights μ, by L-BFGS, whose
gradients come through tetlap.torch.overlap. What little overlap is left is ended by stretching the displacement.

The optimum is known: the beam turns in the plane of the picture by an angle θ until its lower face goes through the block's
corner, after the shortest translation, along that face's normal (`known_size`); one unknown is left, θ.
"""

import math

import torch

import tetlap.torch

LENGTH, WIDTH, HEIGHT = 2.0, 0.4, 0.4  # of the beam [m]
DEPTH = 0.06  # by which it dips into the block [m]
CORNER = 0.6  # the block's corner, from the beam's middle [m]


def box(low, high, cells):
    """A box of cells x 1 x 1 cuboids of six tetrahedra each, (tetrahedra, 4, 3)."""
    low, high = torch.tensor(low, dtype=torch.float64), torch.tensor(high, dtype=torch.float64)
    steps = torch.eye(3, dtype=torch.float64)
    orders = [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]
    tets = []
    for cell in range(cells):
        for order in orders:
            path = [cell * steps[0]]
            for axis in order:
                path.append(path[-1] + steps[axis])
            tets.append(torch.stack(path))
    return low + torch.stack(tets) / torch.tensor([cells, 1.0, 1.0]) * (high - low)


def rotation(vector):
    """The matrix exp([vector]×), differentiable at 0 too."""
    x, y, z = vector
    zero = torch.zeros_like(x)
    cross = torch.stack([zero, -z, y, z, zero, -x, -y, x, zero]).reshape(3, 3)
    return torch.matrix_exp(cross)


def moved(tets, unknowns):
    """Tetrahedra of a body whose centre of mass is the origin, after the rigid displacement."""
    return tets @ rotation(unknowns[:3]).T + unknowns[3:]


def overlap_volume(tets_a, tets_b):
    """Of two bodies: the sum over all pairs of their tetrahedra."""
    shape = (len(tets_a), len(tets_b), 4, 3)
    pairs = torch.stack([tets_a[:, None].expand(shape), tets_b[None].expand(shape)], dim=2)
    return tetlap.torch.overlap(pairs).sum()


def mean_square(unknowns, second_moment):
    """Mean of |u|² over the body: |t|² + tr((R − 1) M (R − 1)ᵀ), M its second moment about its centre of mass."""
    turn = rotation(unknowns[:3]) - torch.eye(3, dtype=torch.float64)
    return unknowns[3:].square().sum() + torch.einsum("ij,jk,ik->", turn, second_moment, turn)


def second_moment():
    return torch.diag(torch.tensor([LENGTH**2, WIDTH**2, HEIGHT**2], dtype=torch.float64)) / 12


def descend(beam, block, unknowns, weight):
    """The minimum of |u|²/d² + weight · V from these unknowns."""
    unknowns = unknowns.clone().requires_grad_(True)
    optimiser = torch.optim.LBFGS([unknowns], max_iter=200, tolerance_grad=1e-9, tolerance_change=1e-14, line_search_fn="strong_wolfe")

    def cost():
        optimiser.zero_grad()
        value = mean_square(unknowns, second_moment()) / DEPTH**2 + weight * overlap_volume(moved(beam, unknowns), block)
        value.backward()
        return value

    optimiser.step(cost)
    return unknowns.detach()


def stretch(beam, block, unknowns):
    """The least multiple of the displacement, by bisection, that leaves no volume at all."""
    low, high = 1.0, 1.0
    while overlap_volume(moved(beam, high * unknowns), block) > 0:
        low, high = high, 1 + 2 * (high - 1) + 1e-6
    while high - low > 1e-9:
        middle = (low + high) / 2
        if overlap_volume(moved(beam, middle * unknowns), block) > 0:
            low = middle
        else:
            high = middle
    return high * unknowns


def separate(beam, block):
    """(rotation vector, translation) of the beam."""
    unknowns = torch.zeros(6, dtype=torch.float64)
    weight = 1 / overlap_volume(beam, block)
    for _ in range(8):
        unknowns = descend(beam, block, unknowns, weight)
        weight *= 10
    return stretch(beam, block, unknowns)


def known_size():
    """The least size over θ: the lower face's normal is (−sin θ, cos θ) in the plane of the picture."""

    def size(theta):
        shift = -CORNER * math.sin(theta) + (DEPTH - HEIGHT / 2) * math.cos(theta) + HEIGHT / 2
        return math.sqrt(max(shift, 0) ** 2 + 2 * (1 - math.cos(theta)) * (LENGTH**2 + HEIGHT**2) / 12)

    return min(size(k * 1e-6) for k in range(200000))


def scene():
    """Beam and block; the beam's centre of mass is the origin."""
    beam = box([-LENGTH / 2, -WIDTH / 2, -HEIGHT / 2], [LENGTH / 2, WIDTH / 2, HEIGHT / 2], 3)
    top = -HEIGHT / 2 + DEPTH
    block = box([CORNER, -0.5, top - 0.7], [CORNER + 0.9, 0.5, top], 1)
    return beam, block


def main():
    beam, block = scene()
    unknowns = separate(beam, block)
    size, known = math.sqrt(mean_square(unknowns, second_moment())), known_size()
    left = overlap_volume(moved(beam, unknowns), block).item()
    print(f"overlap before: {overlap_volume(beam, block).item():.6g} m3, after: {left:g} m3")
    print(f"rotation vector: {unknowns[:3].tolist()} rad")
    print(f"translation: {unknowns[3:].tolist()} m")
    print(f"size: {size:.8g} m; known optimum: {known:.8g} m; relative difference: {size / known - 1:.2e}")
    print(f"straight up it would be {DEPTH:g} m")
    return size, known, left


if __name__ == "__main__":
    main()
