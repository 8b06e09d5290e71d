# SPDX-License-Identifier: Apache-2.0
"""A `geo` trained on the forces that it makes in scenes, instead of on pairs.

    python3 train_in_place.py NEW.safetensors [SCENE.yaml ...] [--start geo-small] [--count 500] [--epochs 40]

`clip` runs the scenes: these, or so many of boxes that are pressed and moved across each other. In each frame the force on a vertex is a sum over
pairs, with the network's V and x̄ in it (nodal_forces.py). Adam makes least the errors of pairs and what they sum up to: errors of forces on
vertices, and of their sum on a body, relative to all forces of the frame. `--forces 0 --total 0` leaves errors of pairs alone, to compare:
benchmarks/learned.md does. Features are whitened first, as in `tetlap train`.
"""

import argparse
import math
import sys
from pathlib import Path

import nodal_forces
import numpy as np
import torch

import tetlap
import tetlap.torch

sys.path.append(str(Path(__file__).resolve().parents[1] / "models"))
import geo  # noqa: E402

BATCH, WARMUP, LONGEST = 24, 50, 1.0  # states a step; steps; the gradient's norm
TINY = 1e-12  # below which squares of relative errors do not count
LEAST = 1e-3  # of the largest forces of a run
WHITE = 1e-6  # added to variances before they are divided by
PERCENT = 1e-2  # the unit of relative errors in the loss


def random_scene(random, frames=3):
    """A box is pressed onto another, turned, some on an edge, and moved across it; static."""
    scale, turn = math.exp(random.uniform(-0.9, 0.5)), random.uniform(0, 2 * math.pi)
    tilt = random.choice([0, 0.05, math.pi / 4], p=[0.3, 0.45, 0.25])
    boxes = []
    for least, edge in ((4, 0.1), (3, 0.1 * scale)):
        cells = [*map(int, random.integers(least, least + 2, 2)), int(random.integers(2, 4))]
        wide = math.exp(random.uniform(-0.3, 0.3))
        boxes.append({"size": cells * np.array([wide, 1 / wide, math.exp(random.uniform(-1.6, 0.3))]) * edge, "cells": cells})
    low, high = (box["size"] for box in boxes)
    c, s = (math.cos(turn / 2), math.cos(tilt / 2)), (math.sin(turn / 2), math.sin(tilt / 2))  # turned about z, then tilted about x
    up = [math.sin(tilt) * math.sin(turn), math.sin(tilt) * math.cos(turn), math.cos(tilt)]  # the last row of that rotation
    middle = [math.cos(turn) * high[0] - math.sin(turn) * high[1],
              math.cos(tilt) * (math.sin(turn) * high[0] + math.cos(turn) * high[1]) - math.sin(tilt) * high[2]]
    depth = random.uniform(0.15, 0.6) * min(box["size"][2] / box["cells"][2] for box in boxes) * (1 if tilt < 0.5 else 2)
    slide, times, phase = random.uniform(0.03, 0.09) * scale, np.arange(1, frames + 1) / frames, random.uniform(0, 2 * math.pi)
    at = phase + 2 * np.pi * times
    way = np.stack([times, slide * np.sin(at), 0.4 * slide * np.sin(2 * at), -depth * (1 - 0.7 * np.cos(at))], 1)
    material = {"young": 1e5, "poisson": 0.3, "density": 1000}
    return {
        "time": {"end": 1, "static": True}, "output": {"frames": frames}, "contact": {"stiffness": 10 ** random.uniform(5, 7)},
        "bodies": [
            {"name": "lower", "mesh": {"box": boxes[0]}, "place": {"translate": -low * [0.5, 0.5, 1]}, "material": material,
             "fixed": [{"group": "z_min"}]},
            {"name": "upper", "mesh": {"box": boxes[1]}, "material": material,
             "place": {"rotate": {"axis": [s[1] * c[0], -s[1] * s[0], c[1] * s[0]], "degrees": math.degrees(2 * math.acos(c[1] * c[0]))},
                       "translate": [-middle[0] / 2, -middle[1] / 2, -np.minimum(0, up * high).sum()]},
             "driven": [{"group": "z_max", "table": np.concatenate((np.zeros((1, 4)), way))}]}]}


def states(scenes, runs_by="clip"):
    """The states of the frames of all scenes, but those in which bodies hardly touch."""
    for scene in scenes:
        found = [state for _, state in nodal_forces.states(tetlap.run(scene, overlap=runs_by))]
        sizes = [np.linalg.norm(state.forces(state.moments)) for state in found]
        yield from (state for state, size in zip(found, sizes) if size > LEAST * max(sizes))


