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
import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cubeling.characters.ik.reaching.arms import cone_axis, scale_vector
from cubeling.characters.ik.reaching.limb_springs import Pull, arm_strain, leg_strain, stiffen
from cubeling.characters.ik.reaching.torso import PlacedTorso
from cubeling.characters.skeleton.scalar_quaternions import (
    IDENTITY,
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

FIRST_STEPS, STEP_S = 20, 1 / 30
"""Gauss-Newton steps from a pose; from what was found for an earlier frame, one for so long [s]."""

SHIFT_SPRING: Vector = (5.0, 1.0, 5.0)
"""How stiff the pelvis holds its place, left, up and ahead [1/body height]."""

PELVIS_SPRING: Vector = (2.2, 3.0, 6.0)
"""How stiff the pelvis holds its direction: bow, turn and tilt."""

SPINE_SPRING: Vector = (2.8, 2.4, 4.0)
"""How stiff the whole spine holds its shape: bow, turn and tilt."""

COLLAR_SPRING = 3.0
"""How stiff a collarbone is."""

PELVIS_RANGE_DEG = ((-15.0, 50.0), (-40.0, 40.0), (-12.0, 12.0))
"""How far a pelvis bows, turns and tilts over planted feet [degrees]."""

SPINE_RANGE_DEG = ((-20.0, 65.0), (-40.0, 40.0), (-30.0, 30.0))
"""How far a whole spine does, however many joints it has [degrees]; one of few joints bends less,
as far as these do by their natural limits."""

COLLAR_RANGE_RAD = math.radians(25.0)
"""How far a collarbone turns."""

LIMIT_SPRING = 14.0
"""How stiff a joint is beyond its range."""

LONGEST_LEG, SHORTEST_LEG = 0.99, 0.55
"""Extension of a leg that is straight, unless the pose has it straighter, and of one that is folded
up, ÷ its length."""

TAUT_LEG = 300.0
"""How stiff a straight leg is."""

BALANCE_SPRING, FALLING_SPRING = 12.0, 120.0
"""How stiff the middle of mass holds its place over the feet, and beyond them [1/body height]."""

FOOT_HALF_WIDTH, FOOT_AHEAD, FOOT_BEHIND = 0.02, 0.07, 0.04
"""How far it moves to the side of an outer ankle, ahead and back before it is beyond the feet
[body heights]."""

CONE_SPRING, CONE_RAD = 3.0, math.radians(85.0)
"""How stiff a shoulder joint is beyond an angle from the middle of what its hand reaches."""

GAZE_SPRING, GAZE_RAD = 1.0, math.radians(55.0)
"""How stiff a neck is that is turned further than this to see."""

STEP_SHARE = 0.65
"""Share of each step that is made: where a range ends, whole steps go to and fro about the end."""

MAX_STEP_RAD, MAX_STEP_HEIGHTS = 0.6, 0.12
"""Longest step of a solution."""

UPPER_MASS, UPPER_MIDDLE = 0.65, 0.7
"""Mass of trunk, head and arms ÷ that of the body, and where its middle is between hips and
shoulders."""


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

    spine_ranges: Sequence[tuple[float, float]]
    """How far the joints of its spine bow, turn and tilt together [rad]."""

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
    state = [0.0] * len(energy.springs) if start is None else energy.state_of(start)
    for _ in range(steps):
        state = energy.step(state)
    return energy.as_settled(energy.plant(state))


Row = list[float]
"""How a miss changes with the state: shift, pelvis, spine and collarbones."""


class _Energy:
    """The energy of a tree: springs of joints are on the diagonal, targets are rows.

    All is in the frame of the pelvis in the pose, as the springs of pelvis and spine have its axes.
    """

    def __init__(
        self, tree: PlacedTree, pulls: Mapping[str, Pull], power: float, gaze: Vector | None
    ) -> None:
        torso, back = tree.torso, conjugate(tree.torso.facing)
        self.facing, self.height, self.power = torso.facing, tree.height, power
        places = [rotate(back, place) for place in torso.places]
        chest = multiply(back, torso.chest)
        top, self.centre = rotate(back, torso.top), rotate(back, tree.centre)
        self.torso = PlacedTorso(places, IDENTITY, chest, top, torso.limits)
        count = 1.0 / len(places)
        x, y, z = (sum(axis) for axis in zip(*places, strict=True))
        self.waist: Vector = (count * x, count * y, count * z)
        self.legs = [
            Strut(rotate(back, leg.hip), rotate(back, leg.ankle), leg.length) for leg in tree.legs
        ]
        self.own = [length(subtract(leg.ankle, leg.hip)) / leg.length for leg in self.legs]
        apart = 0.5 * length(subtract(tree.legs[0].ankle, tree.legs[1].ankle)) if tree.legs else 0.0
        side = apart + FOOT_HALF_WIDTH * tree.height
        self.support = (
            (-side, side),
            (-FOOT_BEHIND * tree.height, FOOT_AHEAD * tree.height),
        )
        self.eyes = rotate(back, tree.eyes)
        self.gaze = None if gaze is None else rotate(back, gaze)
        self.up: Vector = rotate(back, (0.0, 1.0, 0.0))
        self.sides = list(pulls)
        self.pulls = [
            pull._replace(
                base=rotate(back, pull.base),
                shoulder=rotate(back, pull.shoulder),
                place=rotate(back, pull.place),
            )
            for pull in pulls.values()
        ]
        stands = [*(each / tree.height for each in SHIFT_SPRING), *PELVIS_SPRING]
        self.springs = [*(stands if self.legs else _FIXED), *SPINE_SPRING]
        self.springs += [COLLAR_SPRING] * 3 * len(pulls)
        held = to_rotation_vector(chest)
        self.ranges = [*_PELVIS_RANGES]
        for whole, joints, own in zip(_SPINE_RANGES, tree.spine_ranges, held, strict=True):
            low, high = max(whole[0], joints[0]) - own, min(whole[1], joints[1]) - own
            self.ranges.append((min(low, 0.0), max(high, 0.0)))
        self.ranges += [(-COLLAR_RANGE_RAD, COLLAR_RANGE_RAD)] * 3 * len(pulls)
        self.diagonal = np.arange(len(self.springs))
        self.rows: list[Row] = []
        self.leg_rows: list[tuple[Row, float]] = []
        self.misses: list[float] = []

    def state_of(self, start: Settled) -> list[float]:
        """Return a state as the numbers that are solved for."""
        back = conjugate(self.facing)
        state = [value for part in start[:3] for value in rotate(back, part)]
        return state + [v for side in self.sides for v in rotate(back, start.collar(side))]

    def as_settled(self, state: Sequence[float]) -> Settled:
        """Return the numbers that are solved for as a state."""
        parts = [
            rotate(self.facing, (state[at], state[at + 1], state[at + 2]))
            for at in range(0, len(state), 3)
        ]
        return Settled(*parts[:3], **dict(zip(self.sides, parts[3:], strict=True)))

    def step(self, state: list[float]) -> list[float]:
        """Return the state after one Gauss-Newton step."""
        state = self.plant(state)
        stiff, slope = [], []
        for value, spring, (low, high) in zip(state, self.springs, self.ranges, strict=True):
            square = spring * spring
            over = value - high if value > high else value - low if value < low else 0.0
            pull = square * value
            if over:
                square += LIMIT_SPRING * LIMIT_SPRING
                pull += LIMIT_SPRING * LIMIT_SPRING * over
            stiff.append(square)
            slope.append(pull)
        self.rows, self.misses, self.leg_rows = [], [], []
        self._add_targets(state, stiff)
        jacobian = np.array(self.rows).reshape(-1, len(state))
        matrix = jacobian.T @ jacobian
        matrix[self.diagonal, self.diagonal] += stiff
        force = np.array(self.misses) @ jacobian + slope
        change = np.linalg.solve(matrix, force).tolist()
        # A leg gets no longer than straight: a step that counted on that would end beside its way.
        for row, room in self.leg_rows:
            if -math.fsum(map(operator.mul, row, change)) > room:
                longer = np.array(row)
                matrix += TAUT_LEG * TAUT_LEG * np.outer(longer, longer)
                force = force - TAUT_LEG * TAUT_LEG * room * longer
                change = np.linalg.solve(matrix, force).tolist()
        shifted = max(map(abs, change[:3])) / (MAX_STEP_HEIGHTS * self.height)
        size = STEP_SHARE / max(max(map(abs, change[3:])) / MAX_STEP_RAD, shifted, 1.0)
        return [value - size * more for value, more in zip(state, change, strict=True)]

    def plant(self, state: list[float]) -> list[float]:
        """Return a state whose pelvis is as low as its legs need, and no lower than they fold."""
        if not self.legs:
            return state
        whole = from_rotation_vector((state[3], state[4], state[5]))
        heights, lowest = [], -math.inf
        for leg, own in zip(self.legs, self.own, strict=True):
            hip = add(self.centre, rotate(whole, subtract(leg.hip, self.centre)))
            x, y, z = subtract(hip, leg.ankle)
            x, z = x + state[0], z + state[2]
            longest = max(own, LONGEST_LEG) * leg.length
            heights.append(math.sqrt(max(longest * longest - x * x - z * z, 0.0)) - y)
            lowest = max(lowest, SHORTEST_LEG * leg.length - y)
        shift = min(max(state[1], min(lowest, 0.0)), *heights)
        return [state[0], shift, *state[2:]]

    def _add_targets(self, state: Sequence[float], stiff: list[float]) -> None:
        """Add the rows of all targets; to `stiff`, the diagonal, what pulls add to it."""
        torso, (sx, sy, sz, px, py, pz, bx, by, bz, *collars) = self.torso, state
        whole, bent = from_rotation_vector((px, py, pz)), from_rotation_vector((bx, by, bz))
        step = torso.step((bx, by, bz))
        carried = multiply(whole, bent)
        chest, uncarried = multiply(carried, torso.chest), conjugate(carried)
        old, (cx, cy, cz) = self.centre, self.centre
        centre = (cx + sx, cy + sy, cz + sz)
        waist = add(centre, rotate(whole, subtract(self.waist, old)))
        none = [0.0] * len(collars)

        def add_place(miss: float, way: Vector, place: Vector, shift: Vector) -> Row:
            """Add a target of a place that the chest carries; return its row."""
            levers = (cross(subtract(place, each), way) for each in (centre, waist))
            row = [*shift, *next(levers), *next(levers), *none]
            self.rows.append(row)
            self.misses.append(miss)
            return row

        def add_direction(size: float, axis: Vector, aim: Vector, most: float) -> None:
            """Add a target of where the chest faces, if an aim is further away than `most`."""
            x, y, z = cross(axis, aim)
            sine = math.sqrt(x * x + y * y + z * z)
            over = math.atan2(sine, dot(axis, aim)) - most
            if over > 0.0 and sine > 1e-9:
                turn = scale_vector((x, y, z), -size / sine)
                self.rows.append([0.0, 0.0, 0.0, *turn, *turn, *none])
                self.misses.append(size * over)

        for number, pull in enumerate(self.pulls):
            at = 3 * number
            swing = from_rotation_vector((collars[at], collars[at + 1], collars[at + 2]))
            bone = rotate(swing, subtract(pull.shoulder, pull.base))
            place = torso.carry(step, add(pull.base, bone))
            shoulder = add(centre, rotate(whole, subtract(place, old)))
            aim = subtract(pull.place, shoulder)
            far = max(length(aim), 1e-9)
            miss, slope = arm_strain(pull, far, self.power)
            if slope:
                way = scale_vector(aim, -slope / far)
                row = add_place(miss, way, shoulder, way)
                lever = rotate(carried, bone)
                row[9 + at : 12 + at] = rotate(uncarried, cross(lever, way))
                stiffen(stiff, 0, (0.0, 0.0, 0.0), aim, miss * slope / far, 1.0)
                for first, joint in ((3, centre), (6, waist)):
                    stiffen(stiff, first, subtract(shoulder, joint), aim, miss * slope / far)
                stiffen(stiff, 9 + at, lever, aim, miss * slope / far)
            add_direction(CONE_SPRING * pull.weight, cone_axis(chest, pull.arm.sign), aim, CONE_RAD)
        if self.gaze is not None:
            eyes = add(centre, rotate(whole, subtract(torso.carry(step, self.eyes), old)))
            ahead = rotate(chest, (0.0, 0.0, 1.0))
            add_direction(GAZE_SPRING, ahead, subtract(self.gaze, eyes), GAZE_RAD)
        for leg, own in zip(self.legs, self.own, strict=True):
            hip = add(centre, rotate(whole, subtract(leg.hip, old)))
            aim = subtract(leg.ankle, hip)
            far = max(length(aim), 1e-9)
            miss, slope = leg_strain(far / leg.length, own)
            way = scale_vector(aim, -slope / (far * leg.length))
            row = [*way, *cross(subtract(hip, centre), way), 0.0, 0.0, 0.0, *none]
            self.rows.append(row)
            room = max(own, LONGEST_LEG) - far / leg.length
            self.leg_rows.append(([value / slope for value in row], room))
            self.misses.append(miss)
        if self.legs:
            top = add(centre, rotate(whole, subtract(torso.carry(step, torso.top), old)))
            x, y, z = subtract(top, torso.top)
            share = UPPER_MASS * UPPER_MIDDLE
            moved = (sx + share * (x - sx), sy + share * (y - sy), sz + share * (z - sz))
            ahead = cross(_LEFT, self.up)
            for axis, (low, high) in zip((_LEFT, ahead), self.support, strict=True):
                away, spring = dot(moved, axis), BALANCE_SPRING / self.height
                beyond = away - high if away > high else away - low if away < low else 0.0
                size, miss = spring, spring * away
                if beyond:
                    hard = FALLING_SPRING / self.height
                    size = math.hypot(spring, hard)
                    miss = (spring * spring * away + hard * hard * beyond) / size
                way = scale_vector(axis, size * share)
                add_place(miss, way, top, scale_vector(axis, size))


_LEFT: Vector = (1.0, 0.0, 0.0)
_FIXED = (1e6,) * 6  # springs of a pelvis that has no legs to stand on
_SPINE_RANGES = tuple((math.radians(a), math.radians(b)) for a, b in SPINE_RANGE_DEG)
_PELVIS_RANGES = (
    *((-math.inf, math.inf),) * 3,
    *((math.radians(a), math.radians(b)) for a, b in PELVIS_RANGE_DEG),
)
