"""The upper body of any character with arms or front legs: it puts hands where they are to be.

The order is Huang's (2013, section 8.6): the collarbones follow passively, by the power of the
movement and the strain of the arm; the torso turns and leans as far as the arms need it; the arms
bend; elbows swivel by openness; hands turn as they are asked to.
"""

import math
from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.ik.reaching.arms import (
    Arm,
    BentArm,
    Effector,
    bend,
    bend_to_wrist,
    effector_of,
    find_arm,
    scale_vector,
    to_vector,
)
from cubeling.characters.ik.reaching.bending import (
    Bearer,
    HandOnItsWay,
    open_elbow,
    orient_hand,
    passive_shoulder,
    point_finger,
    twist_forearm,
)
from cubeling.characters.ik.reaching.hand_shapes import HandShapes
from cubeling.characters.ik.reaching.kinematics import Frames, UpperBodyKinematics
from cubeling.characters.ik.reaching.swivel import natural_elbow, own_elbow, swivel_of
from cubeling.characters.ik.reaching.targets import (
    NEUTRAL_REACH,
    SHAPE_OF_KIND,
    HandTarget,
    ReachKind,
    ReachStyle,
)
from cubeling.characters.ik.reaching.torso import (
    PlacedTorso,
    Reaching,
    follow_torso,
    turn_torso,
)
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.skeleton.scalar_quaternions import (
    IDENTITY,
    Quaternion,
    Vector,
    add,
    conjugate,
    from_rotation_vector,
    multiply,
    rotate,
    subtract,
)
from cubeling.characters.skeleton.way_round import WayRound

PRONATION_RAD = math.radians(35.0)
"""How far a hand that is not asked for faces down, from facing inward."""

_FAR = 100.0  # arm lengths
_FINGER_OF_KIND = {"touch": ("Middle", "Index"), "point": ("Index", "Middle")}


class ReachedPose(NamedTuple):
    """A pose that reaches, and what it took."""

    pose: Pose

    effort: float
    """0 within the arms' reach … 1 where torso and arms are stretched; more beyond."""


