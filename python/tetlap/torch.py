# SPDX-License-Identifier: Apache-2.0
"""Overlap volumes, and whole runs, as differentiable functions of PyTorch tensors.

    V = tetlap.torch.overlap(x)      x (…, 2, 4, 3) on the CPU, V (…)
    net = tetlap.torch.network(tetlap.read_weights("geo"))      the layers of a network of tetlap's
    q = tetlap.torch.run(scene, {"bodies.block.material.young": young}, ["force:block:z"])

The first derivative is the model's own ∇V. The second is its ∇²V, given as products with the vectors that autograd hands
down, so that no matrix of 24 x 24 is made; models without ∇²V refuse that, by name.
"""

from __future__ import annotations

import os
import tempfile
import warnings
from collections.abc import Mapping
from pathlib import Path

import torch

from ._errors import RunError
from ._gradient import gradient as _gradient_of_arrays
from ._overlap.library import Model
from ._scene import Scene, Settings, override_texts
from ._overlap.volumes import _model, overlap as _overlap_of_arrays
from ._overlap.weights import Weights, write_weights

__all__ = ["network", "overlap", "run"]


def _check(x):
    if not isinstance(x, torch.Tensor):
        raise TypeError(f"x is a {type(x).__name__}; expected a torch.Tensor (tetlap.overlap takes arrays)")
    if x.device.type != "cpu" or x.layout != torch.strided:
        raise ValueError(f"x is a {x.layout} tensor on {x.device}; expected a dense one on the CPU: x.cpu()")
    if x.dtype not in (torch.float64, torch.float32):
        raise TypeError(f"x has dtype {x.dtype}; expected torch.float64 or torch.float32")


def _as_array(tensor):
    return tensor.detach().numpy()


class _Volume(torch.autograd.Function):
    """V, which keeps ∇V for the way back."""

    @staticmethod
    def forward(ctx, x, model):
        needs_gradient = ctx.needs_input_grad[0]
        result = _overlap_of_arrays(_as_array(x), model, order=1 if needs_gradient else 0)
        if needs_gradient:
            ctx.save_for_backward(x)
            ctx.model, ctx.gradient = model, torch.from_numpy(result.gradient).to(x.dtype)
        return torch.as_tensor(result.volume).to(x.dtype)

    @staticmethod
    def backward(ctx, from_volume):
        (x,) = ctx.saved_tensors
        return from_volume[..., None, None, None] * _Gradient.apply(x, ctx.gradient, ctx.model), None


class _Gradient(torch.autograd.Function):
    """∇V, known already, as a function of x: its derivative is ∇²V."""

    @staticmethod
    def forward(ctx, x, gradient, model):
        ctx.save_for_backward(x)
        ctx.model = model
        return gradient.clone() if ctx.needs_input_grad[0] else gradient

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx, vector):
        (x,) = ctx.saved_tensors
        result = _overlap_of_arrays(_as_array(x), ctx.model, order=0, vector=_as_array(vector))
        return torch.from_numpy(result.product).to(x.dtype), None, None


def overlap(x: torch.Tensor, model: str | os.PathLike | Model = "clip", threads: int = 0) -> torch.Tensor:
    """The overlap volumes (…) of the pairs x (…, 2, 4, 3), of the same dtype; computed in float64 whatever that is.

    Differentiable once with every model, twice with those that have a Hessian. `model` and `threads` as for
    tetlap.overlap, and so is what is refused.
    """
    _check(x)
    return _Volume.apply(x, _model(model, threads))


class _Layers(torch.nn.Module):
    """layer.0 … layer.N of a weights file of kind mlp: features to outputs."""

    def __init__(self, weights):
        super().__init__()
        self.card = {key: getattr(weights, key) for key in ("shape", "normalisation", "range", "provenance")}
        count = len(weights.shape["hidden"]) + 1
        self.layer = torch.nn.ModuleList(torch.nn.Linear(*reversed(weights[f"layer.{k}.weight"].shape)) for k in range(count))
        self.activate = {"silu": torch.nn.functional.silu, "relu": torch.relu}[weights.shape["activation"]]
        tensors = {name: torch.from_numpy(value) for name, value in weights.items()}
        self.to(next(iter(tensors.values())).dtype).load_state_dict(tensors)

    def forward(self, x):
        for layer in self.layer[:-1]:
            x = self.activate(layer(x))
        return self.layer[-1](x)


