"""Units of gestures from rest to rest as curves: beats with their phases, and what follows them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.characters.synthesis.gestures.library import Hand
from tools.authoring.gestures.beats import BEATS, Beat
from tools.authoring.modelling.curves import keys, spring_follow
from tools.authoring.modelling.shapes import Array

RATE_HZ = 60.0

STRENGTHS = {"weak": (0.6, 0.31), "neutral": (1.1, 0.24), "strong": (1.65, 0.2)}
"""Size of a stroke, and its duration [s]."""

EFFORTS = {"weak": 0.25, "neutral": 0.6, "strong": 1.2}
"""How much trunk, head and shoulders take part."""

REST_S = 0.1
"""Rest before the first and after the last phrase [s]."""

SETTLE_S = 0.15
"""How long hands that come down swing until they hang still [s]."""

HANDS_APART_M = 0.125
"""Least distance of a hand from the middle while both make a stroke [m]."""

SIDES: dict[Hand, tuple[str, ...]] = {
    "left": ("Left",),
    "right": ("Right",),
    "both": ("Left", "Right"),
}
"""Sides of the hands that make a stroke, the leading one first."""

_DIRECTIONS, _BENDS = slice(3, 9), slice(12, 16)  # of fingers and thumb, in a row of a hand


@dataclass(frozen=True)
class UnitBeat:
    """A beat in a unit."""

    shape: str
    """Name in `BEATS`."""

    strength: str
    """Name in `STRENGTHS`."""

    hand: Hand
    """Which hands make it."""


@dataclass(frozen=True)
class BeatSpan:
    """When the phases of a beat begin, in frames."""

    hand: Hand
    """Which hands make the stroke."""

    bounds: tuple[int, int, int, int, int, int]
    """Of the five phases, and the last frame."""

    apex: int
    """Of the greatest extension."""


@dataclass(frozen=True)
class UnitCurves:
    """The curves of a unit, (frames, …)."""

    share: dict[str, Array]
    """How much each hand is raised, (frames,), by "Left" and "Right"."""

    hands: dict[str, Array]
    """Rows of `HandShape.values`, (frames, 16), by side."""

    shrug: dict[str, Array]
    """Raise of each shoulder, (frames,), by side [degrees]."""

    hanging: Array
    """Swing and bend of the arms in rest, left and right, (2, 2) [degrees]."""

    lean: Array
    """Forward [degrees]."""

    twist: Array
    """To the left [degrees]."""

    nod: Array
    """Of the head, down [degrees]."""

    spans: tuple[BeatSpan, ...]
    """The beats, in order."""


class Track:
    """Keys of curves, by name."""

    def __init__(self) -> None:
        self._keys: dict[str, list[tuple[float, Array]]] = {}

    def add(self, name: str, frame: float, value: Array | float) -> None:
        """Add a key; earlier ones that would be after it are dropped."""
        kept = [each for each in self._keys.get(name, []) if each[0] < frame - 0.05]
        self._keys[name] = [*kept, (frame, np.atleast_1d(np.asarray(value, float)))]

    def curve(self, name: str, frames: int) -> Array:
        """Return the curve through its keys, (frames, values)."""
        found = self._keys[name]
        columns = [
            keys(frames, *((at / frames, float(value[n])) for at, value in found))
            for n in range(len(found[0][1]))
        ]
        return np.stack(columns, axis=1)


class UnitTimeline:
    """Sets the keys of one unit, beat after beat."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._track = Track()
        self._frame = round(REST_S * RATE_HZ)
        self._held: dict[str, Array] = {}  # the last row of each raised hand
        self._spans: list[BeatSpan] = []
        for name in ("lean", "twist", "nod", "shrug Left", "shrug Right"):
            self._track.add(name, 0.0, 0.0)

    def beat(self, unit_beat: UnitBeat) -> None:
        """Add a beat after what is there."""
        size, stroke_s = STRENGTHS[unit_beat.strength]
        beat = BEATS[unit_beat.shape].scaled(size * self._about(1.0, 0.08))
        sides = SIDES[unit_beat.hand]
        raised = all(side in self._held for side in sides)
        turns = 2.4 if beat.round_trip else 1.0
        lengths = (
            self._about(0.30 if raised else 0.46, 0.1),
            self._rng.choice([0.0, 0.0, 0.06, 0.12]),
            turns * self._about(stroke_s, 0.06),
            self._about(0.36, 0.3),
        )
        start = self._frame
        prepared, stroke, stroke_end, end = (
            (start + np.maximum(np.rint(np.cumsum(lengths) * RATE_HZ), [6, 6, 14, 22]))
            .astype(int)
            .tolist()
        )
        later = self._rng.choice(sides)  # hands are never quite together
        for side in sides:
            delay = float(self._rng.uniform(0.5, 2.5)) if side == later and len(sides) > 1 else 0.0
            if side not in self._held:
                self._track.add(f"share {side}", start + 2 * delay, 0.0)
                self._track.add(f"share {side}", prepared + delay, 1.0)
            times = [each + delay for each in (start, prepared, stroke, stroke_end, end)]
            self._move(side, beat, times, HANDS_APART_M if len(sides) > 1 else -1.0)
        self._involve(unit_beat, start, stroke, stroke_end, end)
        apex = (stroke + stroke_end) // 2 if beat.round_trip else stroke_end
        self._spans.append(
            BeatSpan(unit_beat.hand, (start, prepared, stroke, stroke_end, end, end), apex)
        )
        self._frame = end

    def finish(self) -> UnitCurves:
        """Bring the hands down, and return the curves."""
        down = round(self._about(0.62, 0.1) * RATE_HZ)
        start, hanging = self._frame, self._frame + down
        end = hanging + round(SETTLE_S * RATE_HZ)
        for side in ("Left", "Right"):
            if side in self._held:
                late = float(self._rng.uniform(0.0, 3.0))
                self._track.add(f"share {side}", start + late, 1.0)
                self._track.add(f"share {side}", hanging - 6 + late, -0.02)
            else:
                self._track.add(f"hand {side}", 0.0, BEATS["chop"].top.values())
                self._track.add(f"share {side}", 0.0, 0.0)
            self._track.add(f"share {side}", end, 0.0)
        for name in ("lean", "twist", "nod", "shrug Left", "shrug Right"):
            self._track.add(name, end - 4, 0.0)
        last = self._spans[-1]
        self._spans[-1] = BeatSpan(last.hand, (*last.bounds[:5], end), last.apex)
        return self._curves(end + round(REST_S * RATE_HZ) + 1)

    def _curves(self, frames: int) -> UnitCurves:
        def of(name: str) -> Array:
            return self._track.curve(name, frames)[:, 0]

        sides = ("Left", "Right")
        return UnitCurves(
            {side: of(f"share {side}") for side in sides},
            {side: _followed(self._track.curve(f"hand {side}", frames)) for side in sides},
            {side: of(f"shrug {side}") for side in sides},
            np.array([3.0, 19.0]) + self._rng.normal(0.0, [1.2, 2.5], (2, 2)),
            of("lean"),
            of("twist"),
            of("nod"),
            tuple(self._spans),
        )

    def _move(self, side: str, beat: Beat, times: Sequence[float], least_m: float) -> None:
        """Set the keys of a hand: up to the top, hold, stroke, recoil, and hold with a drift."""
        start, prepared, stroke, stroke_end, end = times
        name, track = f"hand {side}", self._track
        top, apex = (self._varied(shape.values(), least_m) for shape in (beat.top, beat.apex))
        if side in self._held:
            track.add(name, start, self._held[side])
        else:
            track.add(name, 0.0, top)
        track.add(name, prepared, top)
        if stroke > prepared:
            track.add(name, stroke, top + _lift(0.006))
        length = stroke_end - stroke
        if beat.round_trip:
            out, back = _lift(0.0, 0.055), _lift(0.0, -0.045)
            track.add(name, stroke + 0.25 * length, top + 0.5 * (apex - top) + out)
            track.add(name, stroke + 0.5 * length, apex)
            track.add(name, stroke + 0.75 * length, top + 0.5 * (apex - top) + back)
            after = apex + 0.9 * (top - apex)
        else:
            track.add(name, stroke + 0.55 * length, top + 0.3 * (apex - top))
            after = apex
        track.add(name, stroke_end, after)
        recoil = after + float(self._rng.uniform(0.08, 0.2)) * (top - apex)
        track.add(name, min(stroke_end + 7.0, end - 4.0), recoil)
        self._held[side] = recoil + _lift(-0.012, 0.004)
        track.add(name, end, self._held[side])

    def _involve(self, beat: UnitBeat, start: int, stroke: int, stroke_end: int, end: int) -> None:
        """Let trunk, shoulders and head take part: against the stroke first, then with it."""
        effort = EFFORTS[beat.strength] * self._about(1.0, 0.2)
        turn = {"left": -1.0, "right": 1.0, "both": 0.25}[beat.hand]
        for name, against, along, after in (
            ("lean", -2.0, 6.0, 2.5),
            ("twist", -2.5 * turn, 4.5 * turn, 2.0 * turn),
            ("nod", -4.0, 10.0, 1.5),
        ):
            self._track.add(name, stroke, against * effort)
            self._track.add(name, stroke_end + 1, along * effort)
            self._track.add(name, min(stroke_end + 11, end - 1), after * effort)
        for side in SIDES[beat.hand]:
            name = f"shrug {side}"
            self._track.add(name, stroke - 1, 2.0 + 6.0 * effort)
            self._track.add(name, stroke_end, 1.5 - 1.5 * effort)
            self._track.add(name, min(stroke_end + 9, end - 1), 2.0)

    def _varied(self, row: Array, least_m: float) -> Array:
        """Return the row of a hand with small changes, so far from the middle [m] or farther."""
        varied: Array = row.copy()
        varied[:3] += self._rng.normal(0.0, [0.012, 0.012, 0.008])
        varied[0] = max(varied[0], least_m)
        varied[_DIRECTIONS] += self._rng.normal(0.0, 0.06, 6)
        varied[_BENDS] *= self._rng.uniform(0.85, 1.15, 4)
        return varied

    def _about(self, value: float, share: float) -> float:
        return value * float(self._rng.uniform(1.0 - share, 1.0 + share))


def unit_curves(beats: Sequence[UnitBeat], seed: int) -> UnitCurves:
    """Return the curves of a unit of beats."""
    timeline = UnitTimeline(np.random.default_rng(seed))
    for beat in beats:
        timeline.beat(beat)
    return timeline.finish()


def _lift(up: float, out: float = 0.0) -> Array:
    """Return what is to be added to a row to move the wrist up and outward [m]."""
    row = np.zeros(16)
    row[:2] = out, up
    return row


def _followed(rows: Array) -> Array:
    """Return the rows of a hand (frames, 16) whose wrist drags hand and fingers behind it."""
    followed = rows.copy()
    seconds = len(rows) / RATE_HZ
    velocity = np.gradient(rows[:, :3], axis=0) * RATE_HZ
    followed[:, 3:6] -= 0.2 * velocity
    followed[:, _DIRECTIONS] = spring_follow(followed[:, _DIRECTIONS], seconds, 5.0, 0.55)
    followed[:, _BENDS] = spring_follow(rows[:, _BENDS], seconds, 3.5, 0.5)
    return followed