class Block:
    """Some states: what no weight changes in their pairs, and how errors of these sum up, relative to all forces of each state."""

    def __init__(self, model, some):
        pairs = torch.from_numpy(np.concatenate([state.pairs for state in some]))
        with torch.no_grad():
            at, frame, _ = model.framed(pairs)  # clip answers for others
        self.features, self.vectors = frame.features, torch.einsum("nkm,nkc->nmc", frame.planes, frame.Q)
        self.start, self.Q, self.slack, self.share = frame.volume, frame.Q, frame.slack, 1 - frame.share
        self.moments = torch.from_numpy(np.concatenate([state.moments for state in some]))[at]
        number = np.full(len(pairs), -1)  # of a pair among those with a frame
        number[at.numpy()] = np.arange(len(at))
        parts, states, pair_count, row_count = [], [], 0, 0
        for n, state in enumerate(some):
            pair, size = number[pair_count + state.entry // 8], np.linalg.norm(state.forces(state.moments))
            push, rows = state.share[:, None] * state.push[state.entry // 8] / size, state.vertex.max() + 1
            of_first = np.where(state.body == 0, n, len(some))  # the row of the force on the first body; the last row is dropped
            parts.append([part[pair >= 0] for part in (row_count + state.vertex, 8 * pair + state.entry % 8, push, of_first)])
            pair_count, row_count = pair_count + len(state.pairs), row_count + rows
            states.append(np.full(rows, n))
        self.row, self.entry, self.push, self.of_first = (torch.from_numpy(np.concatenate(part)) for part in zip(*parts))
        self.state, self.count = torch.from_numpy(np.concatenate(states)), len(some)

    def whiten(self, white):
        self.features, self.vectors = (self.features - white.mean) @ white.features, white.vectors.T @ self.vectors
        for name in ("features", "vectors", "Q", "slack", "share", "push"):
            setattr(self, name, getattr(self, name).float())

    def errors(self, network, offset):
        """Of the moments, over V (n, 8)."""
        outputs = network(self.features)
        volume = self.start * torch.exp(offset + outputs[:, 0].double())
        change = (self.Q @ (outputs[:, None, 1:] @ self.vectors).mT)[..., 0]
        lowest = change.amin(1, keepdim=True)
        change = change * torch.where(lowest < -0.99, -0.99 / lowest, torch.ones_like(lowest))
        return self.share[:, None] * (volume[:, None] * self.slack * (1 + change) - self.moments) / self.moments[:, :4].sum(1, keepdim=True)

    def forces(self, errors):
        """Of each state (count): the errors of the forces on all vertices, and of their sum on the first body."""
        given = (errors * self.moments[:, :4].sum(1, keepdim=True)).flatten()[self.entry, None] * self.push
        nodal = given.new_zeros(len(self.state), 3).index_add(0, self.row, given)
        total = given.new_zeros(self.count + 1, 3).index_add(0, self.of_first, given)[:-1]
        return (given.new_zeros(self.count).index_add(0, self.state, (nodal**2).sum(1)) + TINY).sqrt(), ((total**2).sum(1) + TINY).sqrt()


class White:
    """Changes of coordinates after which features, and the vectors of which the centroid is made, are uncorrelated and of size 1."""

    def __init__(self, blocks):
        features = torch.cat([block.features for block in blocks])
        vectors = torch.cat([block.vectors.mT.flatten(0, 1) for block in blocks])
        self.mean = features.mean(0)
        self.features, self.vectors = self.whitening(features - self.mean), self.whitening(vectors)

    @staticmethod
    def whitening(x):
        size = (x * x).mean(0).sqrt()
        variance, axes = torch.linalg.eigh((x / size).T @ (x / size) / len(x))
        return axes / (variance.clamp(min=0) + WHITE).sqrt() / size[:, None]

    def enter(self, network):
        """The same network, of white features and for white vectors."""
        first, last = network.layer[0], network.layer[-1]
        with torch.no_grad():
            first.bias += first.weight @ self.mean
            first.weight.copy_(first.weight @ torch.linalg.inv(self.features).T)
            for tensor in (last.weight, last.bias):
                tensor[1:] = torch.linalg.solve(self.vectors, tensor[1:])
        return network

    def leave(self, network):
        first, last = network.layer[0], network.layer[-1]
        with torch.no_grad():
            first.weight.copy_(first.weight @ self.features.T)
            first.bias -= first.weight @ self.mean
            for tensor in (last.weight, last.bias):
                tensor[1:] = self.vectors @ tensor[1:]


def measure(blocks, network, offset):
    """Relative errors of forces on vertices and of those on a body, means over states, and of moments, mean over pairs."""
    sums, pairs = np.zeros(3), 0
    with torch.no_grad():
        for block in blocks:
            errors = block.errors(network, offset(network))
            sums += [float(part.sum()) for part in (*block.forces(errors), abs(errors))]
            pairs += len(errors)
    return sums / (*2 * [sum(block.count for block in blocks)], pairs)


def train(model, states, forces=1.0, total=1.0, pairs=1.0, epochs=40, rate=5e-4, seed=1):
    """Trains the model's network. Yields the epoch and `measure` of every tenth block, which is left out if there are more than one, at the start and
    after each tenth of the epochs."""
    random = np.random.default_rng(seed)
    order = random.permutation(len(states))
    blocks = [Block(model, [states[n] for n in order[k:k + BATCH]]) for k in range(0, len(order), BATCH)]
    white = White(blocks)
    for block in blocks:
        block.whiten(white)
    network, onset = white.enter(model.network).float(), ((model.onset - white.mean) @ white.features).float()

    def offset(network):
        return math.log(1.28) - network(onset)[0, 0]

    kept, blocks = blocks[::10], [block for n, block in enumerate(blocks) if n % 10] or blocks
    optimiser, steps = torch.optim.Adam(network.parameters(), lr=rate), epochs * len(blocks)
    schedule = torch.optim.lr_scheduler.LambdaLR(optimiser, lambda n: min(1, (n + 1) / WARMUP) * (1 + math.cos(math.pi * n / steps)) / 2)
    yield 0, measure(kept, network, offset)
    for epoch in range(1, epochs + 1):
        for n in random.permutation(len(blocks)):
            errors = blocks[n].errors(network, offset(network)) / PERCENT
            nodal, sums = blocks[n].forces(errors)
            own = torch.nn.functional.huber_loss(errors, torch.zeros_like(errors), reduction="sum") / len(errors)
            optimiser.zero_grad()
            (forces * nodal.mean() + total * sums.mean() + pairs * own).backward()
            torch.nn.utils.clip_grad_norm_(network.parameters(), LONGEST)
            optimiser.step()
            schedule.step()
        if epoch % max(1, epochs // 10) == 0:
            yield epoch, measure(kept, network, offset)
    white.leave(network.double())


def main(target, start="geo-small", scenes=(), count=500, seed=1, **options):
    random = np.random.default_rng(seed)
    model, weights = geo.Geo(start), tetlap.read_weights(start)
    found = list(states(scenes or (random_scene(random) for _ in range(count))))
    print(f"{len(found)} states, {sum(len(state.pairs) for state in found)} pairs")
    told = []
    for epoch, errors in train(model, found, seed=seed, **options):
        print(f"{epoch}: errors of forces on vertices {errors[0]:.3e}, on a body {errors[1]:.3e}, of moments of pairs {errors[2]:.3e}", flush=True)
        told.append(errors)
    tensors = {name: tensor.detach().to(torch.from_numpy(weights[name]).dtype) for name, tensor in model.network.named_parameters()}
    tetlap.write_weights(target, tensors, shape=weights.shape, normalisation=weights.normalisation, range=weights.range,
                         provenance=f"{weights.provenance}; then examples/python/train_in_place.py")
    return told


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("target", metavar="NEW.safetensors")
    parser.add_argument("scenes", nargs="*", metavar="SCENE.yaml")
    parser.add_argument("--start", default="geo-small")
    parser.add_argument("--count", type=int, default=500, help="of random scenes, where no files are named")
    parser.add_argument("--epochs", type=int, default=40)
    parser.add_argument("--rate", type=float, default=5e-4)
    parser.add_argument("--seed", type=int, default=1)
    for name, what in (("forces", "forces on vertices"), ("total", "the force on a body"), ("pairs", "each pair")):
        parser.add_argument(f"--{name}", type=float, default=1.0, help=f"weight of the errors of {what}")
    given = parser.parse_args()
    if given.count < 1 or given.epochs < 1:
        parser.error("--count and --epochs: expected 1 or more")
    try:
        geo.Geo(given.start)
    except (tetlap.Error, ValueError) as reason:
        parser.error(f"--start: {reason}")
    main(**vars(given))
