"""The benchmark's targets, and whether the measurements reach them."""

from collections.abc import Iterator, Sequence

import numpy as np

from tests.bench.photographs.boards import BoardScore
from tests.bench.photographs.body import FOLLOWED, BodyScore
from tests.bench.photographs.empty import EmptyScore
from tests.bench.photographs.pairs import PairScore
from tests.bench.tracking.table import OURS, angle, length, number, share
from tests.bench.tracking.targets import TargetVerdict

MIN_RIGHT = {"as it is": 0.98, "half size": 0.90, "blurred": 0.50, "corner covered": 0.95}
"""Share of the photographs in each variant in which the body must be found."""

MIN_TRUSTED, MAX_SHIFT, MAX_TURN, INSIDE = 0.90, 0.8e-3, np.deg2rad(0.4), (0.85, 0.99)
"""Of markers by themselves: trusted, distance from the consensus [m, rad], coverage."""

MAX_COLD = {
    "as it is": (1.5, 6.0),
    "half size": (4.0, np.inf),
    "corner covered": (4.0, np.inf),
    "blurred": (8.0, np.inf),
}
"""Times ÷ cv2 without a past, in all calls until a picture is decided: median, 95th percentile."""

MAX_EMPTY, MAX_FOLLOWED, MAX_CALL = (1.5, 3.0), 0.4, (2.0, 5.0)
"""The same without the cube, and followed; and of a single call: median, and most."""


def verdicts(
    body: Sequence[BodyScore],
    pairs: Sequence[PairScore],
    boards: Sequence[BoardScore],
    empty: Sequence[EmptyScore],
) -> Iterator[TargetVerdict]:
    """Check every target."""
    yield from body_verdicts(body)
    yield from _pair_verdicts(next(score for score in pairs if score.tracker == OURS))
    flat = [(score.board, score.wrong) for score in boards if score.tracker == OURS]
    yield _none("pairs of a board wrong", flat)
    yield _none("seen where it is not", [(score.pictures, score.seen) for score in empty])
    for name, times, bound in zip(
        ("", ", 95 %"),
        ([score.ratio for score in empty], [score.high_ratio for score in empty]),
        MAX_EMPTY,
        strict=True,
    ):
        yield _at_most(f"nothing in view ÷ cv2{name}", number(bound, 1), max(times), bound)
    longest = max(score.longest_call for score in empty)
    yield _at_most("nothing in view, a call", number(MAX_CALL[1], 1), longest, MAX_CALL[1])


def body_verdicts(body: Sequence[BodyScore]) -> Iterator[TargetVerdict]:
    """Check the targets of the whole body."""
    ours = {score.variant: score for score in body if score.tracker == OURS}
    for variant, bound in MIN_RIGHT.items():
        if variant in ours:
            yield _at_least(f"right, {variant},", ours[variant].right, bound)
    yield _none("body silently wrong", [(name, score.wrong) for name, score in ours.items()])
    for variant, (median, most) in MAX_COLD.items():
        if variant in ours:
            score, name = ours[variant], f"cold, {variant}, ÷ cv2"
            yield _at_most(name, number(median, 1), score.ratio, median)
            if np.isfinite(most):
                yield _at_most(f"{name}, 95 %", number(most, 1), score.high_ratio, most)
    if FOLLOWED in ours:
        bound = MAX_FOLLOWED
        yield _at_most(f"{FOLLOWED} ÷ cv2", number(bound, 1), ours[FOLLOWED].ratio, bound)
    for name, times, bound in zip(
        ("a call, median,", "a call, most,"),
        ([each.call for each in ours.values()], [each.longest_call for each in ours.values()]),
        MAX_CALL,
        strict=True,
    ):
        yield _at_most(f"{name} ÷ cv2", number(bound, 1), max(times), bound)


def _pair_verdicts(score: PairScore) -> Iterator[TargetVerdict]:
    yield _none("pairs of the dodecahedron wrong", [("", score.wrong)])
    yield _at_least("markers trusted", score.given, MIN_TRUSTED)
    shift, turn = score.from_consensus
    name = "pair from its consensus, median,"
    yield _at_most(name, "0.8 mm", shift, MAX_SHIFT, f"{length(shift)} mm")
    yield _at_most(name, "0.4°", turn, MAX_TURN, f"{angle(turn)}°")
    low, high = INSIDE
    target = "95 % region of pairs holds 85 to 99 %"
    lack = 100 * max(low - score.inside, score.inside - high)
    yield _verdict(target, f"{share(score.inside)} %", f"{lack:.1f} points", lack)


def _at_least(name: str, value: float, bound: float) -> TargetVerdict:
    lack = 100 * (bound - value)
    return _verdict(
        f"{name} ≥ {100 * bound:.0f} %", f"{share(value)} %", f"{lack:.1f} points", lack
    )


def _at_most(name: str, written: str, value: float, bound: float, said: str = "") -> TargetVerdict:
    excess = value / bound - 1
    return _verdict(f"{name} ≤ {written}", said or number(value, 2), f"{excess:.0%}", excess)


def _none(name: str, counts: Sequence[tuple[str, int]]) -> TargetVerdict:
    total = sum(count for _, count in counts)
    where = ", ".join(f"{place} {count}" for place, count in counts if count and place)
    return _verdict(f"{name} 0", f"{total}" + (f" ({where})" if where else ""), f"{total}", total)


def _verdict(target: str, measured: str, miss: str, excess: float) -> TargetVerdict:
    if np.isnan(excess):
        return TargetVerdict(target, "", None)
    return TargetVerdict(target, measured, miss if excess > 0 else "")
