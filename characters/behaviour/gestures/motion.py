"""A gesture as a motion: one spline through its key postures, from where the hands are to rest.

The keys are the posture that the gesture begins in, the postures of its strokes, the same again
where a hold begins and ends, and rest. So tension, continuity and bias act on all of it, a hand
passes the first key without a stop, goes a little beyond the last one, and settles there.
"""

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.behaviour.expressivity import GestureExpressivity
from cubeling.characters.behaviour.gestures.style.easing import BOUNCE_TENSION, ease_time
from cubeling.characters.behaviour.gestures.style.splines import TcbSpline
from cubeling.characters.behaviour.gestures.timing import PhaseTimes
from cubeling.characters.motion.layers import lay_over
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.skeleton.way_round import WayRound
from cubeling.characters.smoothing import smoothstep

MIN_HOLD_S = 0.02
"""Hands pass a shorter hold without a stop [s]."""

SETTLE_S = 0.2
"""Time in which hands settle where they are held [s]; a hold without room for that and for setting
off is one bend."""

LIFT_S = 0.2
"""Time in which they set off before they leave a hold [s]."""

HELD_SPEED = 0.4
"""Part of the speed of the spline with which hands come to a hold and to rest, and leave it: at
full speed they would stop with a thud."""

SWING_SHARE = 0.2
"""Last part of the retraction: the arms are at rest, swing a little further, and back."""

JOIN_SHARE = 0.84
"""Part of the preparation in which what the arms still did before fades."""

WRIST_LAG_S, FINGER_LAG_S = 0.035, 0.07
"""How far hands and fingers trail the arms between two keys [s]."""

MOST_LAG = 0.2
"""And in parts of the time between the keys; above a third they would run backwards."""

FLOW_TENSION = 0.5
"""By how much full fluidity lowers the tension."""

PATH_TENSION = 0.5
"""Greatest tension at the points of a path between two keys: with more, a circle is a polygon whose
hand stops at each corner. At keys hands stop the more."""

WIDE_RAD = math.radians(140.0)
"""A joint that turns further from key to key follows the arc from one to the other: a cubic of its
quaternion would cross the middle at a bound [rad]."""

WIDE_COSINE = math.cos(WIDE_RAD / 2.0)

BEGINNING, REST = -1, -2
"""Numbers of the keys that are not postures of the strokes."""


class StrokeKey(NamedTuple):
    """A key posture of the strokes."""

    share: float
    """When, 0…1 of all strokes."""

    number: int
    """Number of its key posture."""

    way: Literal["path", "line", "round"]
    """Whether it is a point of a path, or a key, and then whether hands get there in a circle or a
    wave: these keep their rhythm, whatever the power."""


@dataclass(frozen=True, eq=False)
class MovedJoints:
    """What a gesture turns. Arms are turned absolutely, trunk and head from the pose below."""

    arms: NDArray[np.intp]
    """Joints of arms and hands, (a,)."""

    trunk: NDArray[np.intp]
    """Joints of trunk and head, (t,)."""

    lags: Array
    """How far each trails, arms before trunk, (a + t,) [s]."""

    rest: Array
    """Rotations of arms at rest, and none of the trunk, (a + t, 4)."""

    @property
    def all(self) -> NDArray[np.intp]:
        """Arms before trunk, (a + t,)."""
        return np.concatenate([self.arms, self.trunk])


