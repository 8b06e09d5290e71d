# SPDX-License-Identifier: Apache-2.0
"""tetlap: overlap volumes of tetrahedra with their derivatives, and runs of the finite element program of that name.

    overlap                     volumes of pairs, gradients, Hessians
    mesh_overlap, mesh_pairs    of all tetrahedra of two meshes
    tetlap.torch.overlap        the same as a differentiable function of PyTorch tensors
    Model, models               the overlap models there are
    run, read                   a scene run by the program; what it wrote, as arrays
    load_pairs, evaluate        labelled pairs as arrays; how well a model, yours too, answers them
    compare                     one scene with several models, yours too
    Simulation                  a run that Python steps, reads, pushes on, branches
    map, Results                many of them side by side; what they gave, as arrays
    gradient                    exact derivatives of a static scene by its parameters
    tetlap.torch.run            the same scene as a differentiable function of PyTorch tensors
    poses                       overlap volume and wrench of many rigid poses of a body
"""

from ._compare import Compared, Comparison, compare
from ._errors import Error, RunError, UnknownNameError
from ._gradient import gradient
from ._library import Model, models
from ._map import map  # noqa: A004
from ._pairs import evaluate, load_pairs
from ._poses import Poses, poses
from ._results import Frame, Frames, Run, read
from ._run import run
from ._simulation import Body, Contact, Drive, Loads, Simulation, State
from ._table import Failure, Results
from ._volumes import Flag, MeshPairs, Overlap, mesh_overlap, mesh_pairs, overlap

__all__ = ["Body", "Compared", "Comparison", "Contact", "Drive", "Error", "Failure", "Flag", "Frame", "Frames", "Loads", "MeshPairs", "Model", "Overlap",
           "Poses", "Results", "Run", "RunError", "Simulation", "State", "UnknownNameError", "compare", "evaluate", "gradient", "load_pairs",
           "map", "mesh_overlap", "mesh_pairs", "models", "overlap", "poses",
           "read", "run"]


def __getattr__(name):
    if name == "torch":
        from importlib import import_module

        return import_module(".torch", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
