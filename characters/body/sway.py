"""Breath and sway of a standing body: slow sine waves turn a few joints, but not the legs."""

import math

import numpy as np

from cubeling.characters.body.axes import Degrees, body_axes, rotation_vectors
from cubeling.characters.body.posture import Expressivity
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Skeleton

RESTING_BREATH_HZ, MAX_BREATH_HZ = 0.25, 0.7
"""Breathing rate at rest and after a run [Hz]."""

MAX_BREATH_DEPTH = 1.8
"""Depth of the hardest breath, relative to one at rest."""

EFFORT_LAG_S = 6.0
"""Time constant with which breath follows effort [s]."""

# Turns of joints by a full breath [degrees]. The chest opens; neck and head compensate, so that the
# eyes stay level; the arms stay vertical.
_BREATH_DEG: dict[str, Degrees] = {
    "spine": (-0.7, 0.0, 0.0),
    "chest": (-1.3, 0.0, 0.0),
    "upperChest": (-0.8, 0.0, 0.0),
    "neck": (1.4, 0.0, 0.0),
    "head": (0.9, 0.0, 0.0),
    "leftShoulder": (0.0, 0.0, 2.2),
    "rightShoulder": (0.0, 0.0, -2.2),
    "leftUpperArm": (0.0, 0.0, -1.2),
    "rightUpperArm": (0.0, 0.0, 1.2),
}
# The trunk of a quadruped carries the forelegs too: only neck and head move.
_QUADRUPED_BREATH_DEG: dict[str, Degrees] = {
    "neck": (-1.2, 0.0, 0.0),
    "head": (0.8, 0.0, 0.0),
}
# Amplitudes of the sway of joints about the same axes [degrees]; each has waves of its own.
_SWAY_DEG: dict[str, Degrees] = {
    "spine": (0.35, 0.5, 0.45),
    "chest": (0.3, 0.5, 0.3),
    "neck": (0.5, 0.8, 0.5),
    "head": (0.8, 1.5, 0.9),
    "leftShoulder": (0.0, 0.4, 0.5),
    "rightShoulder": (0.0, 0.4, 0.5),
    "leftUpperArm": (0.9, 0.5, 0.5),
    "rightUpperArm": (0.9, 0.5, 0.5),
}
_WAVE_COUNT = 3  # sines in each sway
_MIN_WAVE_HZ, _MAX_WAVE_HZ = 0.05, 0.33


class BodySway:
    """Breath and sway of one character.

    Characters with different seeds do not sway together.
    """

    def __init__(self, skeleton: Skeleton, anatomy: Anatomy, seed: int) -> None:
        quadruped = anatomy.kind == "quadruped"
        breath = _QUADRUPED_BREATH_DEG if quadruped else _BREATH_DEG
        above = ("neck", "head") if quadruped else tuple(_SWAY_DEG)
        names = [n for n in {**breath, **_SWAY_DEG} if n in breath or n in above]
        found = [(name, anatomy.joint(name)) for name in names]
        there = [(name, joint) for name, joint in found if joint is not None]
        self.joints = np.array([joint for _, joint in there], np.intp)
        """The joints that move, (n,)."""
        axes = body_axes(skeleton, self.joints)
        none = (0.0, 0.0, 0.0)
        self._breath = rotation_vectors(axes, [breath.get(name, none) for name, _ in there])
        sway = np.array([_SWAY_DEG.get(name, none) for name, _ in there]).reshape(-1, 3)
        vectors = np.radians(sway)[..., None] * np.swapaxes(axes, -1, -2) / math.sqrt(_WAVE_COUNT)
        # Each sways by the sum of its waves, (n, 3, 3 · waves).
        self._sway = np.tile(vectors.swapaxes(-1, -2), (1, 1, _WAVE_COUNT))
        rng = np.random.default_rng(seed)
        drawn = (_WAVE_COUNT, *sway.shape)
        rates = rng.uniform(_MIN_WAVE_HZ, _MAX_WAVE_HZ, drawn) * math.tau
        phases = rng.uniform(0.0, math.tau, drawn)
        # Some for each axis of each joint, (n, 1, 3 · waves).
        self._rates, self._phases = (
            each.swapaxes(0, 1).reshape(-1, 1, 3 * _WAVE_COUNT) for each in (rates, phases)
        )
        self._time, self._phase, self._effort = 0.0, float(rng.uniform()), 0.0
        self.breath = 0.0
        """Filling of the lungs, 0…1."""

    def update(
        self,
        elapsed: float,
        effort: float,
        calm: float,
        expressivity: Expressivity,
        posture: Array | None,
    ) -> Array:
        """Advance by a time [s] and return the rotations of the joints, (n, 4).

        They are in the joints' own frames: they multiply local rotations from the right.

        Breath slowly follows `effort`, 0 at rest … 1 at a full run. `calm` is how much of the sway
        shows, 0…1. The rotation vectors of a posture, (m, 3), in the frames of `joints` and others
        after them, are added, and m rotations are returned.
        """
        self._time += elapsed * expressivity.tempo
        self._effort += (effort - self._effort) * (1.0 - math.exp(-elapsed / EFFORT_LAG_S))
        rate = RESTING_BREATH_HZ + (MAX_BREATH_HZ - RESTING_BREATH_HZ) * self._effort
        self._phase = (self._phase + elapsed * (rate * expressivity.tempo)) % 1.0
        self.breath = lung_filling(self._phase)
        depth = (self.breath - 0.5) * (1.0 + (MAX_BREATH_DEPTH - 1.0) * self._effort)
        vectors = self._breath * (depth * expressivity.amplitude)
        if calm > 1e-3:
            waves = np.sin(self._rates * self._time + self._phases)
            vectors += np.vecdot(self._sway, waves) * (calm * expressivity.amplitude)
        if posture is not None:
            posture[: len(vectors)] += vectors
            vectors = posture
        return rotations.from_rotation_vector(vectors)


def lung_filling(phase: float) -> float:
    """Return the filling of the lungs at a phase of the breath: in for two fifths, then out.

    >>> lung_filling(0.0), round(lung_filling(0.4), 6), round(lung_filling(1.0), 6)
    (0.0, 1.0, 0.0)
    """
    if phase < 0.4:
        return 0.5 - 0.5 * math.cos(math.pi * phase / 0.4)
    return 0.5 + 0.5 * math.cos(math.pi * (phase - 0.4) / 0.6)
