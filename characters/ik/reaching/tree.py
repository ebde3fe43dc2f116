"""One tree of springs over pelvis, legs, trunk, collarbones and head that brings hands to places.

Every joint is a spring that holds it where the pose has it, and every target pulls: hands at their
places, feet where they stand, the middle of mass over the feet, and what is looked at (Huang 2013,
section 7.3: targets of one tree meet at the trunk, which takes the forces of all its springs). The
force of an arm is that of its elbow: none while it is bent at ease, ever more the straighter it is.
So collarbones follow passively by the energy of the arm, trunk and knees bend for what is low or
far, and no elbow snaps. Where Huang lets the springs swing until they rest, the state of rest is
found at once, by Gauss-Newton steps on the energy. Limbs are bent to it by the law of cosines.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cubeling.characters.ik.reaching.arms import Arm, cone_axis, scale_vector
from cubeling.characters.ik.reaching.torso import PlacedTorso
from cubeling.characters.skeleton.scalar_quaternions import (
    Quaternion,
    Vector,
    add,
    conjugate,
    cross,
    dot,
    from_rotation_vector,
    length,
    multiply,
    rotate,
    subtract,
    to_rotation_vector,
)

FIRST_STEPS, STEPS = 12, 2
"""Gauss-Newton steps from a pose, and from what was found for the frame before."""

SHIFT_SPRING: Vector = (5.0, 1.0, 5.0)
"""How stiff the pelvis holds its place, left, up and ahead [1/body height]."""

PELVIS_SPRING: Vector = (2.2, 3.0, 6.0)
"""How stiff the pelvis holds its direction: bow, turn and tilt."""

SPINE_SPRING: Vector = (2.8, 2.4, 4.0)
"""How stiff the whole spine holds its shape: bow, turn and tilt."""

COLLAR_SPRING = 3.0
"""How stiff a collarbone is."""

PELVIS_RANGE_DEG = ((-15.0, 60.0), (-40.0, 40.0), (-12.0, 12.0))
"""How far a pelvis bows, turns and tilts over planted feet [degrees]."""

SPINE_RANGE_DEG = ((-20.0, 65.0), (-40.0, 40.0), (-30.0, 30.0))
"""How far a whole spine does, however many joints it has [degrees]."""

COLLAR_RANGE_RAD = math.radians(25.0)
"""How far a collarbone turns."""

LIMIT_SPRING = 14.0
"""How stiff a joint is beyond its range."""

ELBOW_SPRING, EASY_FLEXION_RAD = 1.0, math.radians(61.0)
"""How stiff an elbow is that is bent less than it is at ease [rad]."""

KNEE_SPRING, LEG_SPRING, TAUT_LEG = 1.2, 4.0, 150.0
"""How stiff a knee is, a leg that shortens, and one that is longer than it can be."""

BALANCE_SPRING = 12.0
"""How stiff the middle of mass holds its place over the feet [1/body height]."""

CONE_SPRING, CONE_RAD = 3.0, math.radians(85.0)
"""How stiff a shoulder joint is beyond an angle from the middle of what its hand reaches."""

GAZE_SPRING, GAZE_RAD = 1.0, math.radians(55.0)
"""How stiff a neck is that is turned further than this to see."""

STRAIGHT_RAD = math.radians(16.0)
"""An elbow bent less than this is as good as straight: its spring goes on linearly, so that a place
out of reach pulls with a finite force."""

SPARE, MAX_SHORT = 0.015, 0.06
"""Length of an arm that is kept in reserve, and what it may lack at most before it pulls no harder,
in arm lengths."""

MAX_STEP_RAD, MAX_STEP_HEIGHTS = 0.6, 0.12
"""Longest step of a solution."""

UPPER_MASS, UPPER_MIDDLE = 0.65, 0.7
"""Mass of trunk, head and arms ÷ that of the body, and where its middle is between hips and
shoulders."""


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


class Strut(NamedTuple):
    """A leg that stands."""

    hip: Vector
    """[m]"""

    ankle: Vector
    """Where it is and stays [m]."""

    length: float
    """Of thigh and shin [m]."""


@dataclass(frozen=True)
class PlacedTree:
    """A body in one pose, in the character frame."""

    torso: PlacedTorso

    centre: Vector
    """The middle between the hips [m]."""

    legs: Sequence[Strut]
    """None of a body whose pelvis stays where it is."""

    height: float
    """Of the body [m]."""

    eyes: Vector
    """Where it looks from [m]."""


class Settled(NamedTuple):
    """How a tree is at rest: what its joints do besides the pose."""

    shift: Vector
    """Of the pelvis [m]."""

    pelvis: Vector
    """Turn of the pelvis about the middle between the hips, a rotation vector [rad]."""

    spine: Vector
    """Turn of the whole spine from the pelvis to the chest [rad]."""

    left: Vector = (0.0, 0.0, 0.0)
    """Turn of the left collarbone [rad]."""

    right: Vector = (0.0, 0.0, 0.0)
    """Turn of the right collarbone [rad]."""

    def collar(self, side: str) -> Vector:
        """Return the turn of the collarbone of a side [rad]."""
        return self.left if side == "left" else self.right


def settle(
    tree: PlacedTree,
    pulls: Mapping[str, Pull],
    power: float = 0.0,
    gaze: Vector | None = None,
    start: Settled | None = None,
    steps: int = FIRST_STEPS,
) -> Settled:
    """Return the state of rest of a tree of springs whose hands pull.

    Parameters
    ----------
    pulls
        By side.
    power
        0…1: an arm pulls harder, so that collarbones and trunk join in more.
    gaze
        What is looked at, (3,) [m]; None for nothing.
    start
        Where to start from; None for the pose.
    steps
        How many steps to make.
    """
    energy = _Energy(tree, pulls, power, gaze)
    state = [0.0] * energy.size if start is None else energy.state_of(start)
    for _ in range(steps):
        state = energy.step(state)
    return energy.settled(state)


class _Energy:
    """The energy of a tree: springs of joints are on the diagonal, targets are rows."""

    def __init__(
        self, tree: PlacedTree, pulls: Mapping[str, Pull], power: float, gaze: Vector | None
    ) -> None:
        self.tree, self.gaze = tree, gaze
        self.sides, self.pulls = list(pulls), list(pulls.values())
        self.size = 9 + 3 * len(pulls)
        self.power = power
        torso = tree.torso
        self.back = conjugate(torso.facing)
        count = max(len(torso.places), 1)
        sums = [sum(axis) / count for axis in zip(*torso.places, strict=True)]
        self.waist: Vector = (sums[0], sums[1], sums[2]) if sums else torso.top
        held = to_rotation_vector(multiply(self.back, torso.chest))
        spine = SPINE_SPRING if torso.places else (1e6, 1e6, 1e6)
        free = bool(tree.legs)
        shift = [each / tree.height if free else 1e6 for each in SHIFT_SPRING]
        pelvis = PELVIS_SPRING if free else (1e6, 1e6, 1e6)
        self.springs = [*shift, *pelvis, *spine, *([COLLAR_SPRING] * 3 * len(pulls))]
        ranges = [(-math.inf, math.inf)] * 3
        ranges += [(math.radians(low), math.radians(high)) for low, high in PELVIS_RANGE_DEG]
        ranges += [
            (min(math.radians(low), own), max(math.radians(high), own))
            for (low, high), own in zip(SPINE_RANGE_DEG, held, strict=True)
        ]
        ranges += [(-COLLAR_RANGE_RAD, COLLAR_RANGE_RAD)] * 3 * len(pulls)
        self.ranges, self.held = ranges, [0.0] * 6 + list(held) + [0.0] * 3 * len(pulls)
        self.identity = np.arange(self.size)

    def state_of(self, start: Settled) -> list[float]:
        parts = [start.shift, start.pelvis, start.spine]
        state = [value for part in parts for value in rotate(self.back, part)]
        return state + [value for side in self.sides for value in start.collar(side)]

    def settled(self, state: Sequence[float]) -> Settled:
        facing = self.tree.torso.facing
        shift, pelvis, spine = (
            rotate(facing, (state[at], state[at + 1], state[at + 2])) for at in (0, 3, 6)
        )
        collars = {
            side: (state[at], state[at + 1], state[at + 2])
            for side, at in zip(self.sides, range(9, self.size, 3), strict=True)
        }
        return Settled(shift, pelvis, spine, **collars)

    def step(self, state: list[float]) -> list[float]:
        """Return the state after one Gauss-Newton step."""
        diagonal, slope = [], []
        for value, spring, (low, high), own in zip(
            state, self.springs, self.ranges, self.held, strict=True
        ):
            square = spring * spring
            pull = square * value
            total = value + own
            over = total - high if total > high else total - low if total < low else 0.0
            if over:
                square += LIMIT_SPRING * LIMIT_SPRING
                pull += LIMIT_SPRING * LIMIT_SPRING * over
            diagonal.append(square)
            slope.append(pull)
        rows, misses = self._rows(self.settled(state), diagonal)
        jacobian = np.array(rows).reshape(-1, self.size)
        matrix = jacobian.T @ jacobian
        matrix[self.identity, self.identity] += diagonal
        change = np.linalg.solve(matrix, -(jacobian.T @ np.array(misses)) - np.array(slope))
        turned = max(float(np.abs(change[3:]).max()) / MAX_STEP_RAD, 1.0)
        shifted = float(np.abs(change[:3]).max()) / (MAX_STEP_HEIGHTS * self.tree.height)
        change /= max(turned, shifted)
        return [value + more for value, more in zip(state, change.tolist(), strict=True)]

    def _rows(self, settled: Settled, stiff: list[float]) -> tuple[list[list[float]], list[float]]:
        """Return the rows of the targets, and how far each is from rest.

        To `stiff`, the diagonal, what a pull adds to it is added.
        """
        tree, torso = self.tree, self.tree.torso
        rows: list[list[float]] = []
        misses: list[float] = []
        whole = from_rotation_vector(settled.pelvis)
        step, bent = torso.step(settled.spine), from_rotation_vector(settled.spine)
        carried = multiply(whole, bent)
        chest = multiply(carried, torso.chest) if torso.places else multiply(whole, torso.chest)
        centre = add(tree.centre, settled.shift)
        waist = self._moved(self.waist, whole, centre)

        def add_row(
            miss: float,
            way: Vector,
            place: Vector,
            share: float,
            number: int = -1,
            lever: Vector = (0.0, 0.0, 0.0),
        ) -> None:
            """Add a target that depends on where a place of the chest is."""
            row = [share * value for value in rotate(self.back, way)]
            row += rotate(self.back, cross(subtract(place, centre), way))
            row += rotate(self.back, cross(subtract(place, waist), way))
            row += [0.0] * (self.size - 9)
            if number >= 0:
                row[9 + 3 * number : 12 + 3 * number] = rotate(
                    conjugate(carried), cross(lever, way)
                )
            rows.append(row)
            misses.append(miss)

        def add_direction(miss: float, about: Vector) -> None:
            """Add a target that depends on how the chest is turned."""
            turn = rotate(self.back, about)
            rows.append([0.0, 0.0, 0.0, *turn, *turn, *([0.0] * (self.size - 9))])
            misses.append(miss)

        for number, (side, pull) in enumerate(zip(self.sides, self.pulls, strict=True)):
            swing = from_rotation_vector(settled.collar(side))
            bone = rotate(swing, subtract(pull.shoulder, pull.base))
            shoulder = self._moved(torso.carry(step, add(pull.base, bone)), whole, centre)
            aim = subtract(pull.place, shoulder)
            far = max(length(aim), 1e-9)
            away, slope = _straining(pull, far, self.power)
            if slope:
                self._stiffen(stiff, number, aim, far, away * slope, shoulder, centre, waist, bone)
                add_row(
                    away,
                    scale_vector(aim, -slope / far),
                    shoulder,
                    1.0,
                    number,
                    rotate(carried, bone),
                )
            axis = cone_axis(chest, pull.arm.sign)
            over, about = _beyond(axis, aim, far, CONE_RAD)
            if over > 0.0:
                size = CONE_SPRING * pull.weight
                add_direction(size * over, scale_vector(about, -size))
        if self.gaze is not None:
            aim = subtract(self.gaze, self._moved(torso.carry(step, tree.eyes), whole, centre))
            ahead = rotate(chest, (0.0, 0.0, 1.0))
            over, about = _beyond(ahead, aim, max(length(aim), 1e-9), GAZE_RAD)
            if over > 0.0:
                add_direction(GAZE_SPRING * over, scale_vector(about, -GAZE_SPRING))
        for leg in tree.legs:
            hip = self._moved(leg.hip, whole, centre)
            way = subtract(leg.ankle, hip)
            far = max(length(way), 1e-9)
            for miss, slope in _standing(far / leg.length, _extension(leg)):
                toward = scale_vector(way, -slope / (far * leg.length))
                row = [*rotate(self.back, toward)]
                row += rotate(self.back, cross(subtract(hip, centre), toward))
                rows.append(row + [0.0] * (self.size - 6))
                misses.append(miss)
        if tree.legs:
            top = self._moved(torso.carry(step, torso.top), whole, centre)
            leant = scale_vector(subtract(subtract(top, torso.top), settled.shift), UPPER_MIDDLE)
            moved = add(settled.shift, scale_vector(leant, UPPER_MASS))
            size = BALANCE_SPRING / tree.height
            for way in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)):
                share = UPPER_MASS * UPPER_MIDDLE
                row_way = scale_vector(way, size * share)
                add_row(size * dot(moved, way), row_way, top, 1.0 / share)
        return rows, misses

    def _stiffen(
        self,
        stiff: list[float],
        number: int,
        aim: Vector,
        far: float,
        force: float,
        shoulder: Vector,
        centre: Vector,
        waist: Vector,
        bone: Vector,
    ) -> None:
        """Add what a pull stiffens across its direction: that of a string, and of a pendulum.

        Gauss-Newton leaves it out, and would swing from side to side.
        """
        string = force / far
        for at in range(3):
            stiff[at] += string
        for first, lever in (
            (3, subtract(shoulder, centre)),
            (6, subtract(shoulder, waist)),
            (9 + 3 * number, bone),
        ):
            more = string * (dot(lever, lever) + max(dot(aim, lever), 0.0))
            for at in range(first, first + 3):
                stiff[at] += more

    def _moved(self, place: Vector, whole: Quaternion, centre: Vector) -> Vector:
        """Return where the pelvis takes a place."""
        return add(centre, rotate(whole, subtract(place, self.tree.centre)))


def _extension(leg: Strut) -> float:
    return length(subtract(leg.ankle, leg.hip)) / leg.length


def _straining(pull: Pull, far: float, power: float) -> tuple[float, float]:
    """Return how far an elbow is from its ease, and how that changes with the distance [1/m]."""
    upper, fore = pull.arm.upper, pull.fore
    ease = EASY_FLEXION_RAD * (1.0 + 0.3 * power)
    near = _span(upper, fore, ease)
    far += SPARE * (upper + fore)
    if far <= near:
        return 0.0, 0.0
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


def _standing(extension: float, own: float) -> list[tuple[float, float]]:
    """Return misses of the springs of a leg, and how they change with its extension."""
    bend, held = (math.sqrt(max(1.0 - each, 0.0) + 0.004) for each in (extension, own))
    shorter = extension - own
    rows = [
        (KNEE_SPRING * (held - bend), KNEE_SPRING / (2.0 * bend)),
        (LEG_SPRING * shorter, LEG_SPRING),
    ]
    longest = max(own, 0.99)
    if extension > longest:
        rows.append((TAUT_LEG * (extension - longest), TAUT_LEG))
    return rows


def _beyond(axis: Vector, aim: Vector, far: float, most: float) -> tuple[float, Vector]:
    """Return how far an aim is beyond an angle from an axis, and the axis of turning to it."""
    about = cross(axis, aim)
    sine = length(about)
    over = math.atan2(sine, dot(axis, aim)) - most
    return over, scale_vector(about, 1.0 / max(sine, 1e-9 * far))
