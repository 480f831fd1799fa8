#!/usr/bin/env python3
"""What Python adds to a step and to reading 10⁴ bodies:  benchmarks/python_overhead.py"""

import time

import numpy as np

import taut


def best(work, repeats: int = 7) -> float:
    """Seconds of the fastest of several calls."""
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - start)
    return min(seconds)


def pendulum() -> taut.Simulator:
    world = taut.World()
    rod = world.add_body(mass=taut.MassProperties.rod(1.0, 0.01, mass=1.0), pose=taut.Pose(p=[0.5, 0, 0]))
    world.add("", taut.Hinge.at(world, taut.GROUND, rod, [0, 0, 0], [0, 1, 0]))
    return taut.Simulator(world, taut.Settings(threads=1))


def main() -> None:
    steps, dt = 20_000, 1e-4
    simulator = pendulum()

    def one_by_one() -> None:
        for _ in range(steps):
            simulator.step(dt)

    single, together = best(one_by_one) / steps, best(lambda: simulator.run(steps, dt)) / steps
    print(f"step of a pendulum: {1e6 * single:.2f} µs from Python, {1e6 * together:.2f} µs in run(): "
          f"{1e6 * (single - together):.2f} µs for Python")

    world = taut.World()
    for k in range(10_000):
        world.add_body(pose=taut.Pose(p=[k, 0, 0]))
    for name in ("positions", "twists", "poses_xyzw", "poses"):
        print(f"{name} of {world.body_count} bodies: {1e6 * best(lambda n=name: getattr(world, n)):.1f} µs")
    mean = best(lambda: world.positions[1:].mean(axis=0))
    print(f"their mean position by NumPy: {1e6 * mean:.1f} µs;  {np.round(world.positions[1:].mean(axis=0), 1)}")


main()
