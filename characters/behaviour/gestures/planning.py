"""From a symbolic gesture to key postures of one character (Huang 2013, sections 8.4 to 8.7).

Targeting and gathering give key frames of hands and body, `KeyPostures` the postures. It happens
once for a gesture, a few postures a frame while the hands are on their way to the first one.
"""

import math
import warnings
from bisect import bisect_left
from collections import deque
from functools import cached_property, lru_cache
from itertools import islice
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.behaviour.expressivity import NEUTRAL, GestureExpressivity
from cubeling.characters.behaviour.gestures.body import SIDES, GestureBody
from cubeling.characters.behaviour.gestures.gathering import KeyFrame, gather
from cubeling.characters.behaviour.gestures.motion import (
    FINGER_LAG_S,
    WRIST_LAG_S,
    GestureMotion,
    MovedJoints,
    StrokeKey,
)
from cubeling.characters.behaviour.gestures.place.contacts import OTHER_HAND
from cubeling.characters.behaviour.gestures.place.space import GestureSpace
from cubeling.characters.behaviour.gestures.postures import KeyPostures
from cubeling.characters.behaviour.gestures.style.trunk import NOD, body_track
from cubeling.characters.behaviour.gestures.timing import (
    PhaseTimes,
    Repeats,
    apex_share,
    natural_times,
)
from cubeling.characters.behaviour.gestures.tracks import (
    POSITION,
    HandTrack,
    choose_side,
    hand_track,
    one_period,
    touches,
    track_times,
)
from cubeling.characters.behaviour.intents import Hand
from cubeling.characters.behaviour.symbolic_gesture import BodyKey, HandKey, SymbolicGesture
from cubeling.characters.errors import CharacterWarning
from cubeling.characters.ik.reaching import ReachStyle
from cubeling.characters.model.character import Character
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Array

FLIP_RAD = math.radians(60.0)
"""A joint that is turned so far, at a point of a path, from where it is between the keys flips
[rad]."""

CHARACTERS = 8
"""Characters whose bodies are kept for their next animator."""

KEPT_PLANS = 64
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
        """Return a gesture as this body performs it, at its own times from 0 s on.

        Without the arms that it needs, the rest of the body performs it, with a
        `CharacterWarning`.
        """
        planning = self.planning(gesture, hand, expressivity)
        times = natural_times(gesture)
        return planning.motion(PhaseTimes(times, apex_share(gesture), gesture.retraction))

    def planning(
        self,
        gesture: SymbolicGesture,
        hand: Hand = "right",
        expressivity: GestureExpressivity = NEUTRAL,
    ) -> "GesturePlanning":
        """Return what plans it, posture by posture; a body with one arm performs with that one."""
        if gesture.one_handed and hand != "both" and len(self.body.arms) == 1:
            hand = "left" if "left" in self.body.arms else "right"
        return _planning(self, gesture, hand, expressivity)


_KEPT: deque[GestureRealizer] = deque(maxlen=CHARACTERS)


@lru_cache(maxsize=KEPT_PLANS)
def _planning(
    gesture_body: GestureRealizer,
    gesture: SymbolicGesture,
    hand: Hand,
    expressivity: GestureExpressivity,
) -> "GesturePlanning":
    return GesturePlanning(gesture_body, gesture, hand, expressivity)


