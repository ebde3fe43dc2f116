"""From a symbolic gesture to key postures of one character (Huang 2013, sections 8.4 to 8.7).

Targeting and gathering give key frames of hands and body, `KeyPostures` the postures. It happens
once for a gesture, a few postures a frame while the hands are on their way to the first one.
"""

import math
import warnings
from collections import deque
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np

from cubeling.characters.behaviour.expressivity import NEUTRAL, GestureExpressivity
from cubeling.characters.behaviour.gestures.body import SIDES, GestureBody
from cubeling.characters.behaviour.gestures.gathering import KeyFrame, gather
from cubeling.characters.behaviour.gestures.motion import GestureMotion
from cubeling.characters.behaviour.gestures.place.contacts import OTHER_HAND
from cubeling.characters.behaviour.gestures.place.space import GestureSpace
from cubeling.characters.behaviour.gestures.postures import KeyPostures
from cubeling.characters.behaviour.gestures.style.trunk import body_track
from cubeling.characters.behaviour.gestures.timing import Repeats, stroke_length
from cubeling.characters.behaviour.gestures.tracks import (
    POSITION,
    HandTrack,
    choose_side,
    hand_track,
    one_period,
)
from cubeling.characters.behaviour.intents import Hand
from cubeling.characters.behaviour.symbolic_gesture import BodyKey, HandKey, SymbolicGesture
from cubeling.characters.errors import CharacterWarning
from cubeling.characters.ik.reaching import ReachStyle
from cubeling.characters.model.character import Character
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.smoothing import smoothstep

NEGLIGIBLE = 1e-6
"""Sine of half an angle below which a joint of the trunk is not turned."""

FLIP_RAD = math.radians(60.0)
"""A joint that turns so far from one of the dense postures to the next flips [rad]."""

CHARACTERS = 8
"""Characters whose bodies are kept for their next animator."""

PLANS = 64
"""Plans that are kept for when a gesture comes again."""


class GestureRealizer(GestureBody):
    """A body that plans gestures."""

    @staticmethod
    def of(character: Character) -> "GestureRealizer":
        """Return what a character gestures with; the last few characters' are kept."""
        for kept in _KEPT:
            if kept.character.skeleton is character.skeleton:
                return kept
        _KEPT.append(GestureRealizer.measure(character))
        return _KEPT[-1]

    def plan(
        self,
        gesture: SymbolicGesture,
        hand: Hand = "right",
        expressivity: GestureExpressivity = NEUTRAL,
    ) -> GestureMotion:
        """Return the strokes of a gesture as this body performs it.

        Without the arms that it needs, the rest of the body performs it, with a
        `CharacterWarning`.
        """
        return self.planning(gesture, hand, expressivity).motion

    def planning(
        self,
        gesture: SymbolicGesture,
        hand: Hand = "right",
        expressivity: GestureExpressivity = NEUTRAL,
    ) -> "GesturePlanning":
        """Return the same, to be planned from frame to frame."""
        return _planning(self, gesture, hand, expressivity)


_KEPT: deque[GestureRealizer] = deque(maxlen=CHARACTERS)


@lru_cache(maxsize=PLANS)
def _planning(
    gesture_body: GestureRealizer,
    gesture: SymbolicGesture,
    hand: Hand,
    expressivity: GestureExpressivity,
) -> "GesturePlanning":
    return GesturePlanning(gesture_body, gesture, hand, expressivity)


