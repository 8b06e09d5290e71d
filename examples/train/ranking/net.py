# SPDX-License-Identifier: Apache-2.0
"""Small networks in PyTorch for tools/measure/ranking: V by the second tetrahedron's vertices in the frame of the first.

    python3 net.py OUT.pt activation=relu width=32 depth=2 gradient=0 orders=one data=scene samples=5e5 seed=1

writes OUT.pt and, beside it, OUT.py, which `tetlap verdict OUT.py` runs. Needs PyTorch, NumPy and the package tetlap."""
import sys
from pathlib import Path

import torch

SCALE = 33  # V of a normalised pair times this is of order 1
DEFAULTS = {"activation": "silu", "width": 32, "depth": 2, "gradient": 1.0, "orders": "one", "data": "both", "samples": 5e5, "seed": 1, "rate": 3e-3}
ACTIVATIONS = {"relu": torch.nn.ReLU, "silu": torch.nn.SiLU, "tanh": torch.nn.Tanh}
SOURCES = {"scene": ("scene", {"scene": 1}, 101), "random": ("paper-train", {"volumetric": 1}, 102)}
FAR = 3  # beyond it a coordinate counts by its logarithm


class Net(torch.nn.Module):
    def __init__(self, options):
        super().__init__()
        width, sizes = int(options["width"]), [12] + int(options["depth"]) * [int(options["width"])]
        layers = [part for a, b in zip(sizes, sizes[1:]) for part in (torch.nn.Linear(a, b), ACTIVATIONS[options["activation"]]())]
        self.layers = torch.nn.Sequential(*layers, torch.nn.Linear(width, 1))
        self.takes_both_orders = options["orders"] == "both"
        self.double()

    def one_order(self, first, second):
        edges = first[:, 1:] - first[:, :1]
        y = torch.linalg.solve(edges.transpose(1, 2), (second - first[:, :1]).transpose(1, 2)).transpose(1, 2)
        y = torch.where(y.abs() > FAR, y.sign() * FAR * (1 + (y.abs().clamp(min=FAR) / FAR).log()), y)
        return edges.det().abs() * self.layers(y.flatten(1)).squeeze(1) / SCALE

    def forward(self, pairs):
        a, b = pairs[:, 0], pairs[:, 1]
        volume = self.one_order(a, b)
        if self.takes_both_orders:
            volume = (volume + self.one_order(b, a)) / 2
        return volume.clamp(min=0) if not self.training else volume


def load(path):
    kept = torch.load(path)
    net = Net(kept["options"])
    net.load_state_dict(kept["weights"])
    return net


def draw(options, folder):
    """Pairs, V and its gradient, in units in which |det| of the first tetrahedron is 1."""
    import numpy as np
    import subprocess
    import tetlap
    from tetlap import _locate

    parts = []
    for name in ("scene", "random") if options["data"] == "both" else (options["data"],):
        law, mix, seed = SOURCES[name]
        file = folder / f"{name}.h5"
        if not file.exists():
            subprocess.run([_locate.program(), "datagen", "-q", "--law", law, "--mix", ",".join(f"{k}={v}" for k, v in mix.items()), "--count",
                            "20000", "--seed", str(seed), "--label", "clip", "--gradient", "clip", "-o", str(file)], check=True)
        parts.append(tetlap.load_pairs(file))
    pairs = np.concatenate([part[["coordinates", "volume", "gradient"]] for part in parts])
    x = torch.from_numpy(pairs["coordinates"].copy())
    size = (x[:, 0, 1:] - x[:, 0, :1]).det().abs()
    length = size ** (1 / 3)
    return (x / length[:, None, None, None], torch.from_numpy(pairs["volume"].copy()) / size,
            torch.from_numpy(pairs["gradient"].copy()) / length[:, None, None, None] ** 2)


def train(options, folder):
    torch.manual_seed(int(options["seed"]))
    net, (x, volume, gradient) = Net(options), draw(options, folder)
    steps, weight, huber = int(float(options["samples"]) / 256), float(options["gradient"]), torch.nn.HuberLoss(delta=0.05)
    optimiser = torch.optim.Adam(net.parameters(), lr=float(options["rate"]))
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, steps)
    for _ in range(steps):
        rows = torch.randint(len(x), (256,))
        batch = x[rows].requires_grad_(weight > 0)
        found = net(batch)
        loss = huber(SCALE * found, SCALE * volume[rows])
        if weight > 0:
            slope = torch.autograd.grad(found.sum(), batch, create_graph=True)[0]
            loss = loss + weight * huber(slope, gradient[rows])
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        schedule.step()
    return net


def main():
    out = Path(sys.argv[1])
    options = {**DEFAULTS, **dict(word.split("=", 1) for word in sys.argv[2:])}
    unknown = set(options) - set(DEFAULTS)
    if unknown:
        sys.exit(f"net.py: there is no {', '.join(sorted(unknown))}; known are {', '.join(DEFAULTS)}")
    net = train(options, out.parent)
    torch.save({"options": options, "weights": net.state_dict()}, out)
    here = Path(__file__).resolve().parent
    out.with_suffix(".py").write_text(f"import sys\n\nsys.path.append({str(here)!r})\nfrom net import load\n\nmodel = load({str(out.resolve())!r})\n")


if __name__ == "__main__":
    main()
