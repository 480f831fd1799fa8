"""What several tests share."""

import os
import pathlib
import shutil

import numpy as np
import pytest

import taut

ROOT = pathlib.Path(__file__).resolve().parents[3]


def rotation(wxyz):
    """R of a unit quaternion w, x, y, z, written out here so that tests do not lean on the library."""
    w, x, y, z = wxyz
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])


def pendulum(length=1.0):
    """A thin rod on a hinge about y, released from the horizontal: world, rod, axis."""
    world = taut.World()
    rod = world.add_body("rod", taut.MassProperties(1.0, [1e-4, length**2 / 12, length**2 / 12]), taut.Pose(p=[length / 2, 0, 0]))
    joint = world.add("pivot", taut.Hinge.at(world, taut.GROUND, rod, [0, 0, 0], [0, 1, 0]))
    return world, rod, world.axis(joint, "angle")


def chain(links):
    """Rods of 0.1 m on ball joints from the origin along x."""
    world = taut.World()
    last = taut.GROUND
    for k in range(links):
        rod = world.add_body(f"rod {k}", taut.MassProperties.rod(0.1, 0.01, 0.1), taut.Pose(p=[0.1 * k + 0.05, 0, 0]))
        world.add(f"ball {k}", taut.Ball.at(world, last, rod, [0.1 * k, 0, 0]))
        last = rod
    return world


@pytest.fixture
def program():
    """The program `taut`; what needs it is skipped where it is not built."""
    places = [os.environ.get("TAUT_PROGRAM", ""), ROOT / "build/release/taut", ROOT / "build/python/taut"]
    for place in filter(None, places):
        if shutil.which(str(place)):
            return str(place)
    pytest.skip("the program taut is not built")
