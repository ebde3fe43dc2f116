"""Figures 3.8 to 3.10 and equation 3.3 of Fernández-Baena 2015: transitions part by part."""

from functools import partial
from typing import TYPE_CHECKING

from cubeling.app.workshop.motion_graphs.recordings import gather
from cubeling.app.workshop.motion_graphs.transition import FoundTransition, find_transitions
from cubeling.app.workshop.pages.report_table import ReportTable
from cubeling.app.workshop.reproduction.motion_graphs.body_parts import CHOICES, chosen_clips
from cubeling.app.workshop.reproduction.result import DrawnFigure, Reproduction, ReproductionRequest
from cubeling.characters import Character
from cubeling.characters.model import with_root_joint
from cubeling.characters.motion import DEFAULT_RATE_HZ, MotionLibrary, PartMove, analyse

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PRINTED_STARTS_S = {"whole body": 1.00, "parts": 0.01}
"""After which time a walk begins to become a run, in the demonstration."""

WALK, RUN, _, _ = CHOICES[0]


def reproduce(request: ReproductionRequest) -> Reproduction:
    """Return the way from a walk to a run of the whole body, and of its parts in both ways."""
    body = with_root_joint(Character.load("human"))
    request.progress("reading")
    clips = gather(chosen_clips(ReproductionRequest(request.data))[0], body)
    library = MotionLibrary.of(clips, body.skeleton, body.anatomy, DEFAULT_RATE_HZ)
    stored = analyse(library, progress=request.progress)
    whole, printed, ours = find_transitions(stored, WALK, RUN, None, as_printed=True)
    starts = tuple(
        (
            f"{name} [s]",
            f"{PRINTED_STARTS_S[name]:.2f}",
            f"{each.transition.response / library.rate:.2f}",
            f"{each.transition.duration / library.rate:.2f}",
        )
        for name, each in (("whole body", whole), ("parts", ours))
    )
    return Reproduction(
        (
            ReportTable(
                "A walk becomes a run",
                ("begins after", "printed", "ours", "ours: the run plays after"),
                starts,
            ),
            _synchronised("Equation 3.3, parts as printed", printed),
            _synchronised("Equation 3.3, our parts", ours),
        ),
        f"CMU's {WALK} and {RUN}, asked for in the middle of the walk, on graphs of the four clips "
        "of the first choice",
        "Only the text about these figures is left: figure 3.8 has four parts. The printed walk "
        "and run are others. 0.01 s is less than a frame at 60 Hz: at the next frame. Equation 3.3 "
        "has one duration for all parts once their paths are scaled to meet, and others before.",
        tuple(
            DrawnFigure(f"Figures 3.8 to 3.10, ours: {title}", partial(_draw, library, shown))
            for title, shown in (
                ("parts leave and arrive one after the other", (ours,)),
                ("the whole body, parts as printed, and our parts", (whole, printed, ours)),
            )
        ),
    )


def duration(move: PartMove, last: int, *, scaled: bool) -> int:
    """Return T of equation 3.3 by one part, from its path as found or as scaled [frames]."""
    length = move.required if scaled else move.length
    return move.departure + length + (last - move.arrival)


def _synchronised(title: str, found: FoundTransition) -> ReportTable:
    moves = found.transition.moves
    last = found.transition.duration
    rows = tuple(
        (
            name,
            *(f"{value}" for value in (move.departure, move.length, move.required, move.arrival)),
            *(f"{duration(move, last, scaled=scaled)}" for scaled in (False, True)),
        )
        for name, move in zip(found.parts, moves, strict=True)
    )
    columns = (
        *("part", "leaves", "frames of its path", "scaled to", "arrives"),
        *("T before scaling", "T after"),
    )
    return ReportTable(title, columns, rows)


def _draw(library: MotionLibrary, shown: tuple[FoundTransition, ...], figure: "Figure") -> None:
    from cubeling.app.workshop.motion_graphs.timeline import draw_timeline, timeline_size_in

    figure.set_size_inches(timeline_size_in(library, shown))
    draw_timeline(figure, library, shown)