class GestureMotion:
    """One gesture of one body at given times; a `Motion` that begins at `times.start`.

    Parameters
    ----------
    posture
        The posture from which it was planned.
    joints
        What it turns.
    keys
        The key postures of all strokes, in the order of time.
    turns_of
        Returns the rotations of a key posture, (a + t, 4); it may plan it.
    stops
        Joints that stop at a key posture because their hand touches something, (numbers, a + t).
    style
        Tension, continuity, bias and power.
    times
        When the phases are.
    start
        Rotations of the arms where it begins, (a, 4); None for rest.
    """

    def __init__(
        self,
        posture: Pose,
        joints: MovedJoints,
        keys: Sequence[StrokeKey],
        turns_of: Callable[[int], Array],
        stops: NDArray[np.bool_],
        style: GestureExpressivity,
        times: PhaseTimes,
        start: Array | None = None,
    ) -> None:
        self.times = times
        self._posture, self._joints, self._turns_of = posture, joints, turns_of
        self._stops, self._style = stops, style
        self.moved, self._count = joints.all, len(joints.arms)
        """The joints that it turns."""
        self._start = joints.rest.copy()
        if start is not None:
            self._start[: self._count] = start
        self._rows, self._numbers = _rows(keys, times)
        self._spans = _eased_spans(keys, times)
        self._eased = style.power > 0.0 or style.tension > BOUNCE_TENSION
        # A hand rebounds where a stroke arrives, and not on its way up from rest.
        self._rising = replace(style, tension=min(style.tension, BOUNCE_TENSION))
        # A positive continuity turns corners inside out (Kochanek and Bartels 1984), which nobody
        # would call fluid: above 0, hands pass their keys faster and trail more instead.
        flow, corner = max(style.fluidity, 0.0), min(style.fluidity, 0.0)
        tension = style.tension - FLOW_TENSION * flow
        self._tcb = replace(style, fluidity=corner, tension=min(tension, PATH_TENSION))
        self._key_speed = (1.0 - max(tension, PATH_TENSION)) / (1.0 - PATH_TENSION)
        self._on_path = {key.number for key in keys if key.way == "path"}
        self._held_speed = HELD_SPEED + (1.0 - HELD_SPEED) * flow
        self._lags = joints.lags * (1.0 + style.fluidity)
        self._segments: dict[int, _Segment] = {}

    @property
    def duration(self) -> float:
        """Time from its start to its end [s]."""
        return self.times.end - self.times.start

    def sample(self, time: float) -> Pose:
        """Return the posture at a time from its start [s]."""
        return self.over(self._posture, self.times.start + time, 1.0)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return no movement over the ground."""
        return RootDelta()

    def over(self, pose: Pose, now: float, weight: float, way: WayRound | None = None) -> Pose:
        """Return a pose with the gesture at a time [s] of its own laid over it by a weight, 0…1.

        Part of the way, it goes on by `way` from the frame before.
        """
        if weight <= 0.0:
            return pose
        now, beyond, swung = self._ease(min(max(now, self.times.start), self.times.end))
        place = min(max(bisect_right(self._rows, now) - 1, 0), len(self._rows) - 2)
        segment = self._segment(place)
        turns = segment.at((now - self._rows[place]) / segment.length)
        if beyond > 0.0:
            turns += beyond * self._way(*swung)
        if place == 0 or now > self.times.relax:
            self._join(turns, pose, now)
        if self._count < len(turns):
            trunk = pose.rotations[self._joints.trunk]
            turns[self._count :] = rotations.multiply(trunk, turns[self._count :])
        return lay_over(pose, self.moved, turns, weight, way)

    def _join(self, turns: Array, pose: Pose, now: float) -> None:
        """Let arms go on with what they do below, at first, and take it up again at the end.

        Faded early, what they do below leaves a long way for the rest of the preparation, as where
        they come from another gesture; faded late, they fall towards rest on their way.
        """
        times, arms = self.times, turns[: self._count]
        below = rotations.align(pose.rotations[self._joints.arms], arms)
        if now < times.ready:
            share = 1.0 - min((now - times.start) / (JOIN_SHARE * self._segment(0).length), 1.0)
            planned = self._start[: self._count]
        else:
            share = min(
                (now - times.relax) / ((1.0 - SWING_SHARE) * (times.end - times.relax)), 1.0
            )
            planned = self._joints.rest[: self._count]
        if share > 0.0:
            arms += smoothstep(share) * (below - rotations.align(planned, below))

    def _ease(self, now: float) -> tuple[float, float, tuple[float, float]]:
        """Return the time that is shown, how far it is beyond a key, and where its way began."""
        span = bisect_right(self._spans, (now, math.inf)) - 1
        if not self._eased or span < 0 or now >= self._spans[span][1]:
            return now, 0.0, (0.0, 0.0)
        start, end = self._spans[span]
        way = ease_time((now - start) / (end - start), self._style if span else self._rising)
        return start + (end - start) * min(way, 1.0), max(way - 1.0, 0.0), (start, end)

    def _way(self, start: float, end: float) -> Array:
        """Return by how much joints turn from one key to the next, (a + t, 4)."""
        first, last = (bisect_right(self._rows, each + 1e-9) - 1 for each in (start, end))
        there = self._point(last)
        way: Array = there - rotations.align(self._point(first), there)
        if self._numbers[last] >= 0:
            way[self._stops[self._numbers[last]]] = 0.0  # no hand goes through what it touches
        return way

    def _point(self, row: int) -> Array:
        number = self._numbers[row]
        if number >= 0:
            return self._turns_of(number)
        return self._start if number == BEGINNING else self._joints.rest

    def _segment(self, place: int) -> "_Segment":
        if place not in self._segments:
            self._segments[place] = self._make_segment(place)
        return self._segments[place]

    def _make_segment(self, place: int) -> "_Segment":
        low, high = max(place - 1, 0), min(place + 3, len(self._rows))
        own = place - low
        points = np.array([self._point(row) for row in range(low, high)])
        points = rotations.align(points, points[own])
        spline = TcbSpline.of(np.array(self._rows[low:high]), points, self._tcb)
        length = self._rows[place + 1] - self._rows[place]
        wide = np.vecdot(points[1:], rotations.align(points[:-1], points[1:])) < WIDE_COSINE
        slopes = []
        for key, tangents in ((own, spline.outgoing), (own + 1, spline.incoming)):
            slope, number = length * tangents[key], self._numbers[low + key]
            if number in self._numbers[max(low + key - 1, 0) : low + key + 2 : 2]:
                slope *= self._held_speed
            if number not in self._on_path:
                slope *= self._key_speed
            slope[wide[max(key - 1, 0) : key + 1].any(axis=0)] = 0.0
            if number >= 0:
                slope[self._stops[number]] = 0.0
            slopes.append(slope)
        lags = 16.0 * np.minimum(self._lags / length, MOST_LAG)[:, None]
        return _Segment(
            length,
            points[own],
            points[own + 1],
            slopes[0],
            slopes[1],
            lags,
            np.flatnonzero(wide[own]),
        )


class _Segment:
    """The cubic of each joint from one key to the next."""

    def __init__(
        self,
        length: float,
        a: Array,
        b: Array,
        slope_a: Array,
        slope_b: Array,
        lags: Array,
        wide: NDArray[np.intp],
    ) -> None:
        self.length = length
        self._wide, self._end = wide, b
        way = b - a
        self._start, self._slope = a, slope_a
        self._bend = 3.0 * way - 2.0 * slope_a - slope_b
        self._twist = slope_a + slope_b - 2.0 * way
        self._lags = lags
        self._still = not (way.any() or slope_a.any() or slope_b.any())

    def at(self, u: float) -> Array:
        """Return the rotations at a part of the time, 0…1, (a + t, 4), not normalised.

        What trails is on time at both ends, where it also has the speed of the rest.
        """
        if self._still:
            return self._start.copy()
        trailed = u - self._lags * (u * (1.0 - u)) ** 2
        turns: Array = self._twist * trailed
        turns += self._bend
        turns *= trailed
        turns += self._slope
        turns *= trailed
        turns += self._start
        if len(self._wide):
            share = smoothstep(trailed[self._wide, 0])
            turns[self._wide] = rotations.slerp(
                self._start[self._wide], self._end[self._wide], share
            )
        return turns


def _rows(keys: Sequence[StrokeKey], times: PhaseTimes) -> tuple[list[float], list[int]]:
    """Return the times of all keys of a gesture [s], and their numbers."""
    first, last = keys[0].number, keys[-1].number
    rows = [(times.start, BEGINNING)]
    rows += _held(first, times.ready, times.in_stroke(keys[0].share))
    rows += [(times.in_stroke(key.share), key.number) for key in keys]
    rows += _held(last, times.in_stroke(keys[-1].share), times.relax)
    rows.append((times.end - SWING_SHARE * (times.end - times.relax), REST))
    rows.append((times.end, REST))
    kept: list[tuple[float, int]] = []
    for row in rows:
        if not kept or row[0] > kept[-1][0] + 1e-3:
            kept.append(row)
    if len(kept) == 1:  # no phase has a length
        kept.append((times.start + 1.0, REST))
    return [row[0] for row in kept], [row[1] for row in kept]


def _held(number: int, start: float, end: float) -> list[tuple[float, int]]:
    """Return the keys of a hold: it settles, is still, and sets off."""
    length = end - start
    if length < MIN_HOLD_S:
        return []
    inner = (start + SETTLE_S, end - LIFT_S) if length > SETTLE_S + LIFT_S else ()
    return [(time, number) for time in (start, *inner, end)]


def _eased_spans(keys: Sequence[StrokeKey], times: PhaseTimes) -> list[tuple[float, float]]:
    """Return when hands are on their ways to keys which power accelerates [s]: first from rest."""
    spans, start = [(times.start, times.ready)], times.ready
    for key in keys:
        time = times.in_stroke(key.share)
        if key.way == "line" and time > start + 1e-3:
            spans.append((start, time))
        start = start if key.way == "path" else time
    return spans
