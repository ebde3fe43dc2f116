"""How long a character takes to go somewhere on the table."""

import math

import numpy as np
from numpy.typing import NDArray

from cubeling.characters import Animator, Character, CharacterCommand, LocomotionIntent, RootDelta
from cubeling.characters.behaviour import Manner
from cubeling.characters.motion import ARRIVAL_DISTANCE_M

SPEEDS: dict[Manner, float] = {"walk": 2.0, "run": 4.0}
"""AvatAR's Speed of each manner."""

TRIAL_M, TRIAL_STEP_S, TRIAL_S = 0.4, 1 / 30, 20.0
"""Way of the trial [m], its time step, and the time after which it is given up [s]."""

TURNING_S_PER_RAD = 0.35
"""Time of a turn at the start [s/rad]."""


class WalkingTimes:
    """Measures once how fast a character walks and runs, by letting it go a straight way."""

    def __init__(self, character: Character) -> None:
        self._character = character
        self._measured: dict[Manner, tuple[float, float]] = {}

    def measure(self) -> None:
        """Measure all that `time` needs, so that no frame waits for it."""
        for manner in SPEEDS:
            self._pace_of(manner)

    def time(self, place: RootDelta, target: NDArray[np.float64], manner: Manner) -> float:
        """Return how long a way takes from a place to a target (x, z) on the table [s]."""
        x, z = target.tolist()
        distance = math.hypot(x - place.x, z - place.z)
        if distance <= ARRIVAL_DISTANCE_M:
            return 0.0
        start, pace = self._pace_of(manner)
        return start + distance / pace + TURNING_S_PER_RAD * abs(place.bearing(x, z))

    def _pace_of(self, manner: Manner) -> tuple[float, float]:
        if manner not in self._measured:
            self._measured[manner] = self._trial(manner)
        return self._measured[manner]

    def _trial(self, manner: Manner) -> tuple[float, float]:
        """Return the time that starting and stopping take besides [s], and the pace [m/s]."""
        animator = Animator(self._character, place=RootDelta(), layers=())
        going = LocomotionIntent(SPEEDS[manner], np.array([0.0, TRIAL_M]))
        gone = [0.0]
        while gone[-1] < TRIAL_M - ARRIVAL_DISTANCE_M and len(gone) * TRIAL_STEP_S < TRIAL_S:
            posed = animator.update(CharacterCommand(len(gone) * TRIAL_STEP_S, going))
            gone.append(float(posed.table_from_character[2, 3]))
        steps = np.interp((0.3 * TRIAL_M, 0.7 * TRIAL_M), gone, np.arange(len(gone)))
        pace = 0.4 * TRIAL_M / max(float(np.diff(steps)[0]) * TRIAL_STEP_S, 1e-3)
        return max(len(gone) * TRIAL_STEP_S - TRIAL_M / pace, 0.0), pace
