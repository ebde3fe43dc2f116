"""Movements of the head by name: nods, shakes, tilts and turns.

Shapes of nods and shakes: Hadar et al., "Kinematics of head movements accompanying speech", 1983;
the sizes are ours.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.characters.behaviour.intents import HeadIntent, StrokeTimes
from cubeling.characters.behaviour.realization.planned_values import presence
from cubeling.characters.motion.curves import ease
from cubeling.characters.skeleton.pose import Array

HALF_AMOUNT = 0.5
"""The amount of a movement that has the sizes of `HEAD_MOVEMENTS`."""

LIFT_SHARE = 0.2
"""How far a head goes the other way before it nods, as a share of the nod."""

LAST_SHARE = 0.5
"""Size of the last of several nods or shakes, as a share of the first."""

MIN_HALF_S = 0.08
"""Shortest time of half a nod [s]; one that is to be shorter lasts so long."""


@dataclass(frozen=True)
class HeadMovement:
    """A movement of the head."""

    degrees: tuple[float, float, float]
    """Turn about the body's axes at its apex: x nods, y turns to the left, z tilts to the right."""

    to_and_fro: bool = False
    """Whether it swings to both sides, as a shake; only with strokes."""

    held: bool = False
    """Whether it stays at its apex until it is to relax; else it returns at once."""


HEAD_MOVEMENTS = {
    "NOD": HeadMovement((11.0, 0.0, 0.0)),
    "SHAKE": HeadMovement((0.0, 15.0, 0.0), to_and_fro=True),
    "TOSS": HeadMovement((-12.0, 0.0, 3.0)),
    "WOBBLE": HeadMovement((0.0, 0.0, 9.0), to_and_fro=True),
    "TILT": HeadMovement((0.0, 0.0, 13.0), held=True),
    "TILT_RIGHT": HeadMovement((0.0, 0.0, 13.0), held=True),
    "TILT_LEFT": HeadMovement((0.0, 0.0, -13.0), held=True),
    "UP": HeadMovement((-14.0, 0.0, 0.0), held=True),
    "DOWN": HeadMovement((16.0, 0.0, 0.0), held=True),
    "LEFT": HeadMovement((0.0, 24.0, 0.0), held=True),
    "RIGHT": HeadMovement((0.0, -24.0, 0.0), held=True),
}
"""The movements by name."""


def turned_head(intents: Sequence[HeadIntent], now: float) -> Array:
    """Return how movements turn the head at a time [s]: a rotation vector (3,) [rad].

    Its axes are those of the body. Unknown names do nothing.
    """
    turned = np.zeros(3)
    for intent in intents:
        movement = HEAD_MOVEMENTS.get(intent.lexeme)
        if movement is not None and now > intent.times.start:
            size = intent.amount / HALF_AMOUNT * _progress(movement, intent, now)
            turned += size * np.radians(movement.degrees)
    return turned


def _progress(movement: HeadMovement, intent: HeadIntent, now: float) -> float:
    """Return where a movement is between rest, 0, and its apex, 1; −1 on the other side."""
    if movement.held:
        return presence(intent.times, now)
    times, swings = intent.times, max(intent.repeats, 1)
    first = 1.0 / (4 if movement.to_and_fro else 2) / swings
    u = _stroke(times, first, now)
    fading = 1.0 - (1.0 - LAST_SHARE) * ease(u, "linear") * (swings > 1)
    if movement.to_and_fro:
        # The last half swing ends in rest with no speed.
        return fading * math.sin(2.0 * math.pi * swings * u) * (1.0 - u**6)
    away = ease((now - times.start) / max(_stroke_start(times) - times.start, 1e-6), "gonio")
    lifted = LIFT_SHARE * away * (1.0 - ease(u / first, "gonio"))
    return fading * math.sin(math.pi * swings * u) ** 2 - lifted


def _stroke(times: StrokeTimes, first: float, now: float) -> float:
    """Return how much of a stroke is over, 0…1; at `times.stroke` it is `first`."""
    start = _stroke_start(times)
    end = times.stroke_end
    if not math.isfinite(end):
        end = next(t for t in (times.relax, times.end, start + 0.6) if t is not None)
    apex = times.stroke if math.isfinite(times.stroke) else start + first * (end - start)
    apex = max(apex, start + MIN_HALF_S)
    end = max(end, apex + MIN_HALF_S)
    if now <= apex:
        return first * max(now - start, 0.0) / (apex - start)
    return first + (1.0 - first) * min((now - apex) / (end - apex), 1.0)


def _stroke_start(times: StrokeTimes) -> float:
    return times.stroke_start if math.isfinite(times.stroke_start) else times.ready
