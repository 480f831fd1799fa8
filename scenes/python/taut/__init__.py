"""Rigid multibody systems with very many joints, solved directly.

A World holds bodies, joints and forces; a Simulator advances it; simulate() does both for a scene and shows itself in a
notebook.  SI units; quaternions are w, x, y, z wherever a name does not say otherwise; rows of n×6 arrays have what turns
first: angular velocity before velocity, torque before force.
"""

import pathlib

from . import _taut
from ._taut import *  # noqa: F403
from .display import show
from .running import simulate

__version__: str = vars(_taut)["__version__"]
__all__ = [*(name for name in vars(_taut) if not name.startswith("_")), "__version__", "show", "simulate"]

_three = pathlib.Path(__file__).parent / "three"
if _three.is_dir():
    _taut._set_three_folder(_three)
