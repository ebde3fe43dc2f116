"""Hands that reach for places, touch, grasp and point: `CharacterCommand.behaviour.reaches`."""

import math
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.behaviour.intents import ReachIntent
from cubeling.characters.body.capsules import fitted_capsules
from cubeling.characters.control.layers.behaviour import gaze_of
from cubeling.characters.control.layers.layer import FrameContext
from cubeling.characters.control.layers.reach.hands import JOIN_S, NearestHand, ReachingHand
from cubeling.characters.errors import CharacterError
from cubeling.characters.ik.reaching import HandTarget, ReachStyle
from cubeling.characters.ik.reaching.arms import scale_vector
from cubeling.characters.ik.reaching.placed_tree import Settled
from cubeling.characters.ik.reaching.surface import BodySurface
from cubeling.characters.ik.reaching.tree import FIRST_STEPS, STEP_S
from cubeling.characters.ik.reaching.whole_body import PlacedBody
from cubeling.characters.model.character import Character
from cubeling.characters.model.standing import idle_clips
from cubeling.characters.motion.inertialization import OffsetDecay
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.skeleton.scalar_quaternions import Vector, add, length, subtract
from cubeling.characters.smoothing import low_pass

MAX_TARGET_SPEED = 3.0
"""Speed of a place that a hand follows, in body heights a second: what is faster is a jump."""

MAX_ARM_SPEED_RAD = 25.0
"""Speed of a joint of an arm that reaches [rad/s]: what is faster is a jump."""

CLEARANCE = 0.012
"""Distance of a palm from the body's surface ÷ the body's height."""

HAND_OFFSET = 0.12
"""Distance of each of two hands from the middle of what both reach for, in arm lengths."""

STYLE_LAG_S = 0.15
"""Lag with which openness and power follow [s]."""

TRUNK = ("hips", "spine", "chest", "head")
"""Parts of the body that hands stay out of."""


