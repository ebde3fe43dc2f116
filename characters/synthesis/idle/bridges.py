"""Ways between postures over balance shifts, as short as there are.

Source: Egges, Molet and Magnenat-Thalmann 2004, section 7.1 (S8).
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from cubeling.characters.skeleton.pose import Array
from cubeling.characters.smoothing import smoothstep
from cubeling.characters.synthesis.idle.database import BalanceShift, IdleDatabase, RestingPosture
from cubeling.characters.synthesis.idle.variations import COMPONENTS

NEAR_RAD = 0.4
"""Postures nearer than this are joined without a shift [rad]; such a difference is "visible, but
minor"."""

EASED_S = 0.7
"""How long it goes between postures that are near."""


def nearest_balance(database: IdleDatabase, posture: Array) -> str:
    """Return the balance of the resting posture nearest to a posture (size,)."""
    at = database.space.project(
        np.stack([posture, *(each.vector for each in database.postures)]), COMPONENTS
    )
    return database.postures[int(database.space.distances(at[:1], at[1:]).argmin())].balance


def shortest_way(
    database: IdleDatabase, start: str, end: str, rng: np.random.Generator
) -> list[str]:
    """Return the balances after `start` on a shortest way to `end`, drawn from all of that length.

    From a balance to itself this is the shortest cycle. It is empty if there is no way.
    """
    pairs = {(shift.start, shift.end) for shift in database.shifts}
    ways = [[start]]
    for _ in range(len({name for pair in pairs for name in pair})):
        ways = [[*way, after] for way in ways for here, after in sorted(pairs) if here == way[-1]]
        there = [way for way in ways if way[-1] == end]
        if there:
            return there[int(rng.integers(len(there)))][1:]
    return []


def fitted_shift(
    database: IdleDatabase, shifts: list[BalanceShift], start: Array, end: Array
) -> Array:
    """Return the shift that is nearest to two postures, fitted to go from one to the other."""
    ends = np.stack([each.vectors[[0, -1]] for each in shifts])
    at = database.space.project(np.concatenate([ends, [[start, end]]]), COMPONENTS)
    chosen = shifts[nearest_clip(at[:-1, 0], at[:-1, 1], at[-1, 0], at[-1, 1])].vectors
    return fit(chosen, [(0, start), (len(chosen) - 1, end)])


def bridge(
    database: IdleDatabase,
    start: RestingPosture,
    end: Array,
    rng: np.random.Generator,
    limit: int | None = None,
) -> Array:
    """Return postures from `start` to exactly `end` (size,) by the shortest way, (frames, size).

    Postures of one balance that are near are joined without a shift. Between shifts it rests as
    shortly as she does, and less or not at all if it would last longer than `limit` frames.
    """
    balance = nearest_balance(database, end)
    at = database.space.project(np.stack([start.vector, end]), COMPONENTS)
    near = balance == start.balance and np.linalg.norm(at[1] - at[0]) < NEAR_RAD
    way = [] if near else shortest_way(database, start.balance, balance, rng)
    if not way:
        u = np.linspace(0.0, 1.0, round(EASED_S * database.rate) + 1)[:, None]
        eased: Array = start.vector + smoothstep(u) * (end - start.vector)
        return eased
    between = [_draw_posture(database, name, rng) for name in way[:-1]]
    parts = []
    for (a, b), (p, q) in zip(
        pairwise([start.balance, *way]), pairwise([start.vector, *between, end]), strict=True
    ):
        shifts = [shift for shift in database.shifts if (shift.start, shift.end) == (a, b)]
        parts.append(fitted_shift(database, shifts, p, q))
    rests = [round(database.pause_limits(name)[0] * database.rate) for name in way[:-1]]
    if limit is not None:
        spare = max(limit - sum(map(len, parts)), 0)
        rests = [int(rest * min(spare / max(sum(rests), 1), 1.0)) for rest in rests]
    rows = [parts[0]]
    for part, rest in zip(parts[1:], rests, strict=True):
        rows += [np.repeat(part[:1], rest, axis=0), part[1:]]
    return np.concatenate(rows)


def hurry(rows: Array, limit: int) -> Array:
    """Return rows (frames, size) after the first one, played faster if more than `limit`.

    >>> hurry(np.arange(5.0)[:, None], 2).ravel().tolist()
    [2.0, 4.0]
    """
    count = len(rows) - 1
    if count <= limit:
        return rows[1:]
    at = np.linspace(0.0, count, max(limit, 1) + 1)[1:]
    low = np.minimum(at.astype(int), count - 1)
    faster: Array = rows[low] + (at - low)[:, None] * (rows[low + 1] - rows[low])
    return faster


def _draw_posture(database: IdleDatabase, balance: str, rng: np.random.Generator) -> Array:
    own = database.by_balance.get(balance) or database.postures
    return own[int(rng.integers(len(own)))].vector


def fit(clip: Array, keys: Sequence[tuple[int, Array]]) -> Array:
    """Return a clip (frames, size) that passes through postures (size,) at frames.

    Source: Egges 2006, section 3.3.2, with errata 1 and 2 (S7).

    The offsets of the keys are interpolated along the clip; before the first and after the last
    key they fade to nothing at the ends of the clip. It is linear, so it may be done on vectors or
    on coordinates of a posture space.

    >>> clip = np.array([[0.0], [1.0], [0.0], [0.0], [0.0]])
    >>> fit(clip, [(0, np.array([1.0])), (2, np.array([2.0]))]).ravel().tolist()
    [1.0, 2.5, 2.0, 1.0, 0.0]
    """
    last = len(clip) - 1
    frames = [frame for frame, _ in keys]
    offsets = [posture - clip[frame] for frame, posture in keys]
    none = np.zeros(clip.shape[1])
    if frames[0] > 0:
        frames, offsets = [0, *frames], [none, *offsets]
    if frames[-1] < last:
        frames, offsets = [*frames, last], [*offsets, none]
    at = np.arange(len(clip))
    moved: Array = np.stack(
        [np.interp(at, frames, column) for column in np.array(offsets).T], axis=1
    )
    return clip + moved


def nearest_clip(firsts: Array, lasts: Array, start: Array, end: Array) -> int:
    """Return which clip is nearest to a start and an end: argmin of M = max(d(a_0, p), d(a_e, q)).

    `firsts` and `lasts` are the coordinates of the clips' first and last postures, (clips, count).
    """
    begins = np.linalg.norm(firsts - start, axis=1)
    ends = np.linalg.norm(lasts - end, axis=1)
    return int(np.maximum(begins, ends).argmin())
