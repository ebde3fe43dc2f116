"""The benchmark's targets, and whether the measurements reach them."""

from collections.abc import Callable, Iterator, Sequence as Rows
from dataclasses import dataclass

import numpy as np

from tests.bench.tracking.plans import SEQUENCE_PLANS
from tests.bench.tracking.scoring import Score
from tests.bench.tracking.table import OURS, angle, length, number, of, ratio, share


@dataclass(frozen=True)
class TargetVerdict:
    """One target, and what was measured."""

    target: str
    """The target as text."""

    measured: str
    """The worst measurement, and where."""

    miss: str | None
    """By how much it is missed; "" if it is reached, None if nothing was measured."""

    def __str__(self) -> str:
        """Return one line."""
        if self.miss is None:
            return f"not measured            {self.target}"
        verdict = f"misses by {self.miss}" if self.miss else "holds"
        return f"{verdict:<24}{self.target}: {self.measured}"


INDEPENDENT = [name for name, plan in SEQUENCE_PLANS.items() if plan.independent]
"""Sequences in which every frame is another pose."""

NO_HAND_MOTION = ("static", "static-one", *INDEPENDENT, "sweep-1.0")
"""Sequences without ordinary hand motion, left out of the prediction."""

MAX_REST_TURN = (("static", "two or three faces", 0.02), ("static-one", "one face", 0.05))
"""Greatest jitter of a cube at rest [°]. The noise of the pixels on one face square on, by itself,
leaves 0.028 mm and 0.052° to any estimator that keeps no past (Cramér and Rao's bound); a cube at
rest may be averaged (`tracker/rest`)."""


def verdicts(scores: Rows[Score]) -> Iterator[TargetVerdict]:
    """Check every target."""
    ours = [score for score in scores if score.tracker == OURS]
    fast = [score for score in ours if score.sequence == "sweep-1.0"]
    moving = [score for score in ours if score.sequence not in NO_HAND_MOTION]
    yield _at_least("recall ≥ 98 %", [s for s in ours if s not in fast], 0.98)
    yield _at_least("recall at 1 m/s ≥ 90 %", fast, 0.90)
    yield _wrong_verdict(ours)
    yield from _accuracy_verdicts([score for score in ours if score.sequence == "poses"])
    for name, seen, turn in MAX_REST_TURN:
        rest = [score for score in ours if score.sequence == name]
        yield _at_most(f"rest jitter, {seen}, ≤ 0.03 mm", rest, lambda s: s.jitter[0], 0.03e-3, _mm)
        yield _at_most(
            f"rest jitter, {seen}, ≤ {turn}°",
            rest,
            lambda s: s.jitter[1],
            np.deg2rad(turn),
            _degrees,
        )
    followed = [score for score in ours if score.sequence not in INDEPENDENT]
    yield _at_most(
        "time ÷ full-frame cv2 SUBPIX ≤ 0.5, followed", followed, lambda s: ratio(scores, s), 0.5
    )
    yield _at_most(
        "time ÷ full-frame cv2 SUBPIX ≤ 0.5, each pose without a past",
        [score for score in ours if score.sequence in INDEPENDENT],
        lambda s: ratio(scores, s),
        0.5,
    )
    yield _dark_time_verdict(ours)
    yield _covariance_verdict(ours)
    yield _at_most("50 ms ahead ≤ 4 mm", moving, lambda s: s.predicted, 4e-3, _mm)
    yield _at_most("50 ms ahead at 1 m/s ≤ 4 mm", fast, lambda s: s.predicted, 4e-3, _mm)


def _at_least(target: str, scores: Rows[Score], bound: float) -> TargetVerdict:
    below = sorted((s for s in scores if s.seen), key=lambda s: s.recall)
    if not below:
        return TargetVerdict(target, "", None)
    missing = [s for s in below if s.recall < bound] or below[:1]
    said = ", ".join(f"{s.sequence} {share(s.recall)} %" for s in missing)
    lack = 100 * (bound - below[0].recall)
    return TargetVerdict(target, said, f"{lack:.1f} points" if lack > 0 else "")


def _at_most(
    target: str,
    scores: Rows[Score],
    value: Callable[[Score], float],
    bound: float,
    written: Callable[[float], str] = lambda value: number(value, 2),
) -> TargetVerdict:
    known = sorted(((value(s), s.sequence) for s in scores if not np.isnan(value(s))), reverse=True)
    if not known:
        return TargetVerdict(target, "", None)
    missing = [each for each in known if each[0] > bound] or known[:1]
    said = ", ".join(f"{name} {written(worst)}" for worst, name in missing)
    return TargetVerdict(target, said, _excess(known[0][0], bound))


def _wrong_verdict(ours: Rows[Score]) -> TargetVerdict:
    wrong, frames = sum(s.wrong for s in ours), sum(s.frames for s in ours)
    where = ", ".join(f"{s.sequence} {s.wrong}" for s in ours if s.wrong)
    said = f"{wrong} of {frames} frames" + (f" ({where})" if where else "")
    if not frames:
        return TargetVerdict("silently wrong 0", "", None)
    return TargetVerdict("silently wrong 0", said, f"{wrong} frames" if wrong else "")


def _accuracy_verdicts(poses: Rows[Score]) -> Iterator[TargetVerdict]:
    for which, name, millimetres, degrees in ((0, "median", 0.2, 0.05), (1, "95 %", 0.6, 0.15)):
        target = f"sharp cube, {name} ≤ {millimetres} mm"
        yield _at_most(target, poses, lambda s, i=which: s.shift[i], millimetres / 1000, _mm)  # type: ignore[misc]
        target = f"sharp cube, {name} ≤ {degrees}°"
        yield _at_most(target, poses, lambda s, i=which: s.turn[i], np.deg2rad(degrees), _degrees)  # type: ignore[misc]


def _dark_time_verdict(ours: Rows[Score]) -> TargetVerdict:
    target = "time in darkness within 30 % of that in light"
    dark, light = of(ours, "darkness", OURS), of(ours, LIGHT, OURS)
    if dark is None or light is None:
        return TargetVerdict(target, "", None)
    change = dark.milliseconds / light.milliseconds - 1
    return TargetVerdict(target, f"{change:+.0%}", _excess(abs(change), 0.3))


LIGHT = "shaded"
"""The sequence with the same motion as "darkness", in a lit room."""


def _covariance_verdict(ours: Rows[Score]) -> TargetVerdict:
    """Check the covariance over all frames, and name the sequences outside the band."""
    target = "stated 95 % region holds the truth in 90 to 98 %"
    known = [s for s in ours if not np.isnan(s.inside)]
    if not known:
        return TargetVerdict(target, "", None)
    whole = sum(s.inside * s.given for s in known) / sum(s.given for s in known)
    outside = [f"{s.sequence} {share(s.inside)}" for s in known if not 0.90 <= s.inside <= 0.98]
    said = f"{share(whole)} % of all" + (f"; outside: {', '.join(outside)}" if outside else "")
    lack = 100 * max(0.90 - whole, whole - 0.98)
    return TargetVerdict(target, said, f"{lack:.1f} points" if lack > 0 else "")


def _excess(value: float, bound: float) -> str:
    return f"{value / bound - 1:.0%}" if value > bound else ""


def _mm(metres: float) -> str:
    return f"{length(metres)} mm"


def _degrees(radians: float) -> str:
    return f"{angle(radians)}°"
