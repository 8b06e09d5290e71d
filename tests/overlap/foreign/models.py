# SPDX-License-Identifier: GPL-3.0-or-later
"""Models of test_foreign_process.c."""

import os
import subprocess
import time

import numpy as np


def box(pairs):
    """The overlap of the two bounding boxes."""
    low, high = pairs.min(axis=2).max(axis=1), pairs.max(axis=2).min(axis=1)
    return {"volume": np.prod(np.clip(high - low, 0, None), axis=1), "centroid": (low + high) / 2}


def alone(pairs):
    return box(pairs)["volume"]


def with_all(pairs):
    n = len(pairs)
    return {"volume": np.full(n, 0.5), "gradient": np.arange(24.0 * n).reshape(n, 2, 4, 3), "centroid": np.ones((n, 3)),
            "logit": np.arange(n) - 1.5, "doubt": np.full(n, 0.25)}


def ranged(pairs):
    """The doubt is a third of the first coordinate."""
    n = len(pairs)
    slope = np.zeros((n, 24))
    slope[:, 0] = 1 / 3
    return {"volume": np.full(n, 1e-4), "gradient": np.zeros((n, 2, 4, 3)), "doubt": pairs[:, 0, 0, 0] / 3,
            "doubt_gradient": slope.reshape(n, 2, 4, 3)}


ranged.range = "radius 0.1 to 0.7, first volume 0 to 0.04, second volume 0 to 0.04, overlap to 0.3"


def ranged_wrong(pairs):
    return box(pairs)


ranged_wrong.range = (0.1, 0.7)


class Made:
    def __call__(self, pairs):
        return box(pairs)


def raises(pairs):
    if len(pairs) > 1:
        raise ValueError("no more than one\npair")
    return box(pairs)


def wrong_shape(pairs):
    return {"volume": np.zeros((len(pairs), 1))}


def wrong_key(pairs):
    return {"volume": np.zeros(len(pairs)), "volumes": 1}


def no_volume(pairs):
    return {"centroid": np.zeros((len(pairs), 3))}


def shrinks(pairs):
    if len(pairs) > 1:
        os.ftruncate(4, 0)
    return box(pairs)


def has_no_77(pairs):
    if os.path.exists("/proc/self/fd/77"):
        raise ValueError("a file of the program is open")
    return box(pairs)


def no_numbers(pairs):
    return "many"


def complex_numbers(pairs):
    return np.zeros(len(pairs), complex)


def texts(pairs):
    return ["1"] * len(pairs)


def forgets(pairs):
    box(pairs)


def whole_numbers(pairs):
    return {"volume": np.ones(len(pairs), int), "centroid": np.ones((len(pairs), 3), np.float32)}


def changes_its_mind(pairs):
    answer = box(pairs)
    if len(pairs) > 1:
        del answer["centroid"]
    return answer


def dies(pairs):
    if len(pairs) > 1:
        os.kill(os.getpid(), 9)
    return box(pairs)


def leaves(pairs):
    if len(pairs) > 1:
        raise SystemExit(3)
    return box(pairs)


def hangs(pairs):
    if len(pairs) > 1:
        time.sleep(1000)
    return box(pairs)


def prints(pairs):
    print("one", len(pairs))
    return box(pairs)


def spoils(pairs):
    answer = box(pairs)
    pairs[:] = np.nan
    return answer


def forks(pairs):
    """The child comes back, too."""
    if len(pairs) > 1:
        os.fork()
    return box(pairs)


def starts_another(pairs):
    """Its volumes are the number of a process that it leaves behind."""
    other = subprocess.Popen(["sleep", "1000"], pass_fds=[3])
    return {"volume": np.full(len(pairs), float(other.pid))}


def dies_and_leaves_another(pairs):
    if len(pairs) > 1:
        subprocess.Popen(["sleep", "1000"], pass_fds=[3])
        os.kill(os.getpid(), 9)
    return box(pairs)


NUMBER = 3
