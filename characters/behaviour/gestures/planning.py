"""From a symbolic gesture to key postures of one character (Huang 2013, sections 8.4 to 8.7).

Targeting and gathering give key frames of hands and body; the trunk is turned, the gesture space
turns with it, and the upper body reaches for its places. All of it happens once, when a gesture
begins; its frames are interpolated.
"""

import math
import warnings
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from characters.behaviour.expressivity import NEUTRAL, GestureExpressivity
from characters.behaviour.gestures.contacts import OTHER_HAND, BodySurface
from characters.behaviour.gestures.gathering import KeyFrame, gather
from characters.behaviour.gestures.motion import GestureMotion
from characters.behaviour.gestures.space import GestureSpace
from characters.behaviour.gestures.timing import Repeats, stroke_length
from characters.behaviour.gestures.tracks import (
    ORIENTATION,
    POSITION,
    SHAPES,
    HandTrack,
    hand_track,
    one_period,
    sided,
    smooth,
)
from characters.behaviour.gestures.trunk import TrunkTurns, body_track, chest_part
from characters.behaviour.intents import Hand
from characters.behaviour.symbolic_gesture import BodyKey, HandKey, SymbolicGesture
from characters.errors import CharacterWarning
from characters.ik.reaching import HandTarget, ReachStyle, UpperBody
from characters.ik.sitting_up import SittingUp
from characters.model.character import Character
from characters.model.standing import idle_clips
from characters.skeleton import rotations
from characters.skeleton.masks import subtree
from characters.skeleton.pose import Array, Pose

SIDES = {"left": True, "right": False}
"""Sides of hands, and whether they are left."""

EASY, STRETCHED = 0.75, 0.95
"""Distances of a wrist from its shoulder ÷ the arm's length: as asked for below, never above."""

STRETCHED_ON_FOUR = 0.8
"""The same for front legs, whose trunk would else stretch after them."""

NEGLIGIBLE = 1e-6
"""Sine of half an angle below which a joint of the trunk is not turned."""

FLIP_RAD = math.radians(60.0)
"""A joint that turns so far from one of the dense postures to the next flips [rad]."""

CHARACTERS = 8
"""Characters whose bodies are kept for their next animator."""

PLANS = 64
"""Plans that are kept for when a gesture comes again."""


@dataclass(frozen=True, eq=False)
class Performer:
    """The body of a character, as far as gestures need it."""

    character: Character
    """Who."""

    posture: Pose
    """How it stands while it gestures; a four-legged one sits up."""

    body: UpperBody
    """Its arms."""

    trunk: TrunkTurns
    """Its trunk, shoulders and head."""

    surface: BodySurface
    """Where it can be touched."""

    space: GestureSpace
    """Its gesture space in the posture."""

    chest: int
    """The joint that carries the gesture space."""

    arms: Mapping[str, NDArray[np.intp]]
    """Joints of collarbone, arm, hand and fingers by side."""

    @staticmethod
    def of(character: Character) -> "Performer":
        """Return what a character gestures with; the last few characters' are kept."""
        for kept in _KEPT:
            if kept.character.skeleton is character.skeleton:
                return kept
        _KEPT.append(Performer.measured(character))
        return _KEPT[-1]

    @staticmethod
    def measured(character: Character) -> "Performer":
        """Return what a character gestures with, anew."""
        skeleton, anatomy = character.skeleton, character.anatomy
        idle = idle_clips(character.clips)
        posture = idle[0].sample(0.0) if idle else skeleton.rest
        sitting = SittingUp.of(skeleton, anatomy)
        if sitting is not None:
            posture = sitting.sit_up(posture, 1.0)
        body = UpperBody.of(skeleton, anatomy)
        surface = BodySurface(skeleton, anatomy, character.meshes, posture)
        joints = {}
        for side, arm in body.arms.items():
            collarbone, upper, *_ = arm.joints
            below = subtree(skeleton, upper)
            joints[side] = np.array([*([collarbone] if collarbone >= 0 else []), *below], np.intp)
        chest = anatomy.joint(chest_part(anatomy)) if "hips" in anatomy.joints else None
        return Performer(
            character,
            posture,
            body,
            TrunkTurns.of(skeleton, anatomy, posture),
            surface,
            _space(character, posture, body),
            0 if chest is None else chest,
            joints,
        )

    def plan(
        self,
        gesture: SymbolicGesture,
        hand: Hand = "right",
        expressivity: GestureExpressivity = NEUTRAL,
    ) -> GestureMotion:
        """Return the stroke of a gesture as this body performs it.

        Without the arms that it needs, the rest of the body performs it, with a
        `CharacterWarning`.
        """
        return _plan(self, gesture, hand, expressivity)


_KEPT: deque[Performer] = deque(maxlen=CHARACTERS)


@lru_cache(maxsize=PLANS)
def _plan(
    performer: Performer, gesture: SymbolicGesture, hand: Hand, expressivity: GestureExpressivity
) -> GestureMotion:
    return _Planner(performer, gesture, hand, expressivity).motion()


