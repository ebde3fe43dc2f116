"""Head beats: small nods with which a head stresses what is said, for every body with a head.

That heads move with stressed syllables: Munhall et al., "Visual prosody and speech
intelligibility", 2004; sizes and times are ours.
"""

from collections.abc import Sequence

import numpy as np

from cubeling.characters.motion.curves import Keyed
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.speech.speech import Accent

WEAK_RAD, STRONG_RAD = np.deg2rad(1.5), np.deg2rad(6.5)
"""How far the head goes down for the weakest and the strongest accent [rad]."""

TILT_SHARE = 0.35
"""How far it tilts and turns to a side meanwhile, at most, as a share of that."""

LIFT_SHARE = 0.4
"""How far it is lifted before, as a share."""

LIFT_S, DOWN_S, BACK_S = -0.22, 0.03, 0.42
"""When it is lifted, down and back again, from the accent [s]."""

START_S = LIFT_S - 0.2
"""When a beat begins, from the accent [s]."""


class HeadBeats:
    """The head beats of one speech."""

    def __init__(self, accents: Sequence[Accent], seed: int) -> None:
        rng = np.random.default_rng(seed)
        self._beats = [
            (each.time, WEAK_RAD + (STRONG_RAD - WEAK_RAD) * each.strength, rng.uniform(-1, 1, 2))
            for each in accents
        ]

    def at(self, time: float) -> Array:
        """Return how the head is turned at a time of the speech [s]: a rotation vector (3,).

        Its axes are those of the body: x nods, y turns, z tilts.
        """
        turned = np.zeros(3)
        for accent, size, (turn, tilt) in self._beats:
            own = time - accent
            if START_S < own < BACK_S:
                nod = _NOD.at(own - START_S, BACK_S - START_S)
                aside = TILT_SHARE * abs(nod)
                turned += size * np.array([nod, aside * turn, aside * tilt])
        return turned


_NOD = Keyed(
    tuple(each - START_S for each in (START_S, LIFT_S, DOWN_S, BACK_S)),
    (0.0, -LIFT_SHARE, 1.0, 0.0),
    "gonio",
)
