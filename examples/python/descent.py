# SPDX-License-Identifier: Apache-2.0
"""L-BFGS: the least of a function whose gradient is known (J. Nocedal and S. Wright, Numerical Optimization, algorithms 7.4 and 3.1)."""

import numpy as np

MEMORY, SHORTEST, DECREASE = 8, 1e-4, 1e-4


def direction(gradient, pairs):
    """−H g, H the inverse of the second derivatives as the last steps s and changes of the gradient y tell it."""
    q, shares = gradient.copy(), []
    for s, y in reversed(pairs):
        shares.append(s @ q / (s @ y))
        q -= shares[-1] * y
    if pairs:
        q *= pairs[-1][0] @ pairs[-1][1] / (pairs[-1][1] @ pairs[-1][1])
    for (s, y), share in zip(pairs, reversed(shares)):
        q += (share - y @ q / (s @ y)) * s
    return -q


def minimise(function, x, longest, most=30, enough=1e-3):
    """The points of the descent from x and the values there. function: x → value, gradient. longest: of a step in any component of x, which
    should all be of order 1. It ends where a step lowers the value by less than this share, or after so many steps. A value of infinity says that
    the function cannot be found there; at the first x it must be."""
    x = np.array(x, dtype=float)
    value, gradient = function(x)
    if not (np.isfinite(value) and np.isfinite(gradient).all()):
        raise ValueError(f"the value {value} or the gradient {gradient} is not finite at the start, {x}: begin elsewhere")
    points, values, pairs = [x], [value], []
    while len(values) <= most:
        way = direction(gradient, pairs[-MEMORY:])
        if not way.any():
            break
        way *= min(1, longest / abs(way).max())
        share = 1
        while share > SHORTEST:
            tried_value, tried_gradient = function(x + share * way)
            if tried_value <= value + DECREASE * share * (gradient @ way):
                break
            share /= 3
        else:
            if not pairs:
                break
            pairs = []  # what was learned misleads: along the gradient once more
            continue
        if (tried_gradient - gradient) @ way > 0:
            pairs.append((share * way, tried_gradient - gradient))
        x, fall = x + share * way, value - tried_value
        value, gradient = tried_value, tried_gradient
        points.append(x), values.append(value)
        if fall < enough * value:
            break
    return np.array(points), np.array(values)
