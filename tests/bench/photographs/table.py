"""The scores as tables for a terminal of 136 columns."""

from collections.abc import Iterable

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from tests.bench.photographs.boards import BoardScore
from tests.bench.photographs.body import BodyScore
from tests.bench.photographs.dodecahedron import Reference
from tests.bench.photographs.empty import CUBE, EmptyScore
from tests.bench.photographs.pairs import MIN_PICTURES, PairScore
from tests.bench.tracking.table import angle, length, number, share

LEFT = ("variant", "tracker", "board", "photographs")
"""Columns of text."""


def show_reference(console: Console, reference: Reference) -> None:
    """Print how well the reference fits."""
    console.print(
        f"The reference: {len(reference.body_from_marker)} markers in "
        f"{len(reference.camera_from_body)} photographs, adjusted together to lines along their "
        f"sides; a corner is\n{reference.error:.2f} px off in the median.\n"
    )


def show_body(console: Console, scores: Iterable[BodyScore]) -> None:
    """Print where the whole body was found."""
    columns = ("variant", "tracker", "frames", "right %", "wrong", "trusted %", "mm", "°",
               "inside %", "ms", "÷ cv2", "95 %", "a call", "most")  # fmt: skip
    rows = (
        (
            score.variant,
            score.tracker,
            str(score.frames),
            share(score.right),
            str(score.wrong),
            share(score.given),
            length(score.shift),
            angle(score.turn),
            share(score.inside),
            number(score.milliseconds, 1),
            *(
                number(each, 2)
                for each in (score.ratio, score.high_ratio, score.call, score.longest_call)
            ),
        )
        for score in scores
    )
    console.print(_table("The dodecahedron as one body, without a past", columns, rows))
    console.print(
        "right: within 10 mm and 5° of the reference; wrong: given, but more than 20 mm or 10° off."
        "\nmm, °: median distance from the reference. inside: the stated 95 % region holds the "
        "reference, which has its own\nerror. ÷ cv2: CPU time of all calls until a picture is "
        "decided, of the time to detect by cv2 SUBPIX, median and\n95th percentile; a call, most: "
        "of single calls, median and greatest. followed: frames 2 to 6 of the same photograph.\n"
    )


def show_pairs(console: Console, scores: Iterable[PairScore]) -> None:
    """Print how alike two markers lie in all pictures."""
    columns = ("tracker", "markers", "trusted %", "pairs", "wrong", "mm", "°", "two: mm",
               "°", "ref.: mm", "°", "inside %")  # fmt: skip
    scores = list(scores)
    rows = (
        (
            score.tracker,
            str(score.markers),
            share(score.given),
            str(score.pairs),
            str(score.wrong),
            length(score.from_consensus[0]),
            angle(score.from_consensus[1]),
            length(score.between_pictures[0]),
            angle(score.between_pictures[1]),
            length(score.from_reference[0]),
            angle(score.from_reference[1]),
            share(score.inside),
        )
        for score in scores
    )
    console.print(_table("Each marker as a cube with one face, two by two", columns, rows))
    judged = ", ".join(f"{score.judged} of {score.tracker}" for score in scores)
    console.print(
        "mm, °: median distance of a pair's relative pose from the consensus of the same two "
        f"markers over all pictures;\ninside: the stated 95 % regions of both hold it. Both for "
        f"markers that share {MIN_PICTURES} pictures or more: {judged}.\ntwo: median "
        "difference between two pictures. wrong: more than 20 mm or 10° from the reference's "
        "relative pose."
    )
    for score in scores:
        if score.verdicts:
            counts = sorted(score.verdicts.items(), key=lambda each: -each[1])
            told = ", ".join(f"{count} {verdict}" for verdict, count in counts)
            console.print(f"{score.tracker}: {told}.\n")


def show_boards(console: Console, scores: Iterable[BoardScore]) -> None:
    """Print how flat the boards are."""
    columns = ("board", "tracker", "markers", "trusted %", "pairs", "wrong", "parallel °",
               "plane mm", "spacing mm", "inside %")  # fmt: skip
    rows = (
        (
            score.board,
            score.tracker,
            str(score.markers),
            share(score.given),
            str(score.pairs),
            str(score.wrong),
            angle(score.parallel),
            length(score.off_plane),
            length(score.spacing),
            share(score.inside),
        )
        for score in scores
    )
    console.print(_table("Each marker of a flat board as a cube with one face", columns, rows))
    console.print(
        "wrong: pairs more than 10° from parallel or 20 mm from their distance. inside: the stated "
        "95 % regions of two\nmarkers hold the angle between them; the lens of the six is not "
        "known to a percent. Without gboriginal.png: its\ndictionary is its own, and a cube has "
        "one of OpenCV's.\n"
    )


def show_empty(console: Console, scores: Iterable[EmptyScore]) -> None:
    """Print the time without the cube."""
    rows = (
        (
            score.pictures,
            str(score.frames),
            str(score.seen),
            number(score.milliseconds, 1),
            number(score.opencv, 1),
            number(score.ratio, 2),
            number(score.high_ratio, 2),
            number(score.longest_call, 2),
        )
        for score in scores
    )
    columns = ("photographs", "frames", "seen", "ms", "cv2 ms", "÷ cv2", "95 %", "longest call")
    console.print(_table(f"Nothing in view: the cube {CUBE}, a new tracker", columns, rows))


def _table(title: str, columns: Iterable[str], rows: Iterable[tuple[str, ...]]) -> Table:
    table = Table(title=title, box=SIMPLE_HEAD, title_justify="left")
    for column in columns:
        table.add_column(column, justify="left" if column in LEFT else "right")
    before = ""
    for row in rows:
        table.add_row("" if row[0] == before else row[0], *row[1:])
        before = row[0]
    return table