class GesturePlanning:
    """Plans one gesture of one body."""

    def __init__(
        self,
        gesture_body: GestureBody,
        gesture: SymbolicGesture,
        hand: Hand,
        expressivity: GestureExpressivity,
    ) -> None:
        self.gesture_body = gesture_body
        self.expressivity = expressivity
        self.duration = stroke_length(gesture)
        openness, power = (
            min(max(value, 0.0), 1.0) for value in (expressivity.openness, expressivity.power)
        )
        self._postures = KeyPostures(gesture_body, ReachStyle(openness, power))
        space = gesture_body.space
        self.space = GestureSpace(np.zeros(3), space.arm, expressivity.spatial)
        shown, mirrored = choose_side(gesture, hand)
        self.repeats = repeats = Repeats.of(gesture)
        body = one_period(shown.body, repeats) or (BodyKey(0.0),)
        self.body = body_track(body, mirrored, expressivity)
        keys = {"right": one_period(shown.right, repeats), "left": one_period(shown.left, repeats)}
        asked = {side: each for side, each in keys.items() if each}
        self.keys = {side: each for side, each in asked.items() if side in gesture_body.body.arms}
        if len(self.keys) < len(asked):
            missing = " and ".join(side for side in asked if side not in self.keys)
            warnings.warn(
                f"{gesture_body.character.name} performs {gesture.name} without its {missing} arm",
                CharacterWarning,
                stacklevel=4,
            )
        self.tracks = self._hand_tracks()
        self._shapes = {side: track.shapes for side, track in self.tracks.items()}
        parts = {side: track.keys for side, track in self.tracks.items()}
        self._frames: list[KeyFrame] = gather(parts | {"body": self.body})
        self._poses: list[Array] = []

    def advance(self, count: int) -> None:
        """Make some more of the postures, if there are any left to make."""
        done = len(self._poses)
        for frame in self._frames[done : done + count]:
            self._poses.append(self._postures.posture(frame, self._shapes).rotations)

    @cached_property
    def opening(self) -> GestureMotion:
        """The first posture, held."""
        self.advance(1 - len(self._poses))
        return self._motion(np.zeros(1), np.stack(self._poses[:1]))

    @cached_property
    def motion(self) -> GestureMotion:
        """All postures, planned to the end and smoothed; the first access takes long."""
        self.advance(len(self._frames))
        times, poses = np.array([frame.time for frame in self._frames]), np.stack(self._poses)
        for side, track in self.tracks.items():
            self._overshoot(poses, times, side, track)
            self._steady(poses, times, side)
        return self._motion(times, poses)

    def _motion(self, times: Array, poses: Array) -> GestureMotion:
        held = [self.gesture_body.arms[side] for side in self.tracks]
        arms = np.concatenate([np.zeros(0, np.intp), *held])
        trunk = np.setdiff1d(self.gesture_body.trunk.joints, arms)
        before = self.gesture_body.posture.rotations[trunk]
        added = rotations.multiply(rotations.conjugate(before), poses[:, trunk])
        turned = (np.abs(added[..., :3]) > NEGLIGIBLE).any(axis=(0, 2))
        return GestureMotion(
            self.gesture_body.posture,
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
            _, posed = self._postures.turn_by(self.body.between(key.at))
            place = self.gesture_body.surface.place(key.place.contact, left, posed)
            if place is not None:
                turn, chest = self._postures.chest(posed)
                touched: Array = (place - chest) @ turn
                size = 1.0 + self.space.spatial  # the body is as large as ever
                return touched + (offset / size if size > 0.0 else 0.0)
        return self.space.point(key.place, left)

    def _steady(self, poses: Array, times: Array, side: str) -> None:
        """Turn joints that flip from posture to posture from one key of the gesture to the next.

        A paw that cannot face as it is asked to is turned as far as it goes, to either side.
        """
        joints = self.gesture_body.arms[side]
        turns = poses[:, joints]
        cosines = np.abs(np.vecdot(turns[1:], turns[:-1]))
        flipping = joints[(cosines < math.cos(FLIP_RAD / 2.0)).any(axis=0)]
        if not len(flipping):
            return
        keys = np.searchsorted(times, [key.at for key in self.keys[side]])
        for start, end in pairwise(keys.tolist()):
            share = (times[start : end + 1] - times[start]) / (times[end] - times[start])
            poses[start : end + 1, flipping] = rotations.slerp(
                poses[start, flipping], poses[end, flipping], smoothstep(share)[:, None]
            )

    def _overshoot(self, poses: Array, times: Array, side: str, track: HandTrack) -> None:
        """Turn the arm beyond its keys where power lets it."""
        joints = self.gesture_body.arms[side]
        for over in track.overshoots:
            start, end = (int(np.searchsorted(times, time)) for time in (over.start, over.end))
            first, last = poses[start, joints], poses[end, joints]
            way = rotations.to_rotation_vector(rotations.multiply(rotations.conjugate(first), last))
            frames = np.flatnonzero((times > over.times[0] - 1e-9) & (times < over.end))
            shares = np.interp(times[frames], [*over.times, over.end], [*over.shares, 0.0])
            beyond = rotations.from_rotation_vector(way * shares[:, None, None])
            poses[np.ix_(frames, joints)] = rotations.multiply(last, beyond)
