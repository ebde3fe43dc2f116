"""What it would take a body to stay on its feet, in frames of a library and in jumps."""

import numpy as np

from cubeling.characters.motion.balance import GRAVITY_M_S2, hips_beyond_feet
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.library import Frames, MotionLibrary

PASSING_S = 0.3
"""Time in which a jump passes over to another velocity [s]."""

FREE_HEIGHTS = 0.05
"""Hips this far beyond the feet cost nothing: in every step they are, for a moment [body heights].
"""


def unsupported_lean(library: MotionLibrary) -> Array:
    """Return the angle by which the hips are out of the feet's support, (frames,) [rad].

    What speeding up and braking explain is not counted; see `hips_beyond_feet`.
    """
    height = float(np.ptp(library.skeleton.rest.globals(library.skeleton)[:, 1, 3]))
    hips = library.positions[:, library.anatomy.joints.get("hips", 0), 1]
    away = hips_beyond_feet(library.positions, library.anatomy, acceleration(library))
    lean: Array = np.arctan2(np.maximum(away - FREE_HEIGHTS * height, 0.0), np.maximum(hips, 1e-3))
    return lean


def acceleration(library: MotionLibrary) -> Array:
    """Return how fast the speed ahead changes over a quarter of a second, (frames,) [m/s²]."""
    every = np.arange(len(library))
    reach = round(0.125 * library.rate)
    later, before = library.onward(every, reach), every
    for _ in range(reach):
        before = np.where(library.predecessors[before] < 0, before, library.predecessors[before])
    change: Array = (library.steps[later, 1] - library.steps[before, 1]) * library.rate
    return change * library.rate / (2 * reach)


def velocity_lean(library: MotionLibrary, before: Frames, after: Frames) -> Array:
    """Return the lean that passing over from the motion of frames (n,) to others' takes [rad]."""
    change = (library.steps[before] - library.steps[after])[:, :2] * library.rate
    lean: Array = np.arctan(np.hypot(*change.T) / PASSING_S / GRAVITY_M_S2)
    return lean
