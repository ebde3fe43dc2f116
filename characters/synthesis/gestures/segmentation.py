"""Finding the phases of gestures in a recording, without marks.

Phases after Kendon and Kita as the thesis uses them (Fernández-Baena 2015, section 4.2, M4). Moves
of a hand are what lies between minima of its speed; in a chain of moves without a hold, the last
one is a stroke, and from there backward strokes and preparations take turns.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion.contacts import spans
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.gestures.analysis import hand_speed

REST, RETRACTION, HOLD, PREPARATION, STROKE = range(5)
"""Labels of frames; of two hands the higher one counts (M4)."""

Labels = NDArray[np.int8]
"""A label for each frame, (frames,)."""

SLOW, MOVING = 0.25, 0.35
"""Below the first speed a hand is held, above the second it moves [arm lengths/s]."""

REST_RADIUS = 0.25
"""How far from its place of rest a resting hand may be [arm lengths]."""

OFTEN = 0.3
"""A hand rests where it is slow at least this share as often as where it is most often."""

CUTOFF_HZ = 10.0
"""Where the speed is low-passed to find moves; recoils are short [Hz]."""

MIN_REST_S = 0.2
"""Shortest rest [s]."""

MIN_MOVE = 0.06
"""Shorter moves are none [arm lengths]."""

SPLIT = 0.6
"""A minimum below this share of the peaks beside it parts two moves."""

MIN_HOLD_S = 0.2
"""Shortest hold that parts a stroke from the next preparation [s]."""

RECOIL = 0.35
"""A move right after a longer one is its recoil, a part of the hold, if shorter than this share
of it."""

MINOR_STROKE = 0.4
"""A stroke whose peak speed is below this share of the other hand's is not meant (M4)."""


@dataclass(frozen=True)
class HandMove:
    """A hand goes from one place to another."""

    first: int
    """Frame at which it begins."""

    last: int
    """Frame at which it ends."""

    length: float
    """Distance between both places [arm lengths]."""


def rest_place(path: Array, slow: NDArray[np.bool_], radius: float) -> Array | None:
    """Return where a hand rests, (3,), or None if it is never slow.

    It is the lowest of the places where it is slow often: hands are held up in gestures, too.
    """
    places = path[slow]
    if not len(places):
        return None
    sample = places[:: max(len(places) // 400, 1)]
    near = np.linalg.norm(sample[:, None] - sample[None], axis=-1) < radius
    counts = near.sum(1)
    often = np.flatnonzero(counts >= OFTEN * counts.max())
    mean: Array = sample[near[often[sample[often, 1].argmin()]]].mean(0)
    return mean


def hand_labels(path: Array, rate: float, arm_length: float) -> Labels:
    """Return the label of each frame of a hand, from its path (frames, 3) [m].

    All are `REST` if it never rests: then nothing tells a gesture from what else it does.
    """
    labels = np.full(len(path), REST, np.int8)
    scaled = path / arm_length
    speed = hand_speed(scaled, rate, CUTOFF_HZ)
    place = rest_place(scaled, speed < SLOW, REST_RADIUS)
    if place is None:
        return labels
    near = np.linalg.norm(scaled - place, axis=1) < REST_RADIUS
    rests = runs((speed < SLOW) & near, round(MIN_REST_S * rate))
    for (_, begin), (end, _) in pairwise(rests):
        moves = _moves(scaled, speed, begin, end)
        if moves:
            _label_unit(labels, moves, rate)
    return labels


def both_labels(labels: dict[str, Labels], speeds: dict[str, Array]) -> Labels:
    """Return the labels of both hands together: stroke before preparation before hold.

    A minor stroke while the other hand makes a significant one counts as a hold. Strokes that
    overlap become one.
    """
    merged = {side: each.copy() for side, each in labels.items()}
    for side, own in labels.items():
        for first, last in runs(own == STROKE):
            part = slice(first, last + 1)
            others = [
                float(speeds[other][part].max())
                for other, theirs in labels.items()
                if other != side and (theirs[part] == STROKE).any()
            ]
            if others and float(speeds[side][part].max()) < MINOR_STROKE * max(others):
                merged[side][part] = HOLD
    together: Labels = np.max([*merged.values()], axis=0)
    return together


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


def _moves(path: Array, speed: Array, begin: int, end: int) -> list[HandMove]:
    """Return the moves between two rests."""
    inner = np.arange(begin + 1, end)
    lowest = inner[(speed[inner] <= speed[inner - 1]) & (speed[inner] < speed[inner + 1])]
    cuts = [begin, *lowest.tolist(), end]
    parts: list[tuple[int, int]] = []
    for first, last in pairwise(cuts):
        peak = float(speed[first : last + 1].max())
        if peak < MOVING:
            continue
        if parts and parts[-1][1] == first:
            before = float(speed[parts[-1][0] : first + 1].max())
            if speed[first] > SPLIT * min(peak, before):
                parts[-1] = (parts[-1][0], last)
                continue
        parts.append((first, last))
    moves = [_trim(path, speed, *part) for part in parts]
    return [move for move in moves if move.length >= MIN_MOVE]


def _trim(path: Array, speed: Array, first: int, last: int) -> HandMove:
    """Return a move without the slow frames at its ends."""
    fast = np.flatnonzero(speed[first : last + 1] > SLOW)
    begin, end = first + max(int(fast[0]) - 1, 0), min(first + int(fast[-1]) + 1, last)
    return HandMove(begin, end, float(np.linalg.norm(path[end] - path[begin])))


def _label_unit(labels: Labels, moves: Sequence[HandMove], rate: float) -> None:
    """Label the frames of a unit from its moves: the last one leads back to rest."""
    labels[moves[0].first : moves[-1].last + 1] = HOLD
    *others, back = moves
    if not others:
        return
    labels[back.first : back.last + 1] = RETRACTION
    chains: list[list[HandMove]] = [[]]
    for move in others:
        chain = chains[-1]
        right_after = chain and (move.first - chain[-1].last) / rate < MIN_HOLD_S
        recoils = right_after and move.length < RECOIL * chain[-1].length
        if recoils and chain[-1] is not moves[0]:  # hands come from rest by a long way
            continue
        if chain and not right_after:
            chains.append([])
        chains[-1].append(move)
    for chain in chains:
        for back_number, move in enumerate(reversed(chain)):
            labels[move.first : move.last + 1] = STROKE if back_number % 2 == 0 else PREPARATION


def runs(mask: NDArray[np.bool_], shortest: int = 1) -> list[tuple[int, int]]:
    """Return first and last frame of each run of at least so many frames."""
    found = spans(mask, loop=False) if mask.any() else []
    return [(first, first + count - 1) for first, count in found if count >= shortest]


def arm_length(rest: Array) -> float:
    """Return the length of a chain of joints at rest, (joints, 3) [m]."""
    return math.fsum(np.linalg.norm(np.diff(rest, axis=0), axis=1).tolist())
