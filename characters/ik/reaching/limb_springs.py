"""Springs of limbs: how an arm pulls that is stretched, and how a leg holds what stands on it."""

import math
import operator
from collections.abc import Sequence
from typing import NamedTuple

from cubeling.characters.ik.reaching.arms import Arm
from cubeling.characters.skeleton.scalar_quaternions import Vector, dot

ELBOW_SPRING, EASY_FLEXION_RAD = 2.0, math.radians(61.0)
"""How stiff an elbow is that is bent less than it is at ease [rad]."""

KNEE_SPRING, LEG_SPRING, TAUT_LEG = 1.2, 4.0, 300.0
"""How stiff a knee is, a leg whose length changes, and one that is straight."""

STRAIGHT_RAD = math.radians(16.0)
"""An elbow bent less than this is as good as straight: its spring goes on linearly, so that a place
out of reach pulls with a finite force."""

AT_EASE = 0.05
"""How much shorter than at ease an arm is, in arm lengths, from which on its spring does not pull,
but stiffens a step: one that did not see it coming would go far beyond, and tremble there."""

SPARE, MAX_SHORT = 0.015, 0.06
"""Length of an arm that is kept in reserve, and what it may lack at most before it pulls no harder,
in arm lengths."""


Row = list[float]
"""How a miss changes with the state of a tree: shift, pelvis, spine and collarbones."""


class Pull(NamedTuple):
    """A hand that pulls."""

    arm: Arm

    fore: float
    """From its elbow to what reaches [m]."""

    base: Vector
    """Where its collarbone begins; its shoulder if it has none [m]."""

    shoulder: Vector
    """Where its upper arm begins [m]."""

    place: Vector
    """Where it pulls to [m]."""

    weight: float
    """0 not at all … 1."""


def arm_strain(pull: Pull, far: float, power: float) -> tuple[float, float]:
    """Return how far an elbow is from its ease, and how that changes with the distance [1/m]."""
    upper, fore = pull.arm.upper, pull.fore
    ease = EASY_FLEXION_RAD * (1.0 + 0.3 * power)
    near = _span(upper, fore, ease)
    far += SPARE * (upper + fore)
    if far <= near:
        share = 1.0 - (near - far) / (AT_EASE * (upper + fore))
        if share <= 0.0:
            return 0.0, 0.0
        slope = near / (upper * fore * math.sin(ease))
        return 0.0, share * ELBOW_SPRING * (1.0 + power) * slope * pull.weight
    far = near + pull.weight * (far - near)
    straight = _span(upper, fore, STRAIGHT_RAD)
    reached = min(far, straight)
    cosine = (reached * reached - upper * upper - fore * fore) / (2.0 * upper * fore)
    flexion = math.acos(min(max(cosine, -1.0), 1.0))
    slope = reached / (upper * fore * math.sin(flexion))
    most = MAX_SHORT * (upper + fore)
    size = ELBOW_SPRING * (1.0 + power) * math.sqrt(most / max(far - reached, most))
    return size * (ease - flexion + slope * (far - reached)), size * slope * pull.weight


def _span(upper: float, fore: float, flexion: float) -> float:
    """Return how far a limb reaches that is bent by an angle [m]."""
    return math.sqrt(upper * upper + fore * fore + 2.0 * upper * fore * math.cos(flexion))


def leg_strain(extension: float, own: float) -> tuple[float, float]:
    """Return how far a leg is from its ease, and how that changes with its extension."""
    bend, held = (math.sqrt(max(1.0 - each, 0.0) + 0.004) for each in (extension, own))
    # Knee and leg are springs of one length: together they are one.
    knee = KNEE_SPRING / (2.0 * bend)
    square = knee * knee + LEG_SPRING * LEG_SPRING
    force = knee * KNEE_SPRING * (held - bend) + LEG_SPRING * LEG_SPRING * (extension - own)
    slope = math.sqrt(square)
    return force / slope, slope


def stiffen(
    stiff: list[float], first: int, lever: Vector, aim: Vector, string: float, own: float = 0.0
) -> None:
    """Add what a pull stiffens across its direction: that of a string, and of a pendulum.

    Gauss-Newton leaves it out, and would swing from side to side.
    """
    more = string * (own + dot(lever, lever) + max(dot(aim, lever), 0.0))
    for at in range(first, first + 3):
        stiff[at] += more


def step_with_taut_legs(step: Row, yields: Sequence[Row], legs: Sequence[tuple[Row, float]]) -> Row:
    """Return a step of a tree after which its two legs are no longer than straight.

    One that counted on longer legs would end beside its way. A row more changes what is solved by a
    multiple of how its own force would be solved (Sherman and Morrison 1950). Straight legs only
    push. Which of them do is tried: one that pulled would hold the pelvis wherever it was.

    Parameters
    ----------
    yields
        What is solved for the force of each leg.
    legs
        How each gets longer, with a negative sign, and by how much at most.
    """
    over = [-_product(row, step) - room for row, room in legs]
    if max(over) <= 0.0:
        return step
    give = [[_product(row, each) for each in yields] for row, _ in legs]
    own = [give[leg][leg] + TAUT_LEG**-2 for leg in (0, 1)]
    for leg, other in ((0, 1), (1, 0)):
        force = over[leg] / own[leg]
        if force > 0.0 and over[other] <= force * give[other][leg]:
            return _moved(step, yields[leg], force)
    whole = own[0] * own[1] - give[0][1] * give[1][0]
    first = (over[0] * own[1] - over[1] * give[0][1]) / whole
    second = (over[1] * own[0] - over[0] * give[1][0]) / whole
    return _moved(_moved(step, yields[0], first), yields[1], second)


def _product(row: Row, change: Row) -> float:
    product: float = sum(map(operator.mul, row, change))
    return product


def _moved(step: Row, way: Row, share: float) -> Row:
    return [value + share * more for value, more in zip(step, way, strict=True)]
