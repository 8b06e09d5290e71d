# SPDX-License-Identifier: GPL-3.0-or-later
"""use.py PREFIX MODULE…: imports the modules in this order and computes with each; tetlap comes from the environment PREFIX."""

import importlib
import sys

import numpy

prefix, order = sys.argv[1], sys.argv[2:]


def use_torch(torch):
    a = torch.rand(700, 700, dtype=torch.float64, generator=torch.Generator().manual_seed(1))
    b = torch.linalg.solve(a + 700 * torch.eye(700, dtype=torch.float64), a)
    assert torch.allclose((a + 700 * torch.eye(700, dtype=torch.float64)) @ b, a)


def use_tetlap(tetlap):
    assert tetlap.__file__.startswith(prefix), tetlap.__file__
    simplex = numpy.vstack([numpy.zeros(3), numpy.eye(3)])
    pairs = numpy.repeat(numpy.stack([simplex, simplex + [0.5, 0, 0]])[None], 5000, axis=0)
    for model, error in (("clip", 1e-15), ("exact", 1e-15), ("geo", 0.01), ("tpn", 0.01)):
        few = pairs if model != "exact" else pairs[:20]
        assert abs(tetlap.overlap(few, model).volume - 1 / 48).max() < error, model
    run = tetlap.run(prefix + "/" + SCENE, set={"time.end": 0.005})
    assert run.outcome == "finished"
    assert run.manifest["command"].startswith(prefix + "/"), run.manifest["command"]


use = {"torch": use_torch, "tetlap": use_tetlap}
import tetlap_program  # noqa: E402  no library comes with it

SCENE = tetlap_program.__file__[len(prefix) + 1:].replace("__init__.py", "share/tetlap/examples/01_drop.yaml")
modules = [(name, importlib.import_module(name)) for name in order]
for name, module in 2 * modules:
    use[name](module)

# What tetlap loads is the wheel's own, whatever else is in this process.
ours = [line.split()[-1] for line in open("/proc/self/maps") if "libtetlap-overlap" in line]
assert ours and all(path.startswith(prefix) for path in ours), ours
blas = {line.split()[-1] for line in open("/proc/self/maps") if line.split()[-1].startswith(prefix) and "openblas" in line}
assert len(blas) == 1, blas
if "torch" in order:
    import torch

    import tetlap.torch

    x = torch.tensor(numpy.stack([numpy.vstack([numpy.zeros(3), numpy.eye(3)]) + shift for shift in (0, 0.3)])[None], requires_grad=True)
    tetlap.torch.overlap(x).sum().backward()
    assert torch.isfinite(x.grad).all() and x.grad.abs().max() > 0
print("used:", *order)