class UpperBody:
    """Torso and arms of one skeleton.

    Lengths are those of the rest pose: scales of joints that change in a pose are not followed.
    """

    def __init__(self, skeleton: Skeleton, anatomy: Anatomy) -> None:
        self.shapes = HandShapes(skeleton, anatomy)
        """The shapes of its hands."""
        found = {
            hand.side: find_arm(skeleton, anatomy, hand)
            for hand in self.shapes.hands.values()
            if hand is not None
        }
        self.arms: dict[str, Arm] = {side: arm for side, arm in found.items() if arm is not None}
        """Its arms by side: none, one or both."""
        self._four_legs = anatomy.kind == "quadruped"
        self._rest = skeleton.rest.rotations
        self._effectors = {
            (side, kind): self._effector(arm, kind, skeleton)
            for side, arm in self.arms.items()
            for kind in SHAPE_OF_KIND
        }
        self._wrists = {side: effector_of(arm, arm.wrist) for side, arm in self.arms.items()}
        self.kinematics = UpperBodyKinematics(skeleton, anatomy, self.arms)
        self._written = {
            side: np.array([*arm.joints[1:], *(j for j in arm.joints[:1] if j >= 0)], np.intp)
            for side, arm in self.arms.items()
        }

    @cached_property
    def joints(self) -> NDArray[np.intp]:
        """All joints that it turns: torso, arms and fingers."""
        moved = [*self.kinematics.trunk_joints]
        for arm in self.arms.values():
            moved += [joint for joint in arm.joints if joint >= 0]
            moved += [joint for finger in arm.hand.fingers.values() for joint in finger]
        return np.array(sorted(moved), np.intp)

    @staticmethod
    def of(skeleton: Skeleton, anatomy: Anatomy) -> "UpperBody":
        """Return the upper body of a skeleton; without arms it has none and reaches nothing."""
        return UpperBody(skeleton, anatomy)

    def reach(
        self,
        pose: Pose,
        left: HandTarget | None = None,
        right: HandTarget | None = None,
        style: ReachStyle = NEUTRAL_REACH,
    ) -> Pose:
        """Return a pose with its hands where they are to be, or as near as they get."""
        return self.reach_for(pose, left, right, style).pose

    def reach_for(
        self,
        pose: Pose,
        left: HandTarget | None = None,
        right: HandTarget | None = None,
        style: ReachStyle = NEUTRAL_REACH,
    ) -> ReachedPose:
        """Return a pose with its hands where they are to be, and the effort that it takes."""
        wanted = self.wanted_hands(left, right)
        if not wanted:
            return ReachedPose(pose, 0.0)
        holds = self._four_legs and len(wanted) < len(self.arms)
        frames = self.kinematics.frames(pose, "arms")
        torso = self.kinematics.torso(frames)
        hands = [self.start_hand(frames, arm, target, style) for arm, target in wanted]
        neutral = ReachStyle(power=style.power)
        turned, effort = self._torso_turn(torso, hands, neutral)
        opened = turned
        if style.openness != NEUTRAL_REACH.openness:
            opened, _ = self._torso_turn(torso, hands, style)
        local = pose.rotations.copy()
        self.bring(local, frames, torso, hands, (turned, opened), style)
        if holds:
            self._hold(local, frames, torso, hands[0], opened)
        return ReachedPose(pose.with_rotations(local), effort)

    def wanted_hands(
        self, left: HandTarget | None, right: HandTarget | None
    ) -> list[tuple[Arm, HandTarget]]:
        """Return the arms whose hands are for something, each with what for."""
        asked = {"left": left, "right": right}
        return [
            (arm, target)
            for side, arm in self.arms.items()
            if (target := asked[side]) is not None and target.weight > 0.0
        ]

    def effort(self, pose: Pose, place: Sequence[float] | Array) -> float:
        """Return the effort to bring a palm to a place, (3,) in the character frame [m].

        The hand for which it is the least counts. It is infinite without arms.
        """
        if not self.arms:
            return math.inf
        frames = self.kinematics.frames(pose)
        torso = self.kinematics.torso(frames)
        target = HandTarget(place)
        return min(
            self._torso_turn(
                torso, [self.start_hand(frames, arm, target, NEUTRAL_REACH)], NEUTRAL_REACH
            )[1]
            for arm in self.arms.values()
        )

    def palm(self, pose: Pose, side: str) -> Array | None:
        """Return where a palm is, (3,) in the character frame [m]; None without that arm."""
        arm = self.arms.get(side)
        if arm is None:
            return None
        frames = self.kinematics.frames(pose, "arms")
        hand = self.kinematics.number[arm.joints[3]]
        moved = multiply(frames.turns[hand], conjugate(arm.rest_turns[1]))
        offset = self._effectors[side, "reach"].offset
        return np.array(add(frames.places[hand], rotate(moved, offset)))

    def bring(
        self,
        local: Array,
        frames: Frames,
        torso: PlacedTorso,
        hands: Sequence[HandOnItsWay],
        turns: tuple[Vector, Vector],
        style: ReachStyle,
    ) -> None:
        """Write a turned trunk and the arms on it that bring hands to their places.

        `turns` are those of the torso without openness, for which wrists are placed, and with it.
        """
        neutral, turned = turns
        if not self._four_legs:
            hands = [self._with_own_elbow(hand, frames, torso.chest) for hand in hands]
        bearers = [_bearer(torso, hand, neutral) for hand in hands]
        bent = [self._bend(*each) for each in zip(hands, bearers, strict=True)]
        if style.openness != NEUTRAL_REACH.openness:
            for place, (hand, arm, before) in enumerate(zip(hands, bent, bearers, strict=True)):
                wrist, after = self._wrists[hand.arm.hand.side], _bearer(torso, hand, turned)
                bent[place] = open_elbow(hand.arm, wrist, arm, before, after, style.openness)
        self.kinematics.turn_trunk(local, frames, torso.step(turned))
        whole = from_rotation_vector(turned)
        for hand, arm in zip(hands, bent, strict=True):
            self._write(local, frames, hand, arm, whole)

    def start_hand(
        self, frames: Frames, arm: Arm, target: HandTarget, style: ReachStyle | None
    ) -> HandOnItsWay:
        """Return an arm with its place, and its collarbone as it follows by a style, if at all."""
        x, y, z = to_vector(target.place)
        effector = self._effectors[arm.hand.side, target.kind]
        full = arm.upper + effector.fore
        shoulder = frames.places[self.kinematics.number[arm.joints[1]]]
        aim = subtract((x, y, z), shoulder)
        if max(map(abs, aim)) > _FAR * full:  # squares of what is very far are infinite
            scale = _FAR * full / max(map(abs, aim))
            x, y, z = add(shoulder, scale_vector(aim, scale))
        swung = IDENTITY
        if arm.joints[0] >= 0 and style is not None:
            base = frames.places[self.kinematics.number[arm.joints[0]]]
            swung = passive_shoulder(base, shoulder, (x, y, z), full, style.power)
            shoulder = add(base, rotate(swung, subtract(shoulder, base)))
        return HandOnItsWay(arm, target, effector, (x, y, z), shoulder, swung)

    def _with_own_elbow(
        self, hand: HandOnItsWay, frames: Frames, chest: Quaternion
    ) -> HandOnItsWay:
        """Return a hand whose elbow keeps what it has of its own in the pose of the frames."""
        number, arm = self.kinematics.number, hand.arm
        shoulder, elbow, wrist = (frames.places[number[joint]] for joint in arm.joints[1:])
        return hand._replace(own=own_elbow(arm, shoulder, elbow, wrist, chest))

    def _torso_turn(
        self, torso: PlacedTorso, hands: Sequence[HandOnItsWay], style: ReachStyle
    ) -> tuple[Vector, float]:
        """Return the turn of the torso for one or two hands, each as far as its weight goes."""
        if len(hands) == 1:
            turned, effort = _turn_for(torso, hands, style)
            return scale_vector(turned, hands[0].target.weight), effort
        single = [_turn_for(torso, [hand], style) for hand in hands]
        effort = max(effort for _, effort in single)
        one, other = (hand.target.weight for hand in hands)
        both, together = _turn_for(torso, hands, style)
        shares = (one * (1.0 - other), other * (1.0 - one), one * other)
        turns = (single[0][0], single[1][0], both)
        first, second, third = (scale_vector(*each) for each in zip(turns, shares, strict=True))
        return add(first, add(second, third)), max(effort, together)

    def _bend(self, hand: HandOnItsWay, bearer: Bearer) -> BentArm:
        """Return the arm of a hand with a neutral elbow."""
        arm, target = hand.arm, hand.target
        if target.kind == "point":
            return twist_forearm(arm, point_finger(hand, *bearer))
        if target.palm is None and target.fingers is None:
            elbow = natural_elbow(arm, bearer.shoulder, hand.place, bearer.chest, hand.own)
            return bend(arm, hand.effector, bearer.shoulder, hand.place, bearer.chest, elbow)
        return twist_forearm(arm, orient_hand(hand, self._wrists[arm.hand.side], *bearer))

    def _write(
        self,
        local: Array,
        frames: Frames,
        hand: HandOnItsWay,
        bent: BentArm,
        whole: Quaternion,
    ) -> None:
        """Write the local rotations of an arm and its fingers."""
        arm, weight = hand.arm, hand.target.weight
        collar, upper = (self.kinematics.number.get(joint, -1) for joint in arm.joints[:2])
        above = multiply(hand.swung, frames.turns[self.kinematics.parents[upper]])
        rows = [
            multiply(conjugate(multiply(whole, above)), bent.upper),
            multiply(conjugate(multiply(bent.upper, arm.between_bones)), bent.lower),
            multiply(conjugate(multiply(bent.lower, arm.between_fore)), bent.hand),
        ]
        if collar >= 0:
            above = frames.turns[self.kinematics.parents[collar]]
            rows.append(multiply(conjugate(above), multiply(hand.swung, frames.turns[collar])))
        joints = self._written[arm.hand.side]
        _blend(local, joints, rows, weight, hand.target.way, self._rest[joints])
        if arm.hand.fingers:
            shape = hand.target.shape or SHAPE_OF_KIND[hand.target.kind]
            posture = self.shapes.posture(arm.hand.side, shape)
            _blend(local, posture.joints, posture.rotations, weight)

    def _hold(
        self,
        local: Array,
        frames: Frames,
        torso: PlacedTorso,
        reaching: HandOnItsWay,
        turned: Vector,
    ) -> None:
        """Keep the other front paw where it is while the torso moves."""
        (arm,) = (arm for arm in self.arms.values() if arm is not reaching.arm)
        turns, places = frames
        _, upper, lower, paw = (self.kinematics.number.get(joint, -1) for joint in arm.joints)
        shoulder = torso.carry(torso.step(turned), places[upper])
        wrist = self._wrists[arm.hand.side]
        now = BentArm(turns[upper], turns[lower], turns[paw], places[paw], places[lower])
        swivel = swivel_of(arm, places[upper], places[lower], places[paw], torso.chest)
        bent = bend_to_wrist(arm, wrist, shoulder, now, torso.chest_after(turned), swivel)
        # As far as the other hand reaches: solved all at once, a paw in a gesture would jump.
        still = HandTarget(places[paw], weight=reaching.target.weight)
        held = HandOnItsWay(arm, still, wrist, places[paw], shoulder, IDENTITY)
        self._write(local, frames, held, bent, from_rotation_vector(turned))

    def _effector(self, arm: Arm, kind: ReachKind, skeleton: Skeleton) -> Effector:
        """Return what of a hand is brought to a place."""
        hand = arm.hand
        pronation = 0.0 if self._four_legs else PRONATION_RAD
        if self._four_legs or kind in ("reach", "grasp", "hold"):
            held = pronation if kind == "reach" else 0.0
            return effector_of(arm, to_vector(hand.palm), pronation=held)
        tips = self.shapes.posture(hand.side, SHAPE_OF_KIND[kind]).tips
        finger = next((name for name in _FINGER_OF_KIND[kind] if name in tips), None)
        if finger is None:
            tip = add(arm.wrist, to_vector(hand.length * hand.axes[0]))
            return effector_of(arm, tip, arm.wrist, pronation)
        knuckle = skeleton.rest.globals(skeleton)[hand.fingers[finger][0], :3, 3]
        return effector_of(arm, to_vector(tips[finger]), to_vector(knuckle), pronation)


