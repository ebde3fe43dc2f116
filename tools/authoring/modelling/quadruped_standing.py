"""How the bundled four-legged characters stand, in nine moods."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.affect.words import WORD_PLACES
from tools.authoring.modelling.curves import spring_follow
from tools.authoring.modelling.quadruped import DEGREE, FRAME_RATE_HZ, AnimationTracks
from tools.authoring.modelling.shapes import Array
from tools.authoring.modelling.standing import DURATION_S, Stander

SHIFT = 0.2
"""How far the hips go to the side [distances of the hind feet]."""


@dataclass(frozen=True)
class Bearing:
    """How a mood shows in a four-legged body; angles in degrees."""

    neck: float = 0.0
    """Up."""
    head: float = 0.0
    """Up."""
    aside: float = 0.0
    """Head to the left."""
    tilt: float = 0.0
    tail: float = 4.0
    """Up."""
    wag: float = 5.0
    """How far the tail swings to each side."""
    beat: float = 0.4
    """How often it does [Hz]."""
    low: float = 0.004
    """How much the body is lowered [m]."""
    pitch: float = 0.0
    """Chest up."""
    sway: float = 1.0
    """How far the weight shifts."""


BEARINGS = {
    "neutral": Bearing(),
    "pleased": Bearing(4, 2, 0, 14, 14, 14, 1.0),
    "happy": Bearing(8, 10, 0, 9, 34, 22, 1.8, 0.010, 4),
    "alert": Bearing(22, -12, 0, 0, 16, 2, 0.3, 0.001, -4, 0.9),
    "angry": Bearing(-20, 16, 0, 0, 22, 12, 2.2, 0.010, -7, 0.9),
    "displeased": Bearing(-2, 4, 26, -6, -4, 8, 0.7, 0.005),
    "depressed": Bearing(-30, -10, 0, 0, -9, 2, 0.2, 0.010, -3, 0.95),
    "sleepy": Bearing(-9, -12, 12, 24, -3, 3, 0.2, 0.015, 3, 1.2),
    "relaxed": Bearing(2, 6, -6, 8, 0, 9, 0.3, 0.010, 2, 1.4),
}


def standing_tracks(
    name: str,
    mood: str,
    neck: Sequence[str],
    tail: Callable[[AnimationTracks, Array, Array], None],
    stance: float,
    length: float,
    lowered: float = 0.0,
) -> AnimationTracks:
    """Return how a character stands in a mood.

    `stance` is the distance of its hind feet, `length` that of its hips and chest [m]. All its
    moods are `lowered` [m], so that its legs reach the ground at both sides.
    """
    body = BEARINGS[mood]
    anim = AnimationTracks(round(DURATION_S * FRAME_RATE_HZ))
    stander = Stander.of(name, mood, WORD_PLACES[mood][1], anim.frames)
    shift = SHIFT * stance * body.sway * (stander.weight() + stander.sway(0.03))
    anim.move("hips", x=shift, y=-body.low - lowered + stander.sway(0.0006))
    # The hips lead: the shoulders go half as far, and the neck keeps the head where it was.
    yaw = -0.5 * shift / length
    anim.turn("hips", up=body.pitch * DEGREE + stander.sway(0.004), tilt=-5 * shift, left=yaw)
    anim.turn("chest", left=-yaw, tilt=6 * shift, up=0.5 * body.pitch * DEGREE)
    look = (stander.glances(10.0) + body.aside) * DEGREE
    turned = spring_follow(look, DURATION_S, 0.9, 0.7)
    lift = body.neck * DEGREE + stander.sway(0.02)
    for joint in neck:
        anim.turn(joint, up=lift / len(neck), left=0.6 * turned / len(neck))
    level = -0.35 * (lift + body.pitch * DEGREE)
    anim.turn(
        "head",
        up=level + body.head * DEGREE + stander.sway(0.015),
        left=0.4 * spring_follow(look, DURATION_S, 1.5, 0.7),
        tilt=body.tilt * DEGREE + stander.sway(0.02),
    )
    cycles = max(round(body.beat * DURATION_S), 1)
    beat = np.sin(2 * np.pi * cycles * np.arange(anim.frames) / anim.frames)
    swing = body.wag * DEGREE * (0.7 + stander.sway(0.2)) * beat
    tail(anim, body.tail * DEGREE + stander.sway(0.02), swing)
    return anim
