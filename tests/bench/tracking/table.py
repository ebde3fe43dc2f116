"""The scores as tables for a terminal of 120 columns."""

from collections.abc import Sequence as Rows

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from tests.bench.tracking.scoring import Score

OURS, REFERENCE = "Cubeling", "cv2 SUBPIX"
"""Titles of the tracker that is judged, and of the one whose time is the yardstick."""

COLUMNS = ("tracker", "frames", "recall %", "wrong %", "mm", "95 %", "°", "95 %", "ms", "÷ cv2")
OWN = (
    "sequence", "inside %", "σ ×", "50 ms ahead mm", "const. velocity", "held",
    "velocity mm/s", "°/s",
)  # fmt: skip


def show(console: Console, scores: Rows[Score]) -> None:
    """Print the accuracy of all trackers, then what only Cubeling reports, then the jitter."""
    console.print(_accuracy_table(scores))
    console.print(
        "wrong: given, but more than 20 mm or 10° off. 95 %: percentile of the error. raw: without "
        f"its filter.\n÷ cv2: of the time that {REFERENCE} takes to detect, without solving.\n"
    )
    console.print(_covariance_table(scores))
    console.print(
        "inside: the stated 95 % ellipsoid holds the truth; σ ×: how many times too small the "
        "stated deviations are.\n50 ms ahead: median distance between where the tracker's "
        "prediction, its last two poses continued, or its last\npose has the cube and where it is "
        "then. velocity: median error of the stated one.\n"
    )
    console.print(_jitter_table(scores))
    for score in scores:
        if score.failed:
            console.print(
                f"{score.tracker} broke down in {score.failed} frames of {score.sequence}: "
                f"{'; '.join(score.failures)[:200]}"
            )


def one_line(scores: Rows[Score], sequence: str) -> str:
    """Return a sequence's scores in one line of progress."""
    return "; ".join(
        f"{s.tracker} {share(s.recall)} % {length(s.shift[0])} mm {number(s.milliseconds, 1)} ms"
        for s in scores
        if s.sequence == sequence
    )


def of(scores: Rows[Score], sequence: str, tracker: str) -> Score | None:
    """Find the score of one tracker on one sequence."""
    found = [s for s in scores if s.sequence == sequence and s.tracker == tracker]
    return found[0] if found else None


def ratio(scores: Rows[Score], score: Score) -> float:
    """Time of a tracker ÷ that of the yardstick's detection on the same frames."""
    yardstick = of(scores, score.sequence, REFERENCE)
    return score.milliseconds / yardstick.detection_ms if yardstick else float("nan")


def number(value: float, digits: int, factor: float = 1.0) -> str:
    """Write a figure in another unit; "–" where there is none.

    >>> number(0.0123, 1, 1000), number(float("nan"), 1)
    ('12.3', '–')
    """
    return "–" if np.isnan(value) else f"{value * factor:.{digits}f}"


def share(value: float) -> str:
    """Write a share in per cent, and never round a lack away.

    >>> share(1.0), share(0.99996), share(0.9712), share(0.00004), share(0.0)
    ('100', '99.9', '97.1', '0.1', '0')
    """
    if np.isnan(value):
        return "–"
    if value in (0, 1):
        return f"{100 * value:.0f}"
    return f"{np.clip(100 * value, 0.1, 99.9):.1f}"


def length(metres: float) -> str:
    """Write a length in mm with three digits or so.

    >>> length(0.0000123), length(0.00123), length(0.123)
    ('0.012', '1.23', '123.0')
    """
    return number(metres, 3 if metres < 0.001 else 2 if metres < 0.01 else 1, 1000)


def angle(radians: float) -> str:
    """Write an angle in degrees with three digits or so."""
    degrees = np.rad2deg(radians)
    return number(degrees, 3 if degrees < 1 else 2 if degrees < 10 else 1)


def _accuracy_table(scores: Rows[Score]) -> Table:
    table = Table(title="Pose of the cube against the truth", box=SIMPLE_HEAD, title_justify="left")
    table.add_column("sequence")
    for column in COLUMNS:
        table.add_column(column, justify="left" if column == "tracker" else "right")
    for name in dict.fromkeys(score.sequence for score in scores):
        group = [score for score in scores if score.sequence == name]
        for line, score in enumerate(group):
            table.add_row("" if line else name, *_row(scores, score))
        table.add_section()
    return table


def _row(scores: Rows[Score], score: Score) -> tuple[str, ...]:
    return (
        score.tracker,
        str(score.frames),
        share(score.recall),
        share(score.wrong / score.frames),
        *(length(value) for value in score.shift),
        *(angle(value) for value in score.turn),
        number(score.milliseconds, 2),
        number(ratio(scores, score), 2),
    )


def _covariance_table(scores: Rows[Score]) -> Table:
    table = Table(title="What only Cubeling reports", box=SIMPLE_HEAD, title_justify="left")
    for column in OWN:
        table.add_column(column, justify="left" if column == "sequence" else "right")
    for score in scores:
        if score.tracker == OURS:
            table.add_row(
                score.sequence,
                share(score.inside),
                number(score.understated, 2),
                *own_columns(score),
            )
    return table


def own_columns(score: Score) -> tuple[str, ...]:
    """Prediction and velocity, where the cube moves; (5,) texts."""
    if score.sequence.startswith("static"):
        return ("",) * 5
    speeds = zip(score.speed, (1000, 180 / np.pi), strict=True)
    return (
        *(length(each) for each in prediction_errors(score)),
        *(number(each, 1, factor) for each, factor in speeds),
    )


def prediction_errors(score: Score) -> tuple[float, float, float]:
    """Errors of the prediction, of constant velocity, and of the last pose held [m]."""
    return score.predicted, score.extrapolated, score.held


def _jitter_table(scores: Rows[Score]) -> Table:
    table = Table(title="Jitter at rest", box=SIMPLE_HEAD, title_justify="left")
    for column in ("sequence", "tracker", "mm", "°"):
        table.add_column(column, justify="right" if column in ("mm", "°") else "left")
    for score in scores:
        if score.sequence.startswith("static"):
            figures = length(score.jitter[0]), angle(score.jitter[1])
            table.add_row(score.sequence, score.tracker, *figures)
    return table
