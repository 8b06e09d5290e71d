# SPDX-License-Identifier: Apache-2.0
"""tetlap: overlap volumes of tetrahedra with their derivatives, and runs of the finite element program of that name.

    run, read            a scene run by the program; what it wrote, as arrays
"""

from ._errors import Error, RunError
from ._results import Frame, Frames, Run, read
from ._run import run

__all__ = ["Error", "Frame", "Frames", "Run", "RunError", "read", "run"]