def network(weights: Weights) -> torch.nn.Module:
    """The layers of a `geo` (tetlap.read_weights) as a torch.nn.Module: features (n, inputs) to outputs (n, outputs). Its
    state_dict is what tetlap.write_weights takes, with the same shape.

    ValueError: a network of another kind.
    """
    if weights.shape.get("kind") != "mlp":
        raise ValueError(f"a network of kind {weights.shape.get('kind')!r}; expected 'mlp', as geo's is")
    return _Layers(weights)


class _Run(torch.autograd.Function):
    """Quantities of a run, which keep their derivatives for the way back."""

    @staticmethod
    def forward(ctx, scene, keys, of, overrides, at, card, names, *values):
        of_values = [f"{key}={float(value)!r}" for key, value in zip(keys, values)]
        ctx.tensors = {}
        if card is None:
            found = _gradient_of_arrays(scene, of, keys, set=overrides + of_values, total=True, at=at)
        else:
            found = _run_with(scene, keys, of, overrides + of_values, at, card, dict(zip(names, values[len(keys):])))
            ctx.tensors = {name: torch.stack([torch.from_numpy(slope[name]) for slope in found["weights"]]) for name in names}
        for key, why in found["no_derivative"].items():
            raise RunError(f"{key}: {why}", 65, None)
        if found["contact_stiffness"] == "follows":
            _warn_of_choice(keys)
        ctx.derivative, ctx.dtypes = torch.from_numpy(found["derivative"]), [value.dtype for value in values]
        return torch.from_numpy(found["value"])

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx, from_values):
        slopes = list(from_values @ ctx.derivative) + [torch.tensordot(from_values, slope, 1) for slope in ctx.tensors.values()]
        return *[None] * 7, *(slope.to(dtype) for slope, dtype in zip(slopes, ctx.dtypes))


def _run_with(scene, keys, of, overrides, at, card, tensors):
    """A run by a network of these tensors."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "network.safetensors"
        write_weights(path, {name: tensor.detach() for name, tensor in tensors.items()}, **card)
        return _gradient_of_arrays(scene, of, keys, set=[*overrides, f"contact.overlap={path}"], total=True, at=at, weights=True)


def _warn_of_choice(keys):
    others = [key for key in keys if not key.endswith((".material.young", ".material.poisson"))]
    if others:
        warnings.warn(f"contact.stiffness is chosen by the program, and is taken as not depending on {', '.join(others)}; give the scene a "
                      "contact.stiffness", stacklevel=4)


def _check_parameters(parameters, network):
    if network is not None and not isinstance(network, _Layers):
        raise TypeError(f"network is a {type(network).__name__}; expected what tetlap.torch.network returns")
    if not parameters and network is None:
        raise ValueError("parameters is empty; expected {'bodies.block.material.young': tensor}")
    for key, value in parameters.items():
        if ".rest[" in key:
            raise ValueError(f"{key} is no value of a scene, which a run could be given; tetlap.gradient has derivatives by it")
        if not isinstance(value, torch.Tensor):
            raise TypeError(f"{key} is a {type(value).__name__}; expected a torch.Tensor")
        if value.dim() != 0 or value.device.type != "cpu":
            raise ValueError(f"{key} is a tensor of shape {tuple(value.shape)} on {value.device}; expected one number on the CPU")


def run(scene: Scene, parameters: Mapping[str, torch.Tensor], of: str | list[str], *, set: Settings = None,  # noqa: A002
        at: float | None = None, network: torch.nn.Module | None = None) -> torch.Tensor:
    """The quantities `of`, at the times that they name or `at` one (as of tetlap.gradient), a tensor (of) in float64.

    parameters: {key of the scene: tensor of one number}; they replace the scene's values. Differentiable once by all of them. A
    contact stiffness that the scene does not give follows E and ν.
    network: of `tetlap.torch.network`; it is the run's contact.overlap, and all its weights are differentiated by, too; `parameters`
    may then be empty.

    RunError: as of tetlap.gradient.
    """
    _check_parameters(parameters, network)
    keys, tensors = list(parameters), dict(network.named_parameters()) if network is not None else {}
    card = network.card if network is not None else None
    return _Run.apply(scene, keys, of, override_texts(set), at, card, list(tensors), *parameters.values(), *tensors.values())
