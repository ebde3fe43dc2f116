"""What the frames of a library do over the ground, and which of them meet a request."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.library import Frames, MotionLibrary

WINDOW_S = 0.5
"""Speed and yaw rate of a frame are means over so long before and after it [s]."""

SPEED_CELL_M_S, YAW_CELL_RAD_S = 0.5, 0.6
"""Frames whose speeds and yaw rates fall into one cell of this size behave alike."""

STANDING_M_S = 0.2
"""A slower body stands [m/s]."""

HYSTERESIS_CELLS = 0.4
"""A behaviour is left for one that is nearer by so many cells."""

TOO_FAST_FACTOR = 2.0
"""How much worse it is to be too fast than too slow: a fast body orbits its target."""

MIN_FRAMES = 12
"""Cells with fewer frames are no behaviour of their own."""


@dataclass(frozen=True)
class Behaviours:
    """The behaviours that the kept frames of a graph have: cells of speed and yaw rate."""

    means: Array
    """Mean speed [m/s] and yaw rate [rad/s] of each behaviour, (behaviours, 2)."""

    members: Frames
    """Behaviour of each frame, −1 for none, (frames,)."""

    @staticmethod
    def of(library: MotionLibrary, kept: NDArray[np.bool_]) -> "Behaviours":
        """Return the behaviours of the kept frames (frames,) of a library."""
        rates = travel_rates(library)
        cells = np.round(rates / [SPEED_CELL_M_S, YAW_CELL_RAD_S]).astype(np.intp)
        cells[rates[:, 0] < STANDING_M_S] = -1, 0  # whichever way it turns
        _, owner, counts = np.unique(cells[kept], axis=0, return_inverse=True, return_counts=True)
        usual = counts >= min(MIN_FRAMES, counts.max())
        numbers = np.where(usual, np.cumsum(usual) - 1, -1)
        members = np.full(len(library), -1, np.intp)
        members[kept] = numbers[owner.ravel()]
        means = [rates[members == number].mean(0) for number in range(int(usual.sum()))]
        return Behaviours(np.array(means), members)

    def nearest(self, speed: float, yaw_rate: float, present: int = -1) -> int:
        """Return the behaviour that is nearest to a speed [m/s] and yaw rate [rad/s].

        The `present` one is left only for one that is clearly nearer.
        """
        away = (self.means - [speed, yaw_rate]) / [SPEED_CELL_M_S, YAW_CELL_RAD_S]
        away[:, 0] *= np.where(away[:, 0] > 0.0, TOO_FAST_FACTOR, 1.0)
        if speed < STANDING_M_S:
            away[:, 1] = 0.0  # to stand is more than to keep the heading
        errors = np.sqrt(np.square(away).sum(1))
        if present >= 0:
            errors[present] -= HYSTERESIS_CELLS
        return int(errors.argmin())

    def goals(self, behaviour: int) -> NDArray[np.bool_]:
        """Return which frames have a behaviour, (frames,)."""
        found: NDArray[np.bool_] = self.members == behaviour
        return found


def travel_rates(library: MotionLibrary) -> Array:
    """Return the mean speed [m/s] and yaw rate [rad/s] around each frame, (frames, 2)."""
    reach = round(WINDOW_S * library.rate)
    frames = np.arange(len(library))
    first = frames
    for _ in range(reach):
        first = np.where(library.predecessors[first] < 0, first, library.predecessors[first])
    total = np.zeros((len(library), 3))
    yaw = np.zeros(len(library))
    for _ in range(2 * reach):
        x, z, turn = library.steps[first].T
        sine, cosine = np.sin(yaw), np.cos(yaw)
        total += np.stack([cosine * x + sine * z, cosine * z - sine * x, turn], axis=-1)
        yaw += turn
        first = library.onward(first, 1)
    seconds = 2 * reach / library.rate
    # Along an arc, the chord is shorter than the way.
    half = np.clip(np.abs(total[:, 2]) / 2, 1e-6, math.pi - 0.5)
    way = np.hypot(total[:, 0], total[:, 1]) * half / np.sin(half)
    return np.stack([way, total[:, 2]], axis=-1) / seconds
