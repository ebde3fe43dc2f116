"""Finding the phases of gestures in a recording, without marks.

Phases after Kendon and Kita as the thesis uses them (Fernández-Baena 2015, section 4.2, M4). Both
hands are taken together, so that what they do at once is one gesture. A gesture unit is what hands
do between two rests; the edges of a clip count as rests if it is cut tightly round a unit. Moves
are what lies between minima of speed. The last pause from which the hands only go home ends the
last stroke; in a chain of moves without a hold before it, the last one is a stroke, and from there
backward strokes and preparations take turns.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion.contacts import spans
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.gestures.analysis import APEX_SPEED, find_stop, hand_speed

REST, RETRACTION, HOLD, PREPARATION, STROKE = range(5)
"""Labels of frames: what the hands do in them."""

Labels = NDArray[np.int8]
"""A label for each frame, (frames,)."""

SLOW, MOST_SLOW = 0.15, 0.25
"""A hand is held below this share of its greatest speed, and below so many arm lengths/s."""

MOVING = 1.4
"""A hand moves at so many times the speed below which it is held."""

MIN_PEAK = 0.2
"""A unit in which no hand gets faster is none [arm lengths/s]."""

NEAR, MOST_NEAR, LEAST_NEAR = 0.3, 0.25, 0.04
"""A hand rests within this share of its farthest way from its place of rest, and its limits
[arm lengths]."""

REST_SHARE = 0.3
"""A hand rests where it is slow at least this share as often as where it is most often."""

CUTOFF_HZ = 10.0
"""Where the speed is low-passed to find moves; recoils are short [Hz]."""

MIN_REST_S = 0.2
"""Shortest rest [s]."""

MIN_MOVE = 0.06
"""Shorter moves are none [arm lengths]."""

SPLIT_SPEED_SHARE = 0.6
"""A minimum below this share of the peaks beside it parts two moves."""

MIN_HOLD_S = 0.2
"""Shortest hold that parts a stroke from the next preparation [s]."""

RECOIL = 0.35
"""A move right after a longer one is its recoil, a part of the hold, if shorter than this share
of it."""

STILL = 0.35
"""A pause is as long as the speed is below this share of the greatest of its unit."""

AWAY = 0.3
"""A retraction begins at least at this share of the farthest way of its unit."""

HOMEWARD = 0.15
"""A retraction may lead away again by this share of the farthest way of its unit."""

LAST_PAUSE = 0.5
"""The last pause before a retraction is this share as long as the longest one, or longer."""

ONSET = 0.9
"""A way out of rest in one go becomes the stroke where, past its peak, its speed falls to this
share."""

SETTLE_S = 0.16
"""A hand settles so long after its stroke; the stroke lasts until then [s]."""


@dataclass(frozen=True)
class Segmentation:
    """The phases of the gestures in a clip."""

    labels: Labels
    """The label of each frame, (frames,)."""

    reason: str
    """Why there is no gesture; "" if there are some."""


@dataclass(frozen=True)
class _Move:
    """The hands go from one place to another."""

    first: int
    last: int
    length: float
    """Distance between both places [arm lengths]."""


def segment(paths: Mapping[str, Array], rate: float) -> Segmentation:
    """Find the phases of gestures from the way of each hand, (frames, 3) [arm lengths], by side."""
    frames = len(next(iter(paths.values())))
    away = np.zeros(frames, np.bool_)
    squares, distance = np.zeros(frames), np.zeros(frames)
    reasons: list[str] = []
    for path in paths.values():
        found = _Excursions.of(path, rate)
        reasons.append(found.reason)
        for first, last in found.spans:
            part = slice(first, last + 1)
            away[part] = True
            squares[part] += hand_speed(path, rate, CUTOFF_HZ)[part] ** 2
            far = np.linalg.norm(path[part] - found.place, axis=1)
            distance[part] = np.maximum(distance[part], far)
    labels = np.full(frames, REST, np.int8)
    speed = np.sqrt(squares)
    places = np.concatenate([*paths.values()], axis=1)
    for first, last in runs(away):
        if speed[first : last + 1].max() >= MIN_PEAK:
            _label_unit(labels, _Unit(places, speed, distance, first, last, rate))
        else:
            reasons.append(f"no hand moves at {MIN_PEAK} arm lengths a second")
    if (labels == STROKE).any():
        return Segmentation(labels, "")
    why = next(filter(None, reversed(reasons)), "hands leave their place of rest in one move only")
    return Segmentation(labels, why)


@dataclass(frozen=True)
class _Excursions:
    """Where a hand is away from its place of rest."""

    place: Array
    """Where it rests, (3,) [arm lengths]."""

    spans: Sequence[tuple[int, int]]
    """First and last frame of each time that it is away."""

    reason: str
    """Why there are none."""

    @classmethod
    def of(cls, path: Array, rate: float) -> "_Excursions":
        """Find where a hand rests, and when it does not; `path` in arm lengths."""
        pad = round(MIN_REST_S * rate)
        # A clip that is cut tightly holds no rest: what is beyond its edges stands for one.
        longer = np.concatenate([path[[0] * pad], path, path[[-1] * pad]])
        speed = hand_speed(longer, rate, CUTOFF_HZ)
        slow = speed < min(SLOW * float(speed.max()), MOST_SLOW)
        place = rest_place(longer, slow, MOST_NEAR)
        far = np.linalg.norm(longer - place, axis=1)
        near = far < min(max(NEAR * float(far.max()), LEAST_NEAR), MOST_NEAR)
        if far.max() < MIN_MOVE:
            return cls(place, [], "no hand leaves its place of rest")
        rests = runs(slow & near, pad)
        if len(rests) < 2:
            return cls(place, [], "no hand comes back to where it rested")
        found = []
        for (_, begin), (end, _) in pairwise(rests):
            tight = begin < 2 * pad or end > len(longer) - 2 * pad
            if tight and len(runs(near[begin : end + 1])) > 2:
                continue
            if far[begin : end + 1].max() >= MIN_MOVE:
                found.append((max(begin - pad, 0), min(end - pad, len(path) - 1)))
        reason = "" if found else "hands pass their place of rest without resting there"
        return cls(place, found, reason)


def rest_place(path: Array, slow: NDArray[np.bool_], radius: float) -> Array:
    """Return where a hand rests, (3,).

    That is where the clip begins and ends, if that is one place: it is cut so. Else it is the
    lowest of the places where the hand is slow often: hands are held up in gestures, too.
    """
    if np.linalg.norm(path[-1] - path[0]) < radius:
        ends: Array = (path[0] + path[-1]) / 2
        return ends
    places = path[slow]
    sample = places[:: max(len(places) // 400, 1)]
    near = np.linalg.norm(sample[:, None] - sample[None], axis=-1) < radius
    counts = near.sum(1)
    often = np.flatnonzero(counts >= REST_SHARE * counts.max())
    mean: Array = sample[near[often[sample[often, 1].argmin()]]].mean(0)
    return mean


def phrase_bounds(labels: Labels) -> list[tuple[int, int, int, int, int, int]]:
    """Return the frames at which the phases of each phrase begin, and its last frame.

    A phrase ends where the next one begins, or in rest.
    """
    strokes = runs(labels == STROKE)
    found: list[tuple[int, int, int, int, int, int]] = []
    for number, (stroke, stroke_last) in enumerate(strokes):
        begin = stroke
        while begin > 0 and labels[begin - 1] == HOLD and not (found and begin <= found[-1][3]):
            begin -= 1
        pre_hold = begin
        while begin > 0 and labels[begin - 1] == PREPARATION:
            begin -= 1
        if begin == pre_hold:  # a hold without a preparation belongs to the stroke before
            begin = pre_hold = stroke
        if found and found[-1][5] > begin:
            found[-1] = (*found[-1][:4], min(found[-1][4], begin), begin)
        limit = strokes[number + 1][0] if number + 1 < len(strokes) else len(labels) - 1
        end = _until(labels, stroke_last + 1, limit, (HOLD,))
        last = _until(labels, end, limit, (HOLD, RETRACTION))
        found.append((begin, pre_hold, stroke, stroke_last, end, last))
    return found


def _until(labels: Labels, frame: int, limit: int, wanted: tuple[int, ...]) -> int:
    """Return the first frame from `frame` on whose label is none of these, or the limit."""
    while frame < limit and labels[frame] in wanted:
        frame += 1
    return min(frame, limit)


@dataclass(frozen=True)
class _Unit:
    """What hands do between two rests."""

    places: Array
    """Where both hands are, (frames, 3 a hand) [arm lengths]."""

    speed: Array
    """Speed of both hands together, (frames,) [arm lengths/s]."""

    distance: Array
    """How far the farther hand is from its place of rest, (frames,) [arm lengths]."""

    begin: int
    end: int
    rate: float

    @property
    def slow(self) -> float:
        """Speed below which hands are held."""
        peak = float(self.speed[self.begin : self.end + 1].max())
        return min(SLOW * peak, MOST_SLOW)

    def moves(self) -> list[_Move]:
        """Return the moves, in order."""
        speed = self.speed
        inner = np.arange(self.begin + 1, self.end)
        lowest = inner[(speed[inner] <= speed[inner - 1]) & (speed[inner] < speed[inner + 1])]
        parts: list[tuple[int, int]] = []
        for first, last in pairwise([self.begin, *lowest.tolist(), self.end]):
            peak = float(speed[first : last + 1].max())
            if peak < MOVING * self.slow:
                continue
            if parts and parts[-1][1] == first:
                before = float(speed[parts[-1][0] : first + 1].max())
                if speed[first] > SPLIT_SPEED_SHARE * min(peak, before):
                    parts[-1] = (parts[-1][0], last)
                    continue
            parts.append((first, last))
        moves = [self._trim(*part) for part in parts]
        return [move for move in moves if move.length >= MIN_MOVE]

    def retraction(self, moves: Sequence[_Move]) -> int:
        """Return the number of the first move of the retraction: after a pause, only homeward."""
        if len(moves) < 2:
            return len(moves)
        farthest = float(self.distance[self.begin : self.end + 1].max())
        pauses: dict[int, float] = {}
        for number, (before, after) in enumerate(pairwise(moves), 1):
            start = float(self.distance[after.first])
            most = float(self.distance[after.first : self.end + 1].max())
            if start >= AWAY * farthest and most <= start + HOMEWARD * farthest:
                pauses[number] = self._stillness(before, after)
        longest = max(pauses.values(), default=0.0)
        long = (n for n, pause in pauses.items() if pause >= LAST_PAUSE * longest)
        return max(long, default=len(moves) - 1)

    def split(self, move: _Move) -> int:
        """Return where a way out of rest in one go becomes the stroke."""
        part = self.speed[move.first : move.last + 1]
        inner = np.arange(1, len(part) - 1)
        top = int(part.argmax())
        dips = inner[(part[inner] <= part[inner - 1]) & (part[inner] < part[inner + 1])]
        if len(dips):
            return move.first + int(dips[-1])
        late = np.flatnonzero(part[top:] < ONSET * part[top])
        return move.first + top + (int(late[0]) if len(late) else 0)

    def _stillness(self, before: _Move, after: _Move) -> float:
        """Return how long and how deep the pause between two moves is [s]."""
        ways = [self.speed[m.first : m.last + 1] for m in (before, after)]
        first, last = before.first + int(ways[0].argmax()), after.first + int(ways[1].argmax())
        level = STILL * float(self.speed[self.begin : self.end + 1].max())
        depth = np.maximum(1.0 - self.speed[first : last + 1] / level, 0.0)
        return float(depth.sum()) / self.rate

    def _trim(self, first: int, last: int) -> _Move:
        """Return a move without the slow frames at its ends."""
        part = self.speed[first : last + 1]
        fast = np.flatnonzero(part > min(self.slow, APEX_SPEED * float(part.max())))
        begin, end = first + max(int(fast[0]) - 1, 0), min(first + int(fast[-1]) + 1, last)
        way = (self.places[end] - self.places[begin]).reshape(-1, 3)
        return _Move(begin, end, float(np.linalg.norm(way, axis=1).max()))


def _label_unit(labels: Labels, unit: _Unit) -> None:
    """Label the frames of a unit from its moves."""
    moves = unit.moves()
    if len(moves) < 2:
        return
    back = unit.retraction(moves)
    labels[moves[0].first : moves[-1].last + 1] = HOLD
    labels[moves[back].first : moves[-1].last + 1] = RETRACTION
    chains: list[list[_Move]] = [[]]
    for move in moves[:back]:
        chain = chains[-1]
        right_after = chain and (move.first - chain[-1].last) / unit.rate < MIN_HOLD_S
        recoils = right_after and move.length < RECOIL * chain[-1].length
        if recoils and chain[-1] is not moves[0]:  # hands come from rest by a long way
            continue
        if chain and not right_after:
            chains.append([])
        chains[-1].append(move)
    settle = round(SETTLE_S * unit.rate)
    for chain in chains:
        for back_number, move in enumerate(reversed(chain)):
            is_stroke = back_number % 2 == 0
            first = unit.split(move) if is_stroke and move is moves[0] else move.first
            labels[move.first : move.last + 1] = PREPARATION
            if is_stroke:
                top = move.first + int(np.argmax(unit.speed[move.first : move.last + 1]))
                stop = find_stop(unit.speed, max(top, first), move.last)
                labels[stop : move.last + 1] = HOLD
                after = slice(stop, stop + settle + 1)
                labels[first:stop] = STROKE
                labels[after][labels[after] == HOLD] = STROKE


def runs(mask: NDArray[np.bool_], shortest: int = 1) -> list[tuple[int, int]]:
    """Return first and last frame of each run of at least so many frames."""
    found = spans(mask, loop=False) if mask.any() else []
    return [(first, first + count - 1) for first, count in found if count >= shortest]


def arm_length(rest: Array) -> float:
    """Return the length of a chain of joints at rest, (joints, 3) [m]."""
    return math.fsum(np.linalg.norm(np.diff(rest, axis=0), axis=1).tolist())
