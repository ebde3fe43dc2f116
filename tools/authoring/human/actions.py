"""Actions of the bundled explorer that play once: wave, cheer, jump, nod and shake of the head.

Every action has an anticipation and an overshoot, and begins and ends in the idle pose.
"""

from functools import partial

import numpy as np

from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton.pose import Skeleton
from cubeling.characters.smoothing import smoothstep
from tools.authoring.human.acting import FRAME_RATE_HZ, ActingCurves, clip_from_acting
from tools.authoring.human.idle import idle_weight
from tools.authoring.human.limbs import HandTarget
from tools.authoring.modelling.curves import keys
from tools.authoring.modelling.shapes import Array

GRAVITY_M_S2 = 9.81
HOP_RATE_HZ = 120.0
"""Frames a second of hops: legs that push off and land fast bow between frames."""

PUSH_S, LANDING_S = 0.2, 0.14
"""How long a jump is pushed off, and its landing absorbed [s]."""

TUCK_M = 0.03
"""How far the legs are drawn up at the top of a jump [m]."""

IDLE_START_WEIGHT = float(idle_weight(np.zeros(1))[0])
"""Weight shift at the start of idle."""


def actions(skeleton: Skeleton) -> dict[str, Clip]:
    """Return all actions by name."""
    clips = (wave(skeleton), cheer(skeleton), jump(skeleton), nod(skeleton), shake(skeleton))
    return {clip.name: clip for clip in clips}


def curve(seconds: float, *poses: tuple[float, float], rate: float = FRAME_RATE_HZ) -> Array:
    """Return a smooth looping curve through keys (time [s], value), (frames + 1,)."""
    values = keys(round(seconds * rate), *((time / seconds, value) for time, value in poses))
    return np.append(values, values[0])


_fine_curve = partial(curve, rate=HOP_RATE_HZ)


def wave(skeleton: Skeleton) -> Clip:
    """Return a wave of the raised right hand, three times to and fro."""
    seconds = 2.6
    up = curve(seconds, (0.0, 0), (0.22, -0.10), (0.62, 1.07), (0.78, 1), (1.95, 1), (2.38, -0.03))
    to = curve(
        seconds,
        (0.45, 0), (0.66, 1), (0.88, -1), (1.1, 1), (1.32, -1), (1.54, 1), (1.76, -0.8),
        (1.98, 0.2), (2.1, 0), (2.59, 0),
    )  # fmt: skip
    late = curve(
        seconds,
        (0.5, 0), (0.73, 1), (0.95, -1), (1.17, 1), (1.39, -1), (1.61, 1), (1.83, -0.8),
        (2.04, 0.2), (2.16, 0), (2.59, 0),
    )  # fmt: skip
    raised = np.clip(up, 0.0, 1.0)
    still, one = 0 * to, 1 + 0 * to
    hand = HandTarget(
        wrist=np.stack([0.405 + 0.05 * to, 1.375 - 0.012 * to * to, 0.12 * one], axis=-1),
        fingers=np.stack([0.10 + 0.42 * late, one, 0.08 + still], axis=-1),
        thumb=np.stack([-one, 0.2 * one, 0.25 * one], axis=-1),
        elbow=np.array([0.55, -0.75, -0.35]),
        share=up,
    )
    score = ActingCurves(
        weight=IDLE_START_WEIGHT
        + curve(seconds, (0, 0), (0.25, -0.1), (0.7, 1.4), (1.9, 1.35), (2.45, 0)),
        crouch=curve(seconds, (0, 0), (0.24, 0.022), (0.6, -0.006), (0.9, 0), (2.2, 0.006)),
        side=curve(seconds, (0, 0), (0.25, 3), (0.72, -5), (1.9, -4), (2.5, 0)) + 0.8 * to,
        twist=curve(seconds, (0, 0), (0.25, -6), (0.7, 7), (1.9, 5), (2.45, 0)),
        look=(still, curve(seconds, (0, 0), (0.22, 6), (0.6, -4), (1.9, -2), (2.4, 0))),
        tilt=curve(seconds, (0, 0), (0.25, -3), (0.8, 9), (1.9, 8), (2.5, 0)) - 2 * to,
        bend=(19 + 12 * raised, 19 + still),
        spread=(curve(seconds, (0, 0), (0.25, -3), (0.75, 9), (1.9, 7), (2.4, 0)), still),
        fist=(18 + 8 * raised, 18 - 16 * raised),
        hands={"Right": hand},
        mood={
            "happy": curve(seconds, (0, 0.06), (0.2, 0.1), (0.6, 0.95), (2.0, 0.85), (2.59, 0.06)),
            "surprised": curve(seconds, (0, 0), (0.3, 0), (0.5, 0.25), (0.85, 0), (2.5, 0)),
        },
    )
    return clip_from_acting("wave", skeleton, seconds, score, loop=False)


