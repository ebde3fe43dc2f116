"""How the bundled explorer stands, in nine moods."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from cubeling.affect.words import WORD_PLACES
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.human.acting import FRAME_RATE_HZ, ActingCurves, clip_from_acting
from tools.authoring.human.idle import STRAP_GRIP_M
from tools.authoring.human.limbs import HandTarget
from tools.authoring.modelling.shapes import Array
from tools.authoring.modelling.standing import DURATION_S, MOODS, Stander


@dataclass(frozen=True)
class Bearing:
    """How a mood shows in a body; lengths in metres, angles in degrees as in `ActingCurves`."""

    lean: float = 0.0
    crouch: float = 0.0
    nod: float = 0.0
    """Head down."""
    aside: float = 0.0
    """Head to the left."""
    tilt: float = 0.0
    side: float = 0.0
    twist: float = 0.0
    shrug: float = 0.0
    swing: float = 3.0
    spread: float = 0.0
    bend: float = 19.0
    sway: float = 1.7
    """How far the weight shifts; 1 is a calm contrapposto."""
    hands: tuple[str, str] = ("", "")
    """What the left and the right hand hold; "" if it hangs."""


CROUCH_M = 0.006
"""How far the hips come down per way of the weight, so that no knee is ever straight [m]."""

LATE_S, LATE_DEG = 0.13, 6.0
"""How much later than the hips the trunk goes to the side [s], and by how much it bends for that
[degrees for the whole way of the weight]."""

_HIP_M = np.array([0.262, 0.80, 0.03])
_GRIPS = {
    "strap": (STRAP_GRIP_M, [-0.85, 0.5, -0.2], [0.4, 0.85, 0.0], [0.9, -0.6, -0.25]),
    "hip": (_HIP_M, [-0.65, -0.5, 0.55], [-0.3, 0.5, -0.8], [1.0, 0.0, -0.5]),
}
"""Where a left hand goes: its wrist at rest [m], directions of fingers, thumb and elbow."""

BEARINGS = {
    "neutral": Bearing(),
    "pleased": Bearing(-2, 0, -1, 0, 7, hands=("strap", "strap"), sway=1.75),
    "happy": Bearing(-4, 0, -6, shrug=3, swing=16, spread=16, bend=58, sway=1.8),
    "alert": Bearing(-3, 0, 0, shrug=9, swing=24, spread=6, bend=95, sway=1.5),
    "angry": Bearing(10, 0.014, 9, shrug=8, swing=-4, spread=22, bend=34, sway=1.5),
    "displeased": Bearing(-3, 0, 2, -16, -7, 3, 8, hands=("hip", "hip")),
    "depressed": Bearing(18, 0.014, 38, shrug=-9, swing=16, bend=7, sway=1.5),
    "sleepy": Bearing(2, 0.034, 8, 12, 26, 9, shrug=-6, swing=8, bend=6, sway=1.8),
    "relaxed": Bearing(-5, 0.004, 0, 0, 6, -3, spread=2, bend=14, sway=2.1, hands=("hip", "")),
}


def standing(skeleton: Skeleton) -> Iterator[tuple[str, Clip]]:
    """Yield each mood, and how the explorer stands in it."""
    frames = round(DURATION_S * FRAME_RATE_HZ) + 1
    for mood in MOODS:
        body = BEARINGS[mood]
        stander = Stander.of("human", mood, WORD_PLACES[mood][1], frames - 1)
        yield (
            mood,
            clip_from_acting(mood, skeleton, DURATION_S, _score(body, stander, frames), loop=True),
        )


def _score(body: Bearing, stander: Stander, frames: int) -> ActingCurves:
    def about(middle: float, size: float) -> Array:
        curve = middle + stander.sway(size)
        return np.append(curve, curve[0])

    weight = np.append(weights := stander.weight(), weights[0])
    late = np.append(delayed := np.roll(weights, round(LATE_S * FRAME_RATE_HZ)), delayed[0])
    look = stander.glances(11.0)
    sides = zip(("Left", "Right"), body.hands, strict=True)
    return ActingCurves(
        weight=body.sway * weight + about(0.0, 0.03),
        crouch=np.maximum(about(body.crouch, 0.001), 0.0) + CROUCH_M * np.abs(body.sway * weight),
        lean=about(body.lean, 0.7),
        twist=about(body.twist, 0.8) + 2.0 * weight,
        side=about(body.side, 0.6) + LATE_DEG * body.sway * (weight - late),
        look=(np.append(look, look[0]) + body.aside, about(0.6 * body.nod, 1.2)),
        head=(about(0.0, 0.8), about(0.4 * body.nod, 0.6)),
        tilt=about(body.tilt, 1.2),
        shrug=about(body.shrug, 0.4),
        swing=(about(body.swing, 1.3), about(body.swing, 1.3)),
        spread=(about(body.spread, 0.7), about(body.spread, 0.7)),
        bend=(about(body.bend, 2.0), about(body.bend, 2.0)),
        hands={side: _held(name, frames) for side, name in sides if name},
    )


def _held(name: str, frames: int) -> HandTarget:
    wrist, fingers, thumb, elbow = map(np.array, _GRIPS[name])
    return HandTarget(wrist, fingers, thumb, elbow, share=np.ones(frames))
