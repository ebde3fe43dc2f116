"""Table 7.1 of Huang 2013: iterations and time of solvers of inverse kinematics."""

from collections.abc import Sequence

from cubeling.app.workshop.pages.report_table import ReportTable
from cubeling.app.workshop.reproduction.bodies.ik_figures import (
    CHAIN_SIZES,
    AloneFigures,
    SureFigures,
    measure_alone,
    measure_sure,
)
from cubeling.app.workshop.reproduction.result import Reproduction, ReproductionRequest
from cubeling.characters.motion import SOLVERS, TOLERANCE

PRINTED: dict[str, dict[int, tuple[float, float]]] = {
    "springs-force": {6: (49.6, 0.195), 10: (60.5, 0.253)},
    "springs": {6: (26.9, 0.132), 10: (40.1, 0.169)},
    "ccd": {6: (33.2, 0.131), 10: (39.7, 0.148)},
    "pseudo-inverse": {6: (51.8, 1.095), 10: (55.9, 1.310)},
    "transpose": {6: (6.8, 0.124), 10: (17.1, 0.235)},
    "damped": {6: (55.6, 1.237), 10: (68.7, 1.450)},
}
"""Table 7.1 of Huang: iterations and milliseconds of each method, by the number of joints."""

TARGETS = 1000
"""Random targets of each row: ends of random postures within the limits."""


def reproduce(request: ReproductionRequest) -> Reproduction:
    """Return the table, and that of solvers with what all share, beside the printed figures."""
    alone, sure = [], []
    for joints in CHAIN_SIZES:
        for method in SOLVERS:
            request.progress(f"{method}, {joints} joints")
            alone.append(measure_alone(method, joints, TARGETS))
            sure.append(measure_sure(method, joints, TARGETS))
    return Reproduction(
        (printed_table(alone), alone_table(alone), sure_table(sure)),
        f"{TARGETS:,} random targets within reach, within {TOLERANCE:g} of the chain; on this "
        "machine",
        "The thesis states no processor, tolerance, lengths or targets. Its pseudo-inverse and "
        "damped least squares are ten times as slow as its springs; ours are not. The third table "
        "adds what all our methods share: limits, chains that curl up for near targets, and damped "
        "least squares for what is left. Change: summed turn of the joints. Zig-zag: changes of "
        "the sense of the bend, for targets near the base. Twist: of a bone, for a centimetre of "
        "its target; 99 % are less (second table, from one start), or 99.9 % (third, following).",
    )


def printed_table(figures: Sequence[AloneFigures]) -> ReportTable:
    """Return the table as printed, with what the methods do alone."""
    rows = []
    for each in figures:
        steps, time_ms = PRINTED.get(each.method, {}).get(each.joints, (None, None))
        rows.append(
            (
                each.method,
                f"{each.joints}",
                "" if steps is None else f"{steps:g}",
                f"{each.iterations:.1f}",
                "" if time_ms is None else f"{time_ms:.2f}",
                f"{each.single_ms:.2f}",
            )
        )
    columns = "alone", "joints", "printed steps", "steps", "printed ms", "ms"
    return ReportTable("Table 7.1 again", columns, tuple(rows))


def alone_table(figures: Sequence[AloneFigures]) -> ReportTable:
    """Return what else the methods do alone."""
    rows = tuple(
        (
            each.method,
            f"{each.joints}",
            f"{each.batch_us:.1f}",
            f"{each.solved:.1%}",
            f"{each.in_limits:.1%}",
            f"{each.change_deg:.0f}°",
            f"{each.zig_zag:.2f}",
            f"{each.twist_deg:.1f}°",
        )
        for each in figures
    )
    columns = (
        *("alone", "joints", "µs in a batch", "solved", "in limits", "change"),
        *("zig-zag", "twist per cm"),
    )
    return ReportTable("How well they solve", columns, rows)


def sure_table(figures: Sequence[SureFigures]) -> ReportTable:
    """Return what the methods do with what all share."""
    rows = tuple(
        (
            each.method,
            f"{each.joints}",
            f"{each.iterations:.1f}",
            f"{each.batch_us:.1f}",
            f"{each.solved:.2%}",
            f"{each.violations}",
            f"{each.change_deg:.0f}°",
            f"{each.zig_zag:.2f}",
            f"{each.twist_deg:.1f}°",
        )
        for each in figures
    )
    columns = (
        *("begun by", "joints", "steps", "µs in a batch", "solved", "beyond limits"),
        *("change", "zig-zag", "twist per cm"),
    )
    return ReportTable("Within limits, made sure", columns, rows)