class _Planner:
    """Plans one gesture of one body."""

    def __init__(
        self,
        performer: Performer,
        gesture: SymbolicGesture,
        hand: Hand,
        expressivity: GestureExpressivity,
    ) -> None:
        self.performer = performer
        self._turned_postures: dict[bytes, tuple[Pose, Array]] = {}
        self._four_legs = performer.character.anatomy.kind == "quadruped"
        self.expressivity = expressivity
        self.duration = stroke_length(gesture)
        self.style = ReachStyle(
            min(max(expressivity.openness, 0.0), 1.0), min(max(expressivity.power, 0.0), 1.0)
        )
        space = performer.space
        self.space = GestureSpace(np.zeros(3), space.arm, expressivity.spatial)
        shown, mirrored = sided(gesture, hand)
        self.repeats = repeats = Repeats.of(gesture)
        body = one_period(shown.body, repeats) or (BodyKey(0.0),)
        self.body = body_track(body, mirrored, expressivity)
        keys = {"right": one_period(shown.right, repeats), "left": one_period(shown.left, repeats)}
        asked = {side: each for side, each in keys.items() if each}
        self.keys = {side: each for side, each in asked.items() if side in performer.body.arms}
        if len(self.keys) < len(asked):
            missing = " and ".join(side for side in asked if side not in self.keys)
            warnings.warn(
                f"{performer.character.name} performs {gesture.name} without its {missing} arm",
                CharacterWarning,
                stacklevel=4,
            )
        upright = performer.posture.globals(performer.character.skeleton)[performer.chest]
        self.joint_from_chest = np.linalg.inv(upright)
        self.tracks = self._hand_tracks()

    def motion(self) -> GestureMotion:
        """Return the key postures."""
        parts = {side: track.keys for side, track in self.tracks.items()} | {"body": self.body}
        frames = gather(parts)
        if len(frames) == 1:  # a pose that is held
            frames = [KeyFrame(time, frames[0].parts) for time in (0.0, 1.0)]
        times = np.array([frame.time for frame in frames])
        poses = np.stack([self._posture(frame).rotations for frame in frames])
        for side, track in self.tracks.items():
            self._overshoot(poses, times, side, track)
            self._steady(poses, times, side)
        held = [self.performer.arms[side] for side in self.tracks]
        arms = np.concatenate([np.zeros(0, np.intp), *held])
        trunk = np.setdiff1d(self.performer.trunk.joints, arms)
        before = self.performer.posture.rotations[trunk]
        added = rotations.multiply(rotations.conjugate(before), poses[:, trunk])
        turned = (np.abs(added[..., :3]) > NEGLIGIBLE).any(axis=(0, 2))
        return GestureMotion(
            self.performer.posture,
            times,
            arms,
            rotations.continuous(poses[:, arms]),
            trunk[turned],
            rotations.continuous(added[:, turned]),
            self.repeats,
            self.duration,
        )

    def _hand_tracks(self) -> dict[str, HandTrack]:
        """Return the tracks of both hands; one that meets the other comes after it."""
        tracks: dict[str, HandTrack] = {}

        def meetings(side: str) -> int:
            return sum(key.place.contact == OTHER_HAND for key in self.keys[side])

        for side in sorted(self.keys, key=meetings):
            other = next(iter(tracks.values()), None)
            tracks[side] = hand_track(
                self.keys[side],
                [self._place(key, SIDES[side], other) for key in self.keys[side]],
                self.space,
                SIDES[side],
                self.expressivity,
            )
        return tracks

    def _place(self, key: HandKey, left: bool, other: HandTrack | None) -> Array:
        """Return where a key is from the middle of the chest, (3,) in its upright frame [m]."""
        offset = self.space.vector(np.array(key.place.offset) * self.space.arm, left)
        if key.place.contact == OTHER_HAND:
            met: Array = np.zeros(3) if other is None else other.keys.between(key.at)[POSITION]
            return met + offset
        if key.place.contact:
            _, posed = self._turned(self.body.between(key.at))
            place = self.performer.surface.place(key.place.contact, left, posed)
            if place is not None:
                turn, chest = self._chest(posed)
                touched: Array = (place - chest) @ turn
                size = 1.0 + self.space.spatial  # the body is as large as ever
                return touched + (offset / size if size > 0.0 else 0.0)
        return self.space.point(key.place, left)

    def _turned(self, row: Array) -> tuple[Pose, Array]:
        """Return the posture with trunk and head turned by a row of the body's track.

        With it comes `character_from_joint` of all joints, (joints, 4, 4).
        """
        key = row.tobytes()
        if key not in self._turned_postures:
            pose = self.performer.trunk.turned(self.performer.posture, row)
            self._turned_postures[key] = pose, pose.globals(self.performer.character.skeleton)
        return self._turned_postures[key]

    def _chest(self, posed: Array) -> tuple[Array, Array]:
        """Return how the chest is turned from its posture, (3, 3), and the space's middle, (3,)."""
        moved = posed[self.performer.chest] @ self.joint_from_chest
        turn = moved[:3, :3]
        return turn, turn @ self.performer.space.chest + moved[:3, 3]

    def _posture(self, frame: KeyFrame) -> Pose:
        """Return the whole body at a key frame."""
        pose, posed = self._turned(frame.parts["body"])
        turn, chest = self._chest(posed)
        targets = {}
        for side in self.tracks:
            row = frame.parts[side]
            hand = turn @ rotations.to_matrix(rotations.normalize(row[ORIENTATION]))
            fingers, palm = hand[:, 0], hand[:, 2]
            place = self._within_reach(turn @ row[POSITION] + chest, fingers, side, posed)
            targets[side] = HandTarget(place, "reach", palm, fingers)
        if targets:
            pose = self.performer.body.reach(
                pose, targets.get("left"), targets.get("right"), self.style
            )  # a new pose, whose fingers may be bent
        for side, track in self.tracks.items():
            self._shape(pose, side, track.shapes, frame.parts[side][SHAPES])
        return pose

    def _within_reach(self, place: Array, fingers: Array, side: str, posed: Array) -> Array:
        """Return where a palm is to be, so that the wrist is not too far from its shoulder, (3,).

        Who gestures shows where something is and need not get there: what is out of reach is
        compressed into the last part of the way, and the torso leans only a little.
        """
        arm = self.performer.body.arms[side]
        palm = float(np.linalg.norm(np.subtract(arm.hand.palm, arm.wrist)))
        offset = place - palm * fingers - posed[arm.joints[1], :3, 3]
        distance = float(np.linalg.norm(offset)) / (arm.upper + arm.fore)
        most = STRETCHED_ON_FOUR if self._four_legs else STRETCHED
        beyond = (distance - EASY) / (most - EASY)
        if beyond <= 0.0:
            return place
        taken = EASY + (most - EASY) * -math.expm1(-beyond)
        nearer: Array = place - offset * (1.0 - taken / distance)
        return nearer

    def _shape(self, pose: Pose, side: str, shapes: tuple[str, ...], weights: Array) -> None:
        """Bend the fingers of a pose of our own."""
        postures = [self.performer.body.shapes.posture(side, shape) for shape in shapes]
        if len(postures[0].joints):
            turns = rotations.align(
                np.stack([each.rotations for each in postures]), postures[0].rotations
            )
            mixed = np.einsum("s,sji->ji", weights, turns)
            pose.rotations[postures[0].joints] = rotations.normalize(mixed)

    def _steady(self, poses: Array, times: Array, side: str) -> None:
        """Turn joints that flip from posture to posture from one key of the gesture to the next.

        A paw that cannot face as it is asked to is turned as far as it goes, to either side.
        """
        joints = self.performer.arms[side]
        turns = poses[:, joints]
        cosines = np.abs(np.vecdot(turns[1:], turns[:-1]))
        flipping = joints[(cosines < math.cos(FLIP_RAD / 2.0)).any(axis=0)]
        if not len(flipping):
            return
        keys = np.searchsorted(times, [key.at for key in self.keys[side]])
        for start, end in pairwise(keys.tolist()):
            share = (times[start : end + 1] - times[start]) / (times[end] - times[start])
            poses[start : end + 1, flipping] = rotations.slerp(
                poses[start, flipping], poses[end, flipping], smooth(share)[:, None]
            )

    def _overshoot(self, poses: Array, times: Array, side: str, track: HandTrack) -> None:
        """Turn the arm beyond its keys where power lets it."""
        joints = self.performer.arms[side]
        for over in track.overshoots:
            start, end = (int(np.searchsorted(times, time)) for time in (over.start, over.end))
            first, last = poses[start, joints], poses[end, joints]
            way = rotations.to_rotation_vector(rotations.multiply(rotations.conjugate(first), last))
            frames = np.flatnonzero((times > over.times[0] - 1e-9) & (times < over.end))
            shares = np.interp(times[frames], [*over.times, over.end], [*over.shares, 0.0])
            beyond = rotations.from_rotation_vector(way * shares[:, None, None])
            poses[np.ix_(frames, joints)] = rotations.multiply(last, beyond)


def _space(character: Character, posture: Pose, body: UpperBody) -> GestureSpace:
    """Return the gesture space of a body in a posture; without arms, one of usual size."""
    if not body.arms:
        height = character.height
        return GestureSpace(np.array([0.0, 0.6 * height, 0.0]), 0.3 * height)
    posed = posture.globals(character.skeleton)
    shoulders = posed[[each.joints[1] for each in body.arms.values()], :3, 3].mean(0)
    return GestureSpace.about(shoulders, arm_length(body))


def arm_length(body: UpperBody) -> float:
    """Return the mean length of its arms, shoulder to wrist [m]."""
    return float(np.mean([each.upper + each.fore for each in body.arms.values()]))
