# SPDX-License-Identifier: Apache-2.0
"""tetlap: overlap volumes of tetrahedra with their derivatives, and runs of the finite element program of that name.

Volumes are computed in this process, by the shared library:

    overlap                     volumes of pairs, gradients, Hessians
    mesh_overlap, mesh_pairs    of all tetrahedra of two meshes
    Model, models               the overlap models there are
    tetlap.torch.overlap        the same as a differentiable function of PyTorch tensors

        x = np.random.rand(1000, 2, 4, 3)               # pairs x 2 tetrahedra x 4 vertices x 3 coordinates
        tetlap.overlap(x).volume                        # (1000)

Runs are processes of their own, by the program. A scene is a file or a dict with the same keys (docs/scene.md):

    run, read                   a scene run to its end; what it wrote, as a Run with Frames
    Simulation                  a run that Python steps, reads, pushes on, branches
    map, Results                many of these side by side; what they gave, as arrays
    compare                     one scene with several overlap models, yours too
    gradient                    exact derivatives of a run by its scene's parameters
    tetlap.torch.run            the same scene as a differentiable function of PyTorch tensors
    poses                       overlap volume and wrench of many rigid poses of a body

        run = tetlap.run("examples/01_drop.yaml")
        run.history["total_J"], run.frames[-1].points   # (frames), (n, 3)

        with tetlap.Simulation("examples/01_drop.yaml") as sim:
            sim.advance(0.1)                            # [s]
            sim.contacts["block", "ground"].force       # (3) [N]

Models of overlap are measured on labelled pairs:

    load_pairs, evaluate        labelled pairs as arrays; how well a model, yours too, answers them
    read_weights, write_weights networks of tetlap's as arrays, to and from PyTorch
    wrapped                     a function with wrappers round it, as both= and fade= before a name
    verdict                     what a model, yours too, is fit for: to detect, for forces, to drive a motion

`tetlap.__version__` is the library's. Units are SI. Arrays are float64 of NumPy; shapes stand in parentheses, units in brackets. Wrong arguments raise TypeError or ValueError;
UnknownNameError (a KeyError) is a name that is not there, RunError a run that failed, with the program's own message and exit code, Error
all else that is tetlap's. Messages of the program go to the logger "tetlap": logging.basicConfig(level="INFO") shows them.
"""

try:
    import numpy as _  # noqa: F401
except ModuleNotFoundError as error:
    if error.name != "numpy":
        raise
    import sys

    raise ImportError(f"tetlap needs NumPy, which {sys.executable} does not have: install it there (Debian: python3-numpy; else `python3 -m pip install numpy`)") from None

from ._compare import Compared, Comparison, compare
from ._errors import Error, RunError, UnknownNameError
from ._gradient import gradient
from ._overlap.library import Model, models
from ._map import map  # noqa: A004
from ._pairs import evaluate, load_pairs
from ._poses import Poses, poses
from ._results import Frame, Frames, Run, read
from ._run import run
from ._simulation import Body, Contact, Drive, Loads, Simulation, State
from ._table import Failure, Results
from ._verdict import Verdict, verdict
from ._overlap.volumes import Flag, MeshPairs, Overlap, mesh_overlap, mesh_pairs, overlap
from ._overlap.weights import Weights, read_weights, write_weights
from ._overlap.wrapped import wrapped

__all__ = ["Body", "Compared", "Comparison", "Contact", "Drive", "Error", "Failure", "Flag", "Frame", "Frames", "Loads", "MeshPairs",
           "Model", "Overlap", "Poses", "Results", "Run", "RunError", "Simulation", "State", "UnknownNameError", "Verdict", "Weights",
           "compare",
           "evaluate", "gradient", "load_pairs", "map", "mesh_overlap", "mesh_pairs", "models", "overlap", "poses", "read", "read_weights", "run", "verdict", "wrapped", "write_weights"]


def __getattr__(name):
    if name == "__version__":
        from ._overlap.library import version

        return version()
    if name == "torch":
        from importlib import import_module

        return import_module(".torch", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
