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
from typing import NamedTuple

import numpy as np

from cubeling.characters.ik.reaching.arms import cone_axis, scale_vector
from cubeling.characters.ik.reaching.limb_springs import (
    Pull,
    Row,
    arm_strain,
    leg_strain,
    step_with_taut_legs,
    stiffen,
)
from cubeling.characters.ik.reaching.placed_tree import PlacedTree, Settled, Strut
from cubeling.characters.ik.reaching.torso import PlacedTorso
from cubeling.characters.skeleton.scalar_quaternions import (
    IDENTITY,
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

FIRST_STEPS, STEP_S = 20, 1 / 30
"""Gauss-Newton steps from a pose; from what was found for an earlier frame, one for so long [s]."""

SHIFT_SPRING: Vector = (5.0, 1.0, 5.0)
"""How stiff the pelvis holds its place, left, up and ahead [1/body height]."""

PELVIS_SPRING: Vector = (2.2, 3.0, 6.0)
"""How stiff the pelvis holds its direction: bow, turn and tilt."""

SPINE_SPRING: Vector = (2.8, 2.4, 4.0)
"""How stiff the whole spine holds its shape: bow, turn and tilt."""

COLLAR_SPRING, COLLAR_RANGE_RAD = 3.0, math.radians(25.0)
"""How stiff a collarbone is, and how far it turns."""

PELVIS_RANGE_DEG = ((-15.0, 50.0), (-40.0, 40.0), (-12.0, 12.0))
"""How far a pelvis bows, turns and tilts over planted feet [degrees]."""

SPINE_RANGE_DEG = ((-20.0, 65.0), (-40.0, 40.0), (-30.0, 30.0))
"""How far a whole spine does, however many joints it has [degrees]; one of few joints bends less,
as far as these do by their natural limits."""

LIMIT_SPRING = 14.0
"""How stiff a joint is beyond its range."""

LONGEST_LEG, SHORTEST_LEG = 0.99, 0.55
"""Extension of a leg that is straight, unless the pose has it straighter, and of one that is folded
up, ÷ its length."""

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
        matrix.ravel()[:: len(state) + 1] += stiff  # the diagonal
        force = np.array(self.misses) @ jacobian + slope
        sides = np.array([force, *(row for row, _ in self.leg_rows)])
        change, *yields = np.linalg.solve(matrix, sides.T).T.tolist()
        if self.leg_rows:
            change = step_with_taut_legs(change, yields, self.leg_rows)
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
        posed = self._posed(state)
        for number, pull in enumerate(self.pulls):
            self._add_pull(number, pull, posed, stiff)
        if self.gaze is not None:
            ahead = rotate(posed.chest, (0.0, 0.0, 1.0))
            aim = subtract(self.gaze, posed.carry(self.eyes))
            self._add_direction(GAZE_SPRING, ahead, aim, GAZE_RAD)
        for leg, own in zip(self.legs, self.own, strict=True):
            self._add_leg(leg, own, posed)
        if self.legs:
            self._add_balance(posed)

    def _posed(self, state: Sequence[float]) -> "_Posed":
        sx, sy, sz, px, py, pz, bx, by, bz, *collars = state
        whole, bent = from_rotation_vector((px, py, pz)), from_rotation_vector((bx, by, bz))
        centre = add(self.centre, (sx, sy, sz))
        waist = add(centre, rotate(whole, subtract(self.waist, self.centre)))
        carried = multiply(whole, bent)
        step = self.torso.step((bx, by, bz))
        chest = multiply(carried, self.torso.chest)
        swings = [
            from_rotation_vector((x, y, z)) for x, y, z in zip(*[iter(collars)] * 3, strict=True)
        ]
        return _Posed(
            self.torso,
            self.centre,
            (sx, sy, sz),
            centre,
            waist,
            whole,
            step,
            carried,
            chest,
            swings,
        )

    def _add_pull(self, number: int, pull: Pull, posed: "_Posed", stiff: list[float]) -> None:
        """Add an arm that pulls at its shoulder, and a chest that faces what it reaches for."""
        at = 9 + 3 * number
        bone = rotate(posed.swings[number], subtract(pull.shoulder, pull.base))
        shoulder = posed.carry(add(pull.base, bone))
        aim = subtract(pull.place, shoulder)
        far = max(length(aim), 1e-9)
        miss, slope = arm_strain(pull, far, self.power)
        if slope:
            way = scale_vector(aim, -slope / far)
            row = self._add_place(miss, way, shoulder, way, posed)
            lever = rotate(posed.carried, bone)
            row[at : at + 3] = rotate(conjugate(posed.carried), cross(lever, way))
            stiffen(stiff, 0, (0.0, 0.0, 0.0), aim, miss * slope / far, 1.0)
            for first, joint in ((3, posed.centre), (6, posed.waist)):
                stiffen(stiff, first, subtract(shoulder, joint), aim, miss * slope / far)
            stiffen(stiff, at, lever, aim, miss * slope / far)
        axis = cone_axis(posed.chest, pull.arm.sign)
        self._add_direction(CONE_SPRING * pull.weight, axis, aim, CONE_RAD)

    def _add_leg(self, leg: Strut, own: float, posed: "_Posed") -> None:
        """Add a leg that holds what stands on it."""
        hip = add(posed.centre, rotate(posed.whole, subtract(leg.hip, self.centre)))
        aim = subtract(leg.ankle, hip)
        far = max(length(aim), 1e-9)
        miss, slope = leg_strain(far / leg.length, own)
        way = scale_vector(aim, -slope / (far * leg.length))
        row = [*way, *cross(subtract(hip, posed.centre), way), *[0.0] * (len(self.springs) - 6)]
        self.rows.append(row)
        room = max(own, LONGEST_LEG) - far / leg.length
        self.leg_rows.append(([value / slope for value in row], room))
        self.misses.append(miss)

    def _add_balance(self, posed: "_Posed") -> None:
        """Add the middle of mass, which stays over the feet."""
        top = posed.carry(self.torso.top)
        share = UPPER_MASS * UPPER_MIDDLE
        shift = posed.shift
        moved = add(shift, scale_vector(subtract(subtract(top, self.torso.top), shift), share))
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
            self._add_place(miss, way, top, scale_vector(axis, size), posed)

    def _add_place(
        self, miss: float, way: Vector, place: Vector, shift: Vector, posed: "_Posed"
    ) -> Row:
        """Add a target of a place that the chest carries; return its row."""
        pelvis = cross(subtract(place, posed.centre), way)
        spine = cross(subtract(place, posed.waist), way)
        row = [*shift, *pelvis, *spine, *[0.0] * (len(self.springs) - 9)]
        self.rows.append(row)
        self.misses.append(miss)
        return row

    def _add_direction(self, size: float, axis: Vector, aim: Vector, most: float) -> None:
        """Add a target of where the chest faces, if an aim is further away than `most`."""
        x, y, z = cross(axis, aim)
        sine = math.sqrt(x * x + y * y + z * z)
        over = math.atan2(sine, dot(axis, aim)) - most
        if over > 0.0 and sine > 1e-9:
            turn = scale_vector((x, y, z), -size / sine)
            none = [0.0] * (len(self.springs) - 9)
            self.rows.append([0.0, 0.0, 0.0, *turn, *turn, *none])
            self.misses.append(size * over)


class _Posed(NamedTuple):
    """Where the joints of a tree are in a state."""

    torso: PlacedTorso
    old_centre: Vector
    shift: Vector
    centre: Vector
    waist: Vector
    whole: Quaternion
    """Turn of the pelvis."""

    step: Quaternion
    """Turn of each joint of the spine."""

    carried: Quaternion
    """Turn of what the spine carries."""

    chest: Quaternion
    swings: list[Quaternion]
    """Of the collarbones."""

    def carry(self, place: Vector) -> Vector:
        """Return where a place of the chest is [m]."""
        there = self.torso.carry(self.step, place)
        return add(self.centre, rotate(self.whole, subtract(there, self.old_centre)))


_LEFT: Vector = (1.0, 0.0, 0.0)
_FIXED = (1e6,) * 6  # springs of a pelvis that has no legs to stand on
_SPINE_RANGES = tuple((math.radians(a), math.radians(b)) for a, b in SPINE_RANGE_DEG)
_PELVIS_RANGES = (
    *((-math.inf, math.inf),) * 3,
    *((math.radians(a), math.radians(b)) for a, b in PELVIS_RANGE_DEG),
)