class ReachLayer:
    """Puts hands where the command asks for; it comes after posture and before gaze.

    A body on two legs reaches with all of it, as one tree of springs; another one with torso and
    arms. Hands that change their place or what they do keep no jump: the difference of the joints
    decays, and that of the tree.
    """

    def __init__(self, character: Character, seed: int = 0) -> None:
        self._body = character.upper_body
        self._whole = character.whole_body
        self._settled: Settled | None = None
        self._shown_tree: NDArray[np.float64] | None = None
        self._tree_decay: OffsetDecay | None = None
        self._joints = self._body.joints
        if self._whole is not None:
            # The trunk follows the tree, whose own jumps decay.
            self._joints = np.setdiff1d(self._joints, self._body.kinematics.trunk_joints)
        self._height = character.height
        self._four_legs = character.anatomy.kind == "quadruped"
        self._hands = {side: ReachingHand() for side in self._body.arms}
        self._shown: NDArray[np.float64] | None = None
        self._reached: NDArray[np.float64] | None = None
        self._decay: OffsetDecay | None = None
        self._switched = self._jumped = 0.0
        if not self._hands:
            return
        self._standing = standing = StandingBody.of(character)
        self._surface = standing.surface
        self._nearest = NearestHand(self._body, standing.shoulders)
        self._openness, self._power = 0.5, 0.0

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with its hands where they are to be."""
        behaviour, now = context.command.behaviour, context.command.timestamp
        reaches = () if behaviour is None else behaviour.reaches
        busy = self._shown is not None or any(hand.intent for hand in self._hands.values())
        if not self._hands or not (reaches or busy):
            return pose
        asked = dict(self._assign(reaches, context))
        step = MAX_TARGET_SPEED * self._height * max(context.elapsed, 1e-3)
        for side, hand in self._hands.items():
            if side in asked:
                away = 0.0 if hand.weight else self._away(side, pose)
                hand.follow(*asked[side], now, step, away)
            else:
                hand.leave(now)
            hand.advance(now)
        return self._move_hands(pose, context)

    def _away(self, side: str, pose: Pose) -> float:
        """Return how far an arm is from where it hangs: the largest angle of its joints [rad]."""
        joints = np.array(self._body.arms[side].joints)
        cosines = np.abs(np.vecdot(pose.rotations[joints], self._standing.rotations[joints]))
        return float(2.0 * np.arccos(cosines.min().clip(0.0, 1.0)))

    def _assign(
        self, reaches: Sequence[ReachIntent], context: FrameContext
    ) -> Iterator[tuple[str, tuple[ReachIntent, Vector]]]:
        """Yield what each hand is to do and where; of two for one hand the later one counts."""
        now = context.command.timestamp
        taken: list[str] = []
        current = [
            each
            for each in reaches
            if each.times.start <= now and (each.times.end is None or now < each.times.end)
        ]
        if any(each.hand == "nearest" for each in current):
            current.sort(key=lambda each: each.hand == "nearest")
        self._nearest.forget(reaches)
        for intent in current:
            place = self._place(intent, context)
            if intent.hand == "nearest":
                sides = [self._nearest.choose(intent, place, taken)]
            else:
                sides = [s for s in self._hands if intent.hand in (s, "both")]
            taken += sides
            for side in sides:
                shift = 0.0
                if intent.hand == "both" and len(sides) > 1:
                    arm = self._body.arms[side]
                    shift = arm.sign * HAND_OFFSET * (arm.upper + arm.fore)
                yield side, (intent, self._keep_out(side, add(place, (shift, 0.0, 0.0))))

    def _place(self, intent: ReachIntent, context: FrameContext) -> Vector:
        x, y, z = context.in_character(np.asarray(intent.target, float)).tolist()
        if not math.isfinite(x + y + z):
            raise CharacterError(
                f"reach {intent.key!r} at {context.command.timestamp} s: its target "
                f"{intent.target} is not finite; leave out what is not known"
            )
        return x, y, z

    def _keep_out(self, side: str, place: Vector) -> Vector:
        """Return a place out of the body, and so that the hand is not in the body on its way."""
        arm, shoulder = self._body.arms[side], self._nearest.shoulders[side]
        aim = subtract(place, shoulder)
        far = length(aim) / (arm.upper + arm.fore + arm.hand.length)
        nearby = place if far <= 1.0 else add(shoulder, scale_vector(aim, 1.0 / far))
        outside = self._surface.outside(nearby)
        return place if outside == nearby else outside

    def _move_hands(self, pose: Pose, context: FrameContext) -> Pose:
        hands = {side: hand for side, hand in self._hands.items() if hand.weight > 0.0}
        if not hands and self._decay is None:
            self._shown = self._reached = None
            self._settled = self._shown_tree = self._tree_decay = None
            return pose
        share = context.rest if self._four_legs else 1.0
        targets = {
            side: HandTarget(
                hand.place,
                hand.intent.kind,
                palm=context.direction_in_character(hand.intent.palm),
                weight=hand.weight * share,
                way=hand.way,
            )
            for side, hand in hands.items()
            if hand.intent is not None
        }
        style = self._style(hands, context.elapsed)
        now, join = context.command.timestamp, 0.0
        if self._shown is not None and any(hand.jumped for hand in hands.values()):
            ready = [h.intent.times.ready for h in hands.values() if h.jumped and h.intent]
            self._switched, join = now, max(*ready, now + JOIN_S) - now
        placed = None if self._whole is None else self._whole.place(pose, **targets)
        if placed is None:
            reached = self._body.reach(pose, **targets, style=style)
        else:
            reached = placed.bring(self._settle(placed, style, context, join), style)
        return self._without_jumps(reached, join, now, context.elapsed)

    def _settle(
        self, placed: PlacedBody, style: ReachStyle, context: FrameContext, join: float
    ) -> Settled:
        """Return its tree at rest; if a hand is asked to jump, it goes on from the one shown."""
        looked, now = gaze_of(context), context.command.timestamp
        gaze = context.gaze_target if looked is None else context.in_character(looked.target)
        aim: Vector | None = None if gaze is None else tuple(gaze.tolist())
        steps = FIRST_STEPS
        if self._settled is not None and not join:
            steps = min(max(round(context.elapsed / STEP_S), 1), FIRST_STEPS)
        self._settled = placed.settle(style, aim, self._settled, steps)
        values = np.array(self._settled)
        if join and self._shown_tree is not None:
            offset = self._shown_tree - values
            self._tree_decay = OffsetDecay(offset, np.zeros_like(offset), join)
        if self._tree_decay is not None:
            values = values + self._tree_decay.at(now - self._switched)
        self._shown_tree = values
        return Settled(*((x, y, z) for x, y, z in values.tolist()))

    def _style(self, hands: dict[str, ReachingHand], elapsed: float) -> ReachStyle:
        intents = [hand.intent for hand in hands.values() if hand.intent is not None]
        if intents:
            wanted = intents[0].expressivity
            fresh = self._shown is None
            lag = 1e-6 if fresh else STYLE_LAG_S
            self._openness = low_pass(self._openness, wanted.openness, elapsed, lag)
            self._power = low_pass(self._power, wanted.power, elapsed, lag)
        return ReachStyle(self._openness, self._power)

    def _without_jumps(self, pose: Pose, join: float, now: float, elapsed: float) -> Pose:
        """Return a pose that goes on from the one shown before, if a hand or its solver jumps.

        `join` is how long it takes to the new place [s]; 0 if none is asked for.
        """
        joints = self._joints
        reached = pose.rotations.take(joints, 0)
        if self._reached is not None and not join:
            cosines = np.abs(np.vecdot(reached, self._reached))
            most = min(0.5 * MAX_ARM_SPEED_RAD * elapsed, 0.5 * math.pi)
            if cosines.min(initial=1.0) < math.cos(most):
                join = JOIN_S
        self._reached = reached
        if join and self._shown is not None:
            offset = rotations.to_rotation_vector(
                rotations.multiply(self._shown, rotations.conjugate(reached))
            )
            self._decay, self._jumped = OffsetDecay(offset, np.zeros_like(offset), join), now
        if self._decay is not None:
            if now - self._jumped >= self._decay.length:
                self._decay = None
            else:
                turns = rotations.from_rotation_vector(self._decay.at(now - self._jumped))
                local = pose.rotations.copy()
                local[joints] = rotations.multiply(turns, reached)
                pose = replace(pose, rotations=local)
        self._shown = pose.rotations.take(joints, 0)
        return pose


@dataclass(frozen=True, eq=False)
class StandingBody:
    """A character as it stands: what its hands stay out of, and where its arms begin."""

    character: Character

    surface: BodySurface
    """Its trunk and head."""

    shoulders: dict[str, Vector]
    """Where its arms begin, in the character frame [m]."""

    rotations: NDArray[np.float64]
    """Those of its joints, (joints, 4)."""

    @staticmethod
    def of(character: Character) -> "StandingBody":
        """Return that of a character; the last few characters' are kept."""
        for kept in _KEPT:
            own = kept.character
            if own.skeleton is character.skeleton and own.meshes is character.meshes:
                return kept
        clips = idle_clips(character.clips)
        standing = clips[0].poses[0] if clips else character.skeleton.rest
        placed = standing.globals(character.skeleton)[:, :3, 3]
        shoulders: dict[str, Vector] = {
            side: tuple(placed[arm.joints[1]].tolist())
            for side, arm in character.upper_body.arms.items()
        }
        surface = surface_of(character, standing)
        _KEPT.append(StandingBody(character, surface, shoulders, standing.rotations))
        return _KEPT[-1]


_KEPT: deque[StandingBody] = deque(maxlen=8)


def surface_of(character: Character, standing: Pose) -> BodySurface:
    """Return the surface of a character's trunk and head as it stands."""
    skeleton, anatomy = character.skeleton, character.anatomy
    joints, ends, radii = fitted_capsules(skeleton, anatomy, character.meshes)
    placed = standing.globals(skeleton)
    capsules: list[tuple[Vector, Vector, float]] = []
    for joint, axis, radius in zip(joints, ends, radii, strict=True):
        if anatomy.parts[joint] in TRUNK:
            start, end = (placed[joint, :3, :3] @ tip + placed[joint, :3, 3] for tip in axis)
            size = float(np.linalg.norm(placed[joint, :3, 1]))
            capsules.append((tuple(start.tolist()), tuple(end.tolist()), radius * size))
    return BodySurface(capsules, CLEARANCE * character.height)
