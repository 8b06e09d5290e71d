# SPDX-License-Identifier: Apache-2.0
"""Two pads close on a soft cube until both press with 4 N, hold it, and lift it.

    python3 grip.py            in the folder of gripper.yaml

The pads are moved by what they feel; the same in C: examples/embed/grip.c.
"""

import tetlap

SPEED, GRIP = 0.01, 4.0                                     # of a pad [m/s]; of each pad, when it is enough [N]
SIDES = {"left": 1, "right": -1}                            # where each closes along x


def presses(sim):
    return min(abs(sim.contacts["cube", pad].force[0]) for pad in SIDES)


def move(sim, closed, lifted, seconds):
    for pad, side in SIDES.items():
        sim.drive.set(pad, [side * closed, 0, lifted], ramp=seconds)


def lift(sim, item=None):
    move(sim, closed=SPEED * 0.5, lifted=0, seconds=0.5)
    closed = SPEED * sim.advance(until=0.5, stop=lambda sim: presses(sim) > GRIP)
    move(sim, closed, lifted=0, seconds=0.05)               # hold
    sim.advance(0.05)
    move(sim, closed, lifted=0.05, seconds=0.5)
    sim.advance(0.7)
    return {"height": sim.bodies["cube"].points[:, 2].mean(), "presses": presses(sim), "ground": sim.contacts["cube", "ground"].force[2],
            "carries": sum(sim.contacts["cube", pad].force[2] for pad in SIDES), "weight": 9.81 * sim.bodies["cube"].mass}


def main(scene="gripper.yaml"):
    with tetlap.Simulation(scene) as sim:
        told = lift(sim)
    for name, value in told.items():
        print(name, value)
    return told


if __name__ == "__main__":
    main()
