# SPDX-License-Identifier: Apache-2.0
"""A `geo` trained on the forces that it makes in scenes, instead of on pairs.

    python3 train_in_place.py NEW.safetensors [--start geo-small] [--scenes 500] [--epochs 40] [SCENE.yaml ...]

`clip` runs the scenes: these, or so many of boxes that are pressed and moved across each other. In each frame the force on a vertex is a sum over
pairs, with the network's V and x̄ in it (nodal_forces.py). Adam makes least what its errors sum up to: errors of forces on vertices, and of their
sum on a body, relative to all forces of the frame. So errors of neighbouring pairs learn to cancel. `--loss pairs` takes each pair's own errors
instead, to compare.

Features are whitened first, as in `tetlap train`. Weights as they are in the file have no common scale, and steps along their gradient lead nowhere.
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


def states(scenes):
    """The states of the frames of all scenes, run by clip. A scene that fails gives what it wrote."""
    for scene in scenes:
        try:
            run = tetlap.run(scene, overlap="clip")
        except tetlap.RunError as failure:
            print(failure, file=sys.stderr)
            continue
        yield from (state for _, state in nodal_forces.states(run))


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
        parts, pair_count, self.row_count = [], 0, 0
        for n, state in enumerate(some):
            pair, size = number[pair_count + state.entry // 8], np.linalg.norm(state.forces(state.moments))
            push, on_first = (state.share[:, None] * state.push[state.entry // 8] / size), state.body == 0
            parts.append([part[pair >= 0] for part in (self.row_count + state.vertex, 8 * pair + state.entry % 8, push, np.full(len(pair), n), on_first)])
            pair_count, self.row_count = pair_count + len(state.pairs), self.row_count + state.vertex.max() + 1
        self.row, self.entry, self.push, self.state, self.on_first = (torch.from_numpy(np.concatenate(part)) for part in zip(*parts))
        self.count = len(some)

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
        """Errors of forces on vertices (rows, 3), and of the sum on the first body of each state (count, 3)."""
        given = (errors * self.moments[:, :4].sum(1, keepdim=True)).flatten()[self.entry, None] * self.push
        return (given.new_zeros(self.row_count, 3).index_add(0, self.row, given),
                given.new_zeros(self.count, 3).index_add(0, self.state[self.on_first], given[self.on_first]))


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
        return network.float()

    def leave(self, network):
        network.double()
        first, last = network.layer[0], network.layer[-1]
        with torch.no_grad():
            first.weight.copy_(first.weight @ self.features.T)
            first.bias -= first.weight @ self.mean
            for tensor in (last.weight, last.bias):
                tensor[1:] = self.vectors @ tensor[1:]


def relative(blocks, network, offset_of):
    """Errors of forces on vertices and of total forces, root mean squares over states, and of moments, mean over pairs."""
    with torch.no_grad():
        sums, pairs, count = np.zeros(3), 0, 0
        for block in blocks:
            errors = block.errors(network, offset_of(network))
            sums += [float((part**2).sum()) for part in block.forces(errors)] + [float(errors.abs().sum())]
            pairs, count = pairs + errors.numel() / 8, count + block.count
    return math.sqrt(sums[0] / count), math.sqrt(sums[1] / count), sums[2] / pairs


def train(model, states, loss="forces", total=1.0, epochs=40, rate=1e-3, seed=1, quiet=False):
    """Trains the model's network. Every tenth block is left out, where there are several; of these `relative` before and after each tenth of the epochs."""
    random = np.random.default_rng(seed)
    order = random.permutation(len(states))
    blocks = [Block(model, [states[n] for n in order[k:k + BATCH]]) for k in range(0, len(order), BATCH)]
    white = White(blocks)
    for block in blocks:
        block.whiten(white)
    network, onset = white.enter(model.network), ((model.onset - white.mean) @ white.features).float()

    def offset_of(network):
        return math.log(1.28) - network(onset)[0, 0]

    kept, blocks = blocks[::10], [block for n, block in enumerate(blocks) if n % 10] or blocks
    optimiser = torch.optim.Adam(network.parameters(), lr=rate)
    step_count, told = epochs * len(blocks), [relative(kept, network, offset_of)]
    schedule = torch.optim.lr_scheduler.LambdaLR(optimiser, lambda n: min(1, (n + 1) / WARMUP) * (1 + math.cos(math.pi * n / step_count)) / 2)
    for epoch in range(epochs):
        for n in random.permutation(len(blocks)):
            errors = blocks[n].errors(network, offset_of(network))
            if loss == "pairs":
                value = torch.nn.functional.huber_loss(errors / PERCENT, torch.zeros_like(errors))
            else:
                nodal, sums = blocks[n].forces(errors / PERCENT)
                value = ((nodal**2).sum() + total * (sums**2).sum()) / blocks[n].count
            optimiser.zero_grad()
            value.backward()
            torch.nn.utils.clip_grad_norm_(network.parameters(), LONGEST)
            optimiser.step()
            schedule.step()
        if (epoch + 1) % max(1, epochs // 10) == 0:
            told.append(relative(kept, network, offset_of))
            if not quiet:
                print(f"{epoch + 1}: errors of forces on vertices {told[-1][0]:.3e}, total {told[-1][1]:.3e}, of pairs' moments {told[-1][2]:.3e}", flush=True)
    white.leave(network)
    return told


def main(target, start="geo-small", scenes=(), count=500, seed=1, **options):
    random = np.random.default_rng(seed)
    model, weights = geo.Geo(start), tetlap.read_weights(start)
    found = list(states(scenes or (random_scene(random) for _ in range(count))))
    print(f"{len(found)} states, {sum(len(state.pairs) for state in found)} pairs")
    told = train(model, found, seed=seed, **options)
    tensors = {name: tensor.detach().to(torch.from_numpy(weights[name]).dtype) for name, tensor in model.network.named_parameters()}
    tetlap.write_weights(target, tensors, shape=weights.shape, normalisation=weights.normalisation, range=weights.range,
                         provenance=f"{weights.provenance}; then examples/python/train_in_place.py")
    return told


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("target", metavar="NEW.safetensors")
    parser.add_argument("scenes", nargs="*", metavar="SCENE.yaml")
    parser.add_argument("--start", default="geo-small")
    parser.add_argument("--scenes", dest="count", type=int, default=500, help="random ones, where no files are named")
    parser.add_argument("--epochs", type=int, default=40)
    parser.add_argument("--rate", type=float, default=1e-3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--loss", choices=("forces", "pairs"), default="forces")
    parser.add_argument("--total", type=float, default=1.0, help="weight of the force on a body")
    main(**vars(parser.parse_args()))