def cheer(skeleton: Skeleton) -> Clip:
    """Return a cheer: crouch, then both fists in the air and two hops in place."""
    seconds = 2.5
    hops = ((0.50, 0.36), (1.12, 0.30))
    air, crouch, heels = _hops(seconds, hops, squat=0.10)
    up = _fine_curve(
        seconds,
        (0, 0), (0.26, -0.16), (0.58, 1.05), (0.80, 0.94), (0.99, 0.78), (1.23, 1.04), (1.40, 0.97),
        (1.82, 1), (2.25, -0.03), (2.49, 0),
    )  # fmt: skip
    pump = _fine_curve(
        seconds, (0.4, 0), (0.62, 1), (0.98, -1), (1.26, 1), (1.48, -0.3), (1.7, 0.2), (2.4, 0)
    )
    still, one = 0 * up, 1 + 0 * up
    fists = HandTarget(
        wrist=np.stack([0.345 - 0.01 * pump, 1.515 + 0.03 * pump, 0.06 + 0.02 * pump], axis=-1),
        fingers=np.stack([0.12 * one, one, -0.1 + 0.2 * pump], axis=-1),
        thumb=np.stack([-0.5 * one, 0 * one, 0.8 * one], axis=-1),
        elbow=np.array([0.8, -0.3, -0.3]),
        share=up,
    )
    score = ActingCurves(
        weight=IDLE_START_WEIGHT
        + _fine_curve(
            seconds, (0, 0), (0.3, -IDLE_START_WEIGHT), (1.9, -IDLE_START_WEIGHT), (2.49, 0)
        ),
        crouch=crouch,
        air=air,
        heels=heels,
        lean=_fine_curve(
            seconds,
            (0, 0),
            (0.30, 17),
            (0.60, -9),
            (0.97, 6),
            (1.24, -8),
            (1.54, 6),
            (1.75, -1),
            (2.1, 0),
        ),
        look=(
            still,
            _fine_curve(
                seconds,
                (0, 0),
                (0.28, 16),
                (0.6, -20),
                (0.97, -6),
                (1.26, -17),
                (1.8, -8),
                (2.3, 2),
            ),
        ),
        tilt=_fine_curve(seconds, (0.4, 0), (0.65, 7), (1.24, -7), (1.7, 4), (2.3, 0)),
        shrug=8 * np.clip(up, 0, 1),
        swing=(3 - 60 * np.clip(-up, 0, 1), 3 - 60 * np.clip(-up, 0, 1)),
        bend=(19 + 60 * np.clip(-up, 0, 1), 19 + 60 * np.clip(-up, 0, 1)),
        fist=(18 + 60 * np.clip(up, 0, 1), 18 + 60 * np.clip(up, 0, 1)),
        hands={"Left": fists, "Right": fists},
        mood={
            "happy": _fine_curve(
                seconds, (0, 0.06), (0.28, 0.3), (0.55, 1.0), (1.9, 0.9), (2.49, 0.06)
            ),
            "aa": _fine_curve(
                seconds, (0.3, 0), (0.56, 0.55), (0.9, 0.25), (1.22, 0.5), (1.6, 0), (2.4, 0)
            ),
        },
    )
    return clip_from_acting("cheer", skeleton, seconds, score, loop=False, rate=HOP_RATE_HZ)