def _turn_for(
    torso: PlacedTorso, hands: Sequence[HandOnItsWay], style: ReachStyle
) -> tuple[Vector, float]:
    """Return the turn of a torso for some hands that are to be at their places, and its effort."""
    reaching = [
        Reaching(hand.arm, hand.effector.fore, hand.shoulder, hand.place)
        for hand in hands
        if hand.target.kind != "point"
    ]
    if reaching:
        found = turn_torso(torso, reaching, style.openness, style.power)
        return found.turned, found.effort
    turns = [follow_torso(torso, hand.place, hand.arm.sign) for hand in hands]
    x, y, z = (sum(axis) / len(turns) for axis in zip(*turns, strict=True))
    return (x, y, z), 0.0


def _bearer(torso: PlacedTorso, hand: HandOnItsWay, turned: Vector) -> Bearer:
    """Return what bears the arm of a hand after a turn of the torso."""
    shoulder = torso.carry(torso.step(turned), hand.shoulder)
    return Bearer(shoulder, torso.chest_after(turned))


def _blend(
    local: Array,
    joints: NDArray[np.intp],
    turns: Array | list[Quaternion],
    weight: float,
    way: WayRound | None = None,
    rest: Array | None = None,
) -> None:
    """Turn joints to local rotations, or part of the way there."""
    if weight >= 1.0:
        local[joints] = turns
    else:
        mixed = (way or WayRound()).mix(local.take(joints, 0), np.array(turns), weight, rest)
        local[joints] = mixed
