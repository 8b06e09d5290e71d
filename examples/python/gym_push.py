# SPDX-License-Identifier: Apache-2.0
"""A gymnasium environment: push a soft block along the floor to a mark by a force on it.

    python3 gym_push.py        one episode with a proportional controller

Observed are the block's place and speed along x [m, m/s] and the mark; the action is a force along x [N], held for .02 s.
"""

import gymnasium
import numpy as np

import tetlap

MATERIAL = {"young": 2e5, "poisson": 0.3, "density": 1000, "damping": 1e-3}
SCENE = {"time": {"end": 1}, "effects": {"gravity": [0, 0, -9.81]}, "contact": {"friction": 0.2},
         "bodies": [{"name": "block", "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": 2}}, "material": MATERIAL, "loads": [{"all": True, "external": True}]}],
         "obstacles": [{"name": "floor", "halfspace": {"point": [0, 0, 0], "normal": [0, 0, 1]}}]}


class Push(gymnasium.Env):
    observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (3,))
    action_space = gymnasium.spaces.Box(-8.0, 8.0, (1,))

    def __init__(self):
        self.sim = tetlap.Simulation(SCENE, threads=1)
        self.begin, self.block = self.sim.state(), self.sim.bodies["block"]

    def observe(self):
        return np.array([self.block.points[:, 0].mean() - 0.05, self.block.velocities[:, 0].mean(), self.mark], np.float32)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.mark = self.np_random.uniform(0.02, 0.05)
        self.sim.restore(self.begin)
        return self.observe(), {}

    def step(self, action):
        self.sim.loads["block"] = [float(np.clip(action, -8, 8)[0]), 0, 0]
        self.sim.advance(until=min(self.sim.time + 0.02, self.sim.end))
        miss = abs(self.observe()[0] - self.mark)
        return self.observe(), -miss, bool(miss < 1e-3), self.sim.time >= self.sim.end, {}

    def close(self):
        self.sim.close()


def main(seed=1):
    env = Push()
    (x, v, mark), _ = env.reset(seed=seed)
    ends = False
    while not ends:
        (x, v, mark), reward, reached, late, _ = env.step(np.array([200 * (mark - x) - 10 * v]))
        ends = reached or late
    print(f"block at {x:.4f} m, mark at {mark:.4f} m")
    env.close()
    return float(x), float(mark), reached


if __name__ == "__main__":
    main()