def jump(skeleton: Skeleton) -> Clip:
    """Return a jump in place with raised arms that lands with bent knees."""
    seconds = 1.9
    air, crouch, heels = _hops(seconds, ((0.52, 0.46),), squat=0.17)
    arms = _fine_curve(
        seconds,
        (0, 3), (0.34, -62), (0.60, 118), (0.78, 104), (1.06, 14), (1.22, -12), (1.5, 8), (1.8, 3),
    )  # fmt: skip
    spread = _fine_curve(seconds, (0, 0), (0.34, 4), (0.7, 30), (1.06, 22), (1.3, 6), (1.7, 0))
    bend = _fine_curve(seconds, (0, 19), (0.34, 26), (0.62, 10), (1.05, 40), (1.3, 26), (1.8, 19))
    score = ActingCurves(
        weight=IDLE_START_WEIGHT
        + _fine_curve(
            seconds, (0, 0), (0.3, -IDLE_START_WEIGHT), (1.3, -IDLE_START_WEIGHT), (1.85, 0)
        ),
        crouch=crouch,
        air=air,
        heels=heels,
        lean=_fine_curve(
            seconds, (0, 0), (0.34, 26), (0.62, -8), (0.9, 4), (1.1, 20), (1.45, -2), (1.8, 0)
        ),
        look=(
            0.0,
            _fine_curve(
                seconds, (0, 0), (0.3, 10), (0.58, -16), (0.85, 6), (1.1, 16), (1.5, -3), (1.8, 0)
            ),
        ),
        shrug=_fine_curve(seconds, (0, 0), (0.34, -3), (0.65, 10), (1.08, -5), (1.5, 0)),
        swing=(arms, arms),
        spread=(spread, spread),
        bend=(bend, bend),
        fist=(_fine_curve(seconds, (0, 18), (0.34, 60), (0.7, 2), (1.1, 34), (1.8, 18)),) * 2,
        mood={
            "happy": _fine_curve(
                seconds, (0, 0.06), (0.45, 0.1), (0.68, 0.8), (1.3, 0.7), (1.89, 0.06)
            ),
            "surprised": _fine_curve(
                seconds, (0.2, 0), (0.62, 0.4), (0.95, 0.1), (1.1, 0), (1.8, 0)
            ),
            "angry": _fine_curve(seconds, (0, 0), (0.32, 0.35), (0.55, 0), (1.8, 0)),  # effort
        },
    )
    return clip_from_acting("jump", skeleton, seconds, score, loop=False, rate=HOP_RATE_HZ)


def nod(skeleton: Skeleton) -> Clip:
    """Return a yes: the head rises, then nods twice, less the second time."""
    seconds = 1.6
    down = curve(
        seconds,
        (0, 0), (0.20, -15), (0.46, 33), (0.70, -9), (0.94, 24), (1.16, -5), (1.36, 2), (1.58, 0),
    )  # fmt: skip
    score = ActingCurves(
        weight=IDLE_START_WEIGHT,
        crouch=curve(
            seconds, (0, 0), (0.20, -0.006), (0.50, 0.022), (0.74, 0), (0.98, 0.014), (1.35, 0)
        ),
        lean=curve(seconds, (0, 0), (0.22, -4), (0.52, 9), (0.78, -1), (1.02, 6), (1.4, 0)),
        head=(0.0, down),
        swing=(curve(seconds, (0, 3), (0.25, -1), (0.58, 10), (0.82, 4), (1.06, 8), (1.55, 3)),)
        * 2,
        mood={
            "happy": curve(seconds, (0, 0.06), (0.3, 0.45), (1.1, 0.5), (1.59, 0.06)),
            "surprised": curve(
                seconds, (0, 0), (0.2, 0.4), (0.44, 0), (0.7, 0.25), (0.94, 0), (1.5, 0)
            ),
        },
    )
    return clip_from_acting("nod", skeleton, seconds, score, loop=False)


