"""Whole bodies that reach: the tree of springs in a skeleton, with planted feet and a level head.

The tree is at rest with hands at their places (`tree.py`); then the pelvis moves, legs bend below
it to where their feet are, trunk and collarbones turn, and arms are bent as `UpperBody` does it.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cubeling.characters.ik import two_bones
from cubeling.characters.ik.heels import bend_to_foot
from cubeling.characters.ik.reaching.arms import scale_vector, to_vector
from cubeling.characters.ik.reaching.bending import HandOnItsWay
from cubeling.characters.ik.reaching.kinematics import Frames
from cubeling.characters.ik.reaching.limb_springs import Pull
from cubeling.characters.ik.reaching.placed_tree import PlacedTree, Settled, Strut
from cubeling.characters.ik.reaching.targets import NEUTRAL_REACH, HandTarget, ReachStyle
from cubeling.characters.ik.reaching.torso import PlacedTorso, Reaching, shortfall
from cubeling.characters.ik.reaching.tree import FIRST_STEPS, settle
from cubeling.characters.ik.reaching.upper_body import UpperBody
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.skeleton.scalar_quaternions import (
    IDENTITY,
    Quaternion,
    Vector,
    add,
    between,
    conjugate,
    from_rotation_vector,
    length,
    multiply,
    rotate,
    subtract,
    to_rotation_vector,
)

LEVEL_SHARE, MAX_LEVEL_RAD = 0.7, 0.9
"""Part of the turn of the chest that neck and head undo, and how far at most: it sees on."""

KNEE_SHARE = 0.2
"""Part of a turn of the pelvis that knees go along with. They follow their planted feet: knees that
follow the pelvis turn ankles beyond their range, and those that follow feet alone turn hips so."""

EFFORT_STEPS = 10
"""Steps to find how far a hand gets: fewer than to look right."""

HANG_SHARE = 0.8
"""Part of the lean of the chest that an arm undoes that has nothing to do: it hangs."""


class WholeBody:
    """A body on two legs that reaches with all of it."""

    def __init__(self, upper: UpperBody) -> None:
        self.upper = upper
        kinematics = upper.kinematics
        number, stance = kinematics.number, kinematics.stance
        self._pelvis = number[stance.pelvis]
        self.legs = [[number[joint] for joint in leg] for leg in stance.legs]
        self.neck = [number[joint] for joint in stance.neck]
        carried: list[bool] = []
        for place, parent in enumerate(kinematics.parents):
            carried.append(place == self._pelvis or (parent >= 0 and carried[parent]))
        self._carried = carried
        self.toes = [
            number[toe] if carried[number[leg[2]]] else -1
            for leg, toe in zip(stance.legs, stance.toes, strict=True)
        ]
        moved = []
        for leg, toe, bent in zip(stance.legs, stance.toes, self.toes, strict=True):
            moved += [joint for joint in leg if carried[number[joint]]]
            moved += [toe] if bent >= 0 else []
        self._leg_rows, self._neck_rows = np.array(moved, np.intp), np.array(stance.neck, np.intp)

    @staticmethod
    def of(upper: UpperBody) -> "WholeBody | None":
        """Return the whole body about an upper one; None without a trunk, or on four legs."""
        kinematics = upper.kinematics
        known = kinematics.trunk_joints.size and (kinematics.stance.legs or kinematics.stance.neck)
        return WholeBody(upper) if known else None

    def place(
        self, pose: Pose, left: HandTarget | None = None, right: HandTarget | None = None
    ) -> "PlacedBody | None":
        """Return the body in a pose, with what its hands are for; None if they are for nothing."""
        upper = self.upper
        wanted = upper.wanted_hands(left, right)
        if not wanted:
            return None
        frames = upper.kinematics.frames(pose, "all")
        hands = [upper.start_hand(frames, arm, target, None) for arm, target in wanted]
        return PlacedBody(self, pose, frames, upper.kinematics.torso(frames), hands)

    def reach(
        self,
        pose: Pose,
        left: HandTarget | None = None,
        right: HandTarget | None = None,
        style: ReachStyle = NEUTRAL_REACH,
    ) -> Pose:
        """Return a pose with its hands where they are to be, or as near as they get."""
        placed = self.place(pose, left, right)
        return pose if placed is None else placed.bring(placed.settle(style), style)

    def shortfall(self, pose: Pose, place: Sequence[float] | Array) -> float:
        """Return what the nearer hand lacks to a place, (3,) [m], in lengths of its arm."""
        upper, number, target = self.upper, self.upper.kinematics.number, HandTarget(place)
        where, places = to_vector(place), upper.kinematics.frames(pose).places
        side = min(
            upper.arms,
            key=lambda each: math.dist(where, places[number[upper.arms[each].joints[1]]]),
        )
        placed = self.place(pose, **{side: target})
        assert placed is not None
        return placed.shortfall(placed.settle(steps=EFFORT_STEPS))

    def move_pelvis(
        self, local: Array, shifts: Array, frames: Frames, tree: PlacedTree, settled: Settled
    ) -> None:
        """Move the pelvis in local transforms, and bend the legs so that feet stay as they are."""
        if not self.legs:
            return
        kinematics, pelvis, (turns, places) = self.upper.kinematics, self._pelvis, frames
        parents, row = kinematics.parents, kinematics.stance.pelvis
        above, whole = parents[pelvis], from_rotation_vector(settled.pelvis)
        turn = turns[above] if above >= 0 else IDENTITY
        local[row] = multiply(conjugate(turn), multiply(whole, turns[pelvis]))
        offset = subtract(places[pelvis], tree.centre)
        moved = add(settled.shift, subtract(rotate(whole, offset), offset))
        x, y, z = rotate(conjugate(turn), moved)
        shifts[row] += np.array([x, y, z]) / kinematics.size_above(pelvis)
        rows: list[Quaternion] = []
        for leg, toe, angle in zip(self.legs, self.toes, kinematics.ankle_angles, strict=True):
            hip = subtract(places[leg[0]], tree.centre)
            hip = add(add(tree.centre, settled.shift), rotate(whole, hip))
            rows += self._bent_leg(leg, toe, angle, frames, hip, whole)
        local[self._leg_rows] = rows

    def _bent_leg(
        self,
        leg: Sequence[int],
        toe: int,
        rest_angle: float,
        frames: Frames,
        hip_place: Vector,
        whole: Quaternion,
    ) -> Iterator[Quaternion]:
        """Yield the local rotations of a leg below a pelvis that has turned, its foot planted.

        Its knee bends in the plane of the pose: it goes with the foot more than with the pelvis.
        """
        (turns, places), parents, (hip, knee, ankle) = frames, self.upper.kinematics.parents, leg
        along = from_rotation_vector(scale_vector(to_rotation_vector(whole), KNEE_SHARE))
        thigh, leg_line = (
            rotate(along, subtract(places[joint], places[hip])) for joint in (knee, ankle)
        )
        bones = hip_place, add(hip_place, thigh), add(hip_place, leg_line)
        if toe >= 0:
            upper, lower, lift = bend_to_foot(bones, places[ankle], places[toe], rest_angle)
        else:
            (upper, lower), lift = two_bones.reach(*bones, places[ankle]), IDENTITY
        both, upper = multiply(upper, multiply(lower, along)), multiply(upper, along)
        above_hip = multiply(whole, turns[parents[hip]])
        yield multiply(conjugate(above_hip), multiply(upper, turns[hip]))
        above_knee = multiply(upper, turns[parents[knee]])
        yield multiply(conjugate(above_knee), multiply(both, turns[knee]))
        if self._carried[ankle]:
            above_foot = multiply(both, turns[parents[ankle]])
            yield multiply(conjugate(above_foot), multiply(lift, turns[ankle]))
        if toe >= 0:
            above_toe = multiply(lift, turns[parents[toe]])
            yield multiply(conjugate(above_toe), turns[toe])

    def level_head(self, local: Array, frames: Frames, turned: Quaternion) -> None:
        """Let neck and head undo most of a turn of the chest from its pose, that of the frames."""
        if not self.neck:
            return
        x, y, z = to_rotation_vector(turned)
        angle = length((x, y, z))
        share = min(LEVEL_SHARE, MAX_LEVEL_RAD / max(angle, 1e-9)) / len(self.neck)
        step = from_rotation_vector((-share * x, -share * y, -share * z))
        # Undone about the axis of the turn itself, it is the same before that turn as after it.
        done, rows = IDENTITY, []
        for joint in self.neck:
            above = multiply(done, frames.turns[self.upper.kinematics.parents[joint]])
            done = multiply(step, done)
            rows.append(multiply(conjugate(above), multiply(done, frames.turns[joint])))
        local[self._neck_rows] = rows

    def hang_arms(self, local: Array, frames: Frames, turned: Quaternion) -> None:
        """Let arms hang from a chest that has turned from its pose; hands go on from there."""
        x, y, z = to_rotation_vector(between((0.0, 1.0, 0.0), rotate(turned, (0.0, 1.0, 0.0))))
        undone = from_rotation_vector((-HANG_SHARE * x, -HANG_SHARE * y, -HANG_SHARE * z))
        hang = multiply(conjugate(turned), multiply(undone, turned))
        kinematics = self.upper.kinematics
        for arm in self.upper.arms.values():
            joint = kinematics.number[arm.joints[1]]
            above = frames.turns[kinematics.parents[joint]]
            local[arm.joints[1]] = multiply(conjugate(above), multiply(hang, frames.turns[joint]))


@dataclass(frozen=True)
class PlacedBody:
    """A whole body in one pose, and what its hands are for."""

    body: WholeBody

    pose: Pose

    frames: Frames
    """Of all its joints."""

    torso: PlacedTorso

    hands: Sequence[HandOnItsWay]
    """The hands that are for something."""

    @cached_property
    def tree(self) -> PlacedTree:
        """Its tree of springs."""
        places, body = self.frames.places, self.body
        legs = []
        for hip, knee, ankle in body.legs:
            thigh = length(subtract(places[knee], places[hip]))
            shin = length(subtract(places[ankle], places[knee]))
            legs.append(Strut(places[hip], places[ankle], thigh + shin))
        centre = self.torso.places[0]
        if legs:
            centre = scale_vector(add(legs[0].hip, legs[1].hip), 0.5)
        eyes = places[body.neck[-1]] if body.neck else self.torso.top
        kinematics = body.upper.kinematics
        return PlacedTree(
            self.torso, kinematics.spine_ranges, centre, legs, kinematics.height, eyes
        )

    def settle(
        self,
        style: ReachStyle = NEUTRAL_REACH,
        gaze: Vector | None = None,
        start: Settled | None = None,
        steps: int = FIRST_STEPS,
    ) -> Settled:
        """Return its tree at rest; see `tree.settle`."""
        pulls = {hand.arm.hand.side: self._pull(hand) for hand in self.hands}
        return settle(self.tree, pulls, style.power, gaze, start, steps)

    def shortfall(self, settled: Settled) -> float:
        """Return what its hands lack to their places in a tree at rest, in lengths of their arms.

        That of the worst hand; 0 where all are there.
        """
        seen = [self._seen(hand, settled) for hand in self.hands]
        reaching = [
            Reaching(each.arm, each.effector.fore, each.shoulder, each.place) for each in seen
        ]
        return shortfall(self.torso, reaching, settled.spine)

    def bring(self, settled: Settled, style: ReachStyle = NEUTRAL_REACH) -> Pose:
        """Return the pose of a tree at rest, with its hands at their places."""
        body, upper, frames = self.body, self.body.upper, self.frames
        local, shifts = self.pose.rotations.copy(), self.pose.translations.copy()
        turned = multiply(from_rotation_vector(settled.pelvis), from_rotation_vector(settled.spine))
        body.level_head(local, frames, turned)
        body.hang_arms(local, frames, turned)
        body.move_pelvis(local, shifts, frames, self.tree, settled)
        # What the pelvis carries is solved as it sees it: as if it had not moved, but the places.
        hands = [self._seen(hand, settled) for hand in self.hands]
        upper.bring(local, frames, self.torso, hands, (settled.spine, settled.spine), style)
        return Pose(shifts, local, self.pose.scales, self.pose.morphs)

    def _pull(self, hand: HandOnItsWay) -> Pull:
        """Return what a hand pulls with."""
        base = self._collar_base(hand) or hand.shoulder  # which moves only with the chest
        # What is only pointed to does not pull: the arm is as long as it is.
        weight = 0.0 if hand.target.kind == "point" else hand.target.weight
        return Pull(hand.arm, hand.effector.fore, base, hand.shoulder, hand.place, weight)

    def _collar_base(self, hand: HandOnItsWay) -> Vector | None:
        """Return where the collarbone of a hand begins; None if its body has none."""
        collar = hand.arm.joints[0]
        if collar < 0:
            return None
        return self.frames.places[self.body.upper.kinematics.number[collar]]

    def _seen(self, hand: HandOnItsWay, settled: Settled) -> HandOnItsWay:
        """Return a hand as the pelvis sees it, with its collarbone turned."""
        target = hand.target
        if target.palm is not None or target.fingers is not None:
            back = conjugate(from_rotation_vector(settled.pelvis))
            palm, fingers = (
                None if each is None else rotate(back, to_vector(each))
                for each in (target.palm, target.fingers)
            )
            target = replace(target, palm=palm, fingers=fingers)
        place = seen_from_pelvis(hand.place, self.tree, settled)
        base, shoulder, swung = self._collar_base(hand), hand.shoulder, IDENTITY
        if base is not None:
            swung = from_rotation_vector(settled.collar(hand.arm.hand.side))
            shoulder = add(base, rotate(swung, subtract(shoulder, base)))
        return hand._replace(target=target, place=place, shoulder=shoulder, swung=swung)


def seen_from_pelvis(place: Vector, tree: PlacedTree, settled: Settled) -> Vector:
    """Return where a place would be that moved against the pelvis as this moves to its rest [m]."""
    away = subtract(place, add(tree.centre, settled.shift))
    return add(tree.centre, rotate(conjugate(from_rotation_vector(settled.pelvis)), away))
