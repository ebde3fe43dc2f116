"""Breath and the small movements of a body that stands still.

A body never rests: the chest rises and falls, the trunk sways a little, the head drifts. All of it
is a few slow waves that turn a few joints by a few degrees; the legs stay where they are.
"""

import math

import numpy as np

from characters.body.axes import body_axes, turned
from characters.body.posture import PLAIN, Manner
from characters.skeleton import rotations
from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Array, Skeleton

RESTING_RATE, HARDEST_RATE = 0.25, 0.7
"""Breaths a second at rest and after a run [Hz]."""

DEEPER = 1.8
"""How much deeper the hardest breath is than one at rest."""

_RECOVERY = 6.0  # [s]: how slowly breath follows effort

# Degrees by which a full breath turns joints about the body's axes: x to the left, y up, z forward.
# The chest opens, the neck and the head give way so that the eyes stay level, the arms hang still.
_BREATH: dict[str, tuple[float, float, float]] = {
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
# On four legs the trunk carries the forelegs too: only what is above them moves.
_BREATH_ON_FOUR: dict[str, tuple[float, float, float]] = {
    "neck": (-1.2, 0.0, 0.0),
    "head": (0.8, 0.0, 0.0),
}
# Degrees of the drift of joints, about the same axes; each with waves of its own.
_DRIFT: dict[str, tuple[float, float, float]] = {
    "spine": (0.35, 0.5, 0.45),
    "chest": (0.3, 0.5, 0.3),
    "neck": (0.5, 0.8, 0.5),
    "head": (0.8, 1.5, 0.9),
    "leftShoulder": (0.0, 0.4, 0.5),
    "rightShoulder": (0.0, 0.4, 0.5),
    "leftUpperArm": (0.9, 0.5, 0.5),
    "rightUpperArm": (0.9, 0.5, 0.5),
}
_WAVES = 3  # sines in each drift
_SLOWEST, _FASTEST = 0.05, 0.33  # [Hz]


class Stirring:
    """The waves of one character.

    Parameters
    ----------
    skeleton, anatomy
        Whose joints move.
    seed
        Of the drift; characters with different seeds do not sway together.
    """

    def __init__(self, skeleton: Skeleton, anatomy: Anatomy, seed: int) -> None:
        on_four = anatomy.kind == "quadruped"
        breath = _BREATH_ON_FOUR if on_four else _BREATH
        above = ("neck", "head") if on_four else tuple(_DRIFT)
        names = [n for n in {**breath, **_DRIFT} if n in breath or n in above]
        found = [(name, anatomy.joint(name)) for name in names]
        there = [(name, joint) for name, joint in found if joint is not None]
        self.joints = np.array([joint for _, joint in there], np.intp)
        """Numbers of the joints that move, (n,)."""
        axes = body_axes(skeleton, self.joints)
        still = (0.0, 0.0, 0.0)
        self._breath = turned(axes, [breath.get(name, still) for name, _ in there])
        drift = np.array([_DRIFT.get(name, still) for name, _ in there]).reshape(-1, 3)
        # One wave for each axis of each joint: (n, 3 axes, 3).
        self._drift = np.radians(drift)[..., None] * np.swapaxes(axes, -1, -2)
        rng = np.random.default_rng(seed)
        self._rates = rng.uniform(_SLOWEST, _FASTEST, (_WAVES, *drift.shape)) * math.tau
        self._phases = rng.uniform(0.0, math.tau, self._rates.shape)
        self._time, self._phase, self._effort = 0.0, float(rng.uniform()), 0.0
        self.breath = 0.0
        """How full the chest is, 0…1."""

    def update(
        self,
        elapsed: float,
        effort: float,
        calm: float,
        manner: Manner = PLAIN,
        borne: Array | None = None,
    ) -> Array:
        """Advance by a time [s] and return what turns the joints, (n, 4).

        The rotations are in the joints' own frames: they multiply local rotations from the right.

        Parameters
        ----------
        elapsed
            Since the last call.
        effort
            How hard the body works, 0 at rest … 1 at a full run; breath follows it slowly.
        calm
            How much of the drift shows, 0…1.
        manner
            How quick and how large it all is.
        borne
            Rotation vectors of a bearing, (m, 3), in the frames of `joints` and others after
            them; those are turned too, and m rotations are returned.
        """
        self._time += elapsed * manner.pace
        self._effort += (effort - self._effort) * (1.0 - math.exp(-elapsed / _RECOVERY))
        rate = RESTING_RATE + (HARDEST_RATE - RESTING_RATE) * self._effort
        self._phase = (self._phase + elapsed * (rate * manner.pace)) % 1.0
        self.breath = lungs(self._phase)
        depth = (self.breath - 0.5) * (1.0 + (DEEPER - 1.0) * self._effort)
        vectors = self._breath * (depth * manner.size)
        if calm > 1e-3:
            waves = np.sin(self._rates * self._time + self._phases).sum(0)
            vectors += np.einsum(
                "ja,jak->jk", waves * (calm * manner.size / math.sqrt(_WAVES)), self._drift
            )
        if borne is not None:
            borne[: len(vectors)] += vectors
            vectors = borne
        return rotations.from_rotation_vector(vectors)


def lungs(phase: float) -> float:
    """Return how full the chest is at a phase of the breath: in for two fifths of it, then out.

    >>> lungs(0.0), round(lungs(0.4), 6), round(lungs(1.0), 6)
    (0.0, 1.0, 0.0)
    """
    if phase < 0.4:
        return 0.5 - 0.5 * math.cos(math.pi * phase / 0.4)
    return 0.5 + 0.5 * math.cos(math.pi * (phase - 0.4) / 0.6)