def shake(skeleton: Skeleton) -> Clip:
    """Return a no: the head turns to and fro, and the shoulders follow."""
    seconds = 1.9
    aside = curve(
        seconds,
        (0, 0), (0.16, -12), (0.44, 44), (0.74, -42), (1.02, 33), (1.28, -19), (1.52, 5), (1.84, 0),
    )  # fmt: skip
    late = curve(
        seconds, (0.1, 0), (0.26, -4), (0.54, 11), (0.84, -11), (1.12, 8), (1.38, -4), (1.65, 0)
    )
    score = ActingCurves(
        weight=IDLE_START_WEIGHT + 0.04 * late,
        lean=curve(seconds, (0, 0), (0.4, -4), (1.3, -3), (1.8, 0)),
        twist=late,
        head=(aside, curve(seconds, (0, 0), (0.3, 7), (1.2, 6), (1.7, 0))),
        tilt=curve(seconds, (0, 0), (0.4, 7), (0.74, -7), (1.04, 5), (1.4, 0)),
        shrug=curve(seconds, (0, 0), (0.4, 5), (1.2, 4), (1.7, 0)),
        spread=(curve(seconds, (0, 0), (0.45, 7), (1.2, 6), (1.7, 0)),) * 2,
        mood={
            "sad": curve(seconds, (0, 0), (0.35, 0.65), (1.2, 0.65), (1.75, 0)),
            "happy": curve(seconds, (0, 0.06), (0.25, 0), (1.5, 0), (1.89, 0.06)),
        },
    )
    return clip_from_acting("shake", skeleton, seconds, score, loop=False)


def _hops(
    seconds: float, flights: tuple[tuple[float, float], ...], squat: float
) -> tuple[Array, Array, Array]:
    """Return height of the feet, crouch and lift of the heels for flights (start, duration) [s].

    The flight is a free fall. A squat and a stretch over the toes give the body its speed, and the
    knees take it up when it lands.
    """
    time = np.arange(round(seconds * HOP_RATE_HZ) + 1) / HOP_RATE_HZ
    air, deep, rest = 0 * time, squat, 0.0
    lifted, crouched = [(0.0, 0.0)], [(0.0, 0.0, 0.0), (flights[0][0] - PUSH_S, squat, 0.0)]
    for start, duration in flights:
        since = np.clip(time - start, 0.0, duration)
        air += GRAVITY_M_S2 / 2 * since * (duration - since)
        speed, rest = GRAVITY_M_S2 / 2 * duration, start + duration
        crouched += [(start, -0.045, -speed), (start, -0.045, 0.0)]
        crouched += [(start + 0.5 * duration, TUCK_M, 0.0), (rest, 0.0, 0.0)]
        crouched += [(rest, 0.0, speed), (rest + LANDING_S, 0.85 * deep, 0.0)]
        lifted += [(start - PUSH_S, 0.0), (start, 38.0), (start + 0.4 * duration, 34.0)]
        lifted += [(rest, 14.0), (rest + 0.09, 0.0)]
        deep *= 0.7
    crouched += [(rest + 0.38, -0.008, 0.0), (rest + 0.55, 0.0, 0.0), (seconds, 0.0, 0.0)]
    return air, _with_slopes(time, crouched), _fine_curve(seconds, *lifted)


def _with_slopes(time: Array, points: list[tuple[float, float, float]]) -> Array:
    """Return a cubic curve through (time [s], value, slope); two points at one time are a kink."""
    at, value, slope = np.array(points).T
    i = np.clip(np.searchsorted(at, time, side="right") - 1, 0, len(at) - 2)
    span = np.maximum(at[i + 1] - at[i], 1e-9)
    u = np.clip((time - at[i]) / span, 0.0, 1.0)
    bows = slope[i] * u * (1 - u) ** 2 - slope[i + 1] * u * u * (1 - u)
    return np.asarray(value[i] + (value[i + 1] - value[i]) * smoothstep(u) + span * bows)