class GesturePlanning:
    """Plans one gesture of one body: the key postures of its strokes."""

    def __init__(
        self,
        gesture_body: GestureBody,
        gesture: SymbolicGesture,
        hand: Hand,
        expressivity: GestureExpressivity,
    ) -> None:
        self.gesture_body = gesture_body
        self.expressivity = expressivity
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
        self._turns: dict[int, Array] = {}
        self.joints = self._moved_joints()

    def advance(self, count: int) -> None:
        """Make some more of the postures, if there are any left to make."""
        missing = (each for each in self.numbers if each not in self._turns)
        for number in islice(missing, count):
            self.turns(number)

    def motion(self, times: PhaseTimes, start: Array | None = None) -> GestureMotion:
        """Return the gesture at given times; it makes its postures when it needs them.

        `start` has the rotations of the arms where it begins, (a, 4); without, they are at rest.
        """
        return GestureMotion(
            self.gesture_body.posture,
            self.joints,
            self.keys_of_strokes,
            self.turns,
            self._stops,
            self.expressivity,
            times,
            start,
        )

    def turns(self, number: int) -> Array:
        """Return a key posture: the rotations of `joints`, (a + t, 4)."""
        if number not in self._turns:
            frame = self._frames[number]
            local = self._postures.posture(frame, self._shapes).rotations
            trunk = self.joints.trunk
            before = rotations.conjugate(self.gesture_body.posture.rotations[trunk])
            added = rotations.multiply(before, local[trunk])
            turns = np.concatenate([local[self.joints.arms], added])
            self._steady(turns, frame.time)
            self._turns[number] = turns
        return self._turns[number]

    @cached_property
    def _times(self) -> list[float]:
        return [frame.time for frame in self._frames]

    @cached_property
    def _written(self) -> list[float]:
        """Times of the keys that the gesture has for hands, 0…1 of a period."""
        return sorted({key.at for keys in self.keys.values() for key in keys})

    @property
    def numbers(self) -> range:
        """Numbers of its key postures."""
        return range(len(self._frames))

    @cached_property
    def keys_of_strokes(self) -> tuple[StrokeKey, ...]:
        """The key postures of all strokes, in the order of time."""
        repeats, last = self.repeats, self.repeats.count - 1
        return tuple(
            StrokeKey(repeats.in_all(period, time), number, self._way_to(time))
            for period in range(repeats.count)
            for number, time in enumerate(self._times)
            # The last key of a period is the first one of the next; the last one has no way back.
            if (time > 0.0 or period == 0) and (period < last or time <= repeats.share)
        )

    def _way_to(self, time: float) -> Literal["path", "line", "round"]:
        """Return how hands get to a key posture."""
        if time not in self._written:
            return "path"
        after = [next((k for k in keys if k.at >= time), keys[-1]) for keys in self.keys.values()]
        return "round" if any(key.path in ("circle", "wave") for key in after) else "line"

    @cached_property
    def _stops(self) -> NDArray[np.bool_]:
        """Joints of hands that touch something at a key posture, (numbers, a + t)."""
        joints, body = self.joints.all, self.gesture_body
        stops = np.zeros((len(self._frames), len(joints)), bool)
        for side, keys in self.keys.items():
            for number, time in enumerate(self._times):
                contact = touches(keys, time)
                sides = list(self.keys) if contact == OTHER_HAND else [side]
                for each in sides if contact else []:
                    stops[number] |= np.isin(joints, body.arms[each])
        return stops

    def _moved_joints(self) -> MovedJoints:
        body, skeleton = self.gesture_body, self.gesture_body.character.skeleton
        arms = np.concatenate([np.zeros(0, np.intp), *(body.arms[side] for side in self.tracks)])
        turned = body.trunk.joints
        if not self.body.values[:, NOD:].any():
            turned = np.setdiff1d(turned, body.trunk.head)
        trunk = np.setdiff1d(turned, arms)
        lags = np.zeros(len(arms) + len(trunk))
        for side in self.tracks:
            hand = body.body.arms[side].joints[3]
            lags[: len(arms)][np.isin(arms, subtree(skeleton, hand))] = FINGER_LAG_S
            lags[: len(arms)][arms == hand] = WRIST_LAG_S
        still = np.tile((0.0, 0.0, 0.0, 1.0), (len(trunk), 1))
        return MovedJoints(arms, trunk, lags, np.concatenate([body.posture.rotations[arms], still]))

    def _hand_tracks(self) -> dict[str, HandTrack]:
        """Return the tracks of both hands; one that meets the other comes after it."""
        places: dict[str, list[Array]] = {}

        def meetings(side: str) -> int:
            return sum(key.place.contact == OTHER_HAND for key in self.keys[side])

        def track(side: str, times: Array) -> HandTrack:
            return hand_track(self.keys[side], places[side], times, self.space, SIDES[side])

        for side in sorted(self.keys, key=meetings):
            keys, other = self.keys[side], next(iter(places), None)
            met = np.zeros((len(keys), 3))
            if other is not None and meetings(side):
                at = np.array([key.at for key in keys])
                met = track(other, at).keys.values[:, POSITION]
            places[side] = [
                self._place(key, SIDES[side], place) for key, place in zip(keys, met, strict=True)
            ]
        # Either hand is on its path where the other one, or the trunk, has a key.
        arm = self.space.arm
        times = [track_times(self.keys[side], places[side], arm) for side in places]
        of_all = np.unique(np.concatenate([self.body.times, *times]))
        return {side: track(side, of_all) for side in places}

    def _place(self, key: HandKey, left: bool, met: Array) -> Array:
        """Return where a key is from the middle of the chest, (3,) in its upright frame [m].

        The other hand is at `met`.
        """
        offset = self.space.vector(np.array(key.place.offset) * self.space.arm, left)
        if key.place.contact == OTHER_HAND:
            met_there: Array = met + offset
            return met_there
        if key.place.contact:
            _, posed = self._postures.turn_by(self.body.between(key.at))
            place = self.gesture_body.surface.place(key.place.contact, left, posed)
            if place is not None:
                turn, chest = self._postures.chest(posed)
                touched: Array = (place - chest) @ turn
                size = 1.0 + self.space.spatial  # the body is as large as ever
                return touched + (offset / size if size > 0.0 else 0.0)
        return self.space.point(key.place, left)

    def _steady(self, turns: Array, time: float) -> None:
        """Turn joints that flip at a point of a path as they are turned at the keys about it.

        A paw that cannot face as it is asked to is turned as far as it goes, to either side.
        """
        if time in self._written or not self._written:
            return
        after = bisect_left(self._written, time)
        if not 0 < after < len(self._written):
            return
        low, high = self._written[after - 1], self._written[after]
        first, last = (self.turns(self._times.index(each)) for each in (low, high))
        between = rotations.slerp(first, last, (time - low) / (high - low))
        flips = np.abs(np.vecdot(turns, between)) < math.cos(FLIP_RAD / 2.0)
        turns[flips] = between[flips]
