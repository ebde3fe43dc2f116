"""Tables 3.2 to 3.4 and figures 3.14 and 3.15 of Fernández-Baena 2015, on recordings of walks."""

from functools import partial
from typing import TYPE_CHECKING

from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.workshop.moods.colors import CURVE_STYLES
from cubeling.app.workshop.motion_graphs.recordings import clip_names, gather
from cubeling.app.workshop.pages.report_table import ReportTable
from cubeling.app.workshop.reproduction.motion_graphs.measuring import (
    AS_PRINTED,
    OURS,
    Curves,
    Measurement,
    measure,
)
from cubeling.app.workshop.reproduction.motion_graphs.summary import (
    TITLES,
    Estimate,
    TablesSummary,
    printed_value,
    summarize,
)
from cubeling.app.workshop.reproduction.result import DrawnFigure, Reproduction, ReproductionRequest
from cubeling.characters import Character
from cubeling.characters.model import with_root_joint
from cubeling.characters.motion import DEFAULT_RATE_HZ, MotionLibrary

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CHOICES = (
    ("16_15", "16_35", "16_21", "16_11"),
    ("16_16", "16_36", "16_22", "16_12"),
    ("02_01", "02_03", "16_57", "49_01"),
)
"""Recordings of a walk, a run, a walk with long steps and a slow walk: subject and take."""

STRIDE = 32
"""Frames from one request to the next."""

DIFFERS = """The clips of the thesis are not public, and thresholds depend on clips and on the
convention of angles: ours are the printed multiples of the first that joins all clips. "As printed"
searches as the thesis does: a jump joins the look-alikes themselves, no part leaves or arrives
before the legs, only the cheapest path between two frames is looked at, and table 3.3 has the
shortest duration over all frames of the target (eq. 3.4). "Ours" has windows on both sides, paths
whose lengths fit, and the cheapest transition. "No answer" is the share of requests for which the
parts found no way in the windows; table 3.3 compares the others. The curves are those of the first
choice. Of the figures, only what the text says of them is left: the least threshold connects all
frames in the order SP4b, SP5, SP3a, SP4a, SMG, SP2, SP3b, and the cost falls with the number of
parts.""".replace("\n", " ")


def reproduce(request: ReproductionRequest) -> Reproduction:
    """Return the tables in the thesis's way of searching and in ours, beside the printed ones."""
    choices: list[Measurement] = []
    body = with_root_joint(Character.load("human"))
    named = chosen_clips(request)
    for number, names in enumerate(named, 1):

        def report(what: str, number: int = number) -> None:
            request.progress(f"choice {number} of {len(named)}, {what}")

        report("reading")
        library = MotionLibrary.of(
            gather(names, body), body.skeleton, body.anatomy, DEFAULT_RATE_HZ
        )
        choices.append(measure(library, STRIDE, (AS_PRINTED, OURS), not choices, report))
    found = summarize(choices)
    orders = ". ".join(found.order(way).capitalize() for way in found.ways)
    data = (
        f"{quantity(len(named), 'choice')} of four of your own clips"
        if request.clips
        else f"{len(named)} choices of four recordings of CMU's subjects 2, 16 and 49"
    )
    return Reproduction(
        tuple(_table(found, name, title) for name, title in TITLES.items()),
        f"{data}; means, and 95 % intervals by the bootstrap",
        f"{DIFFERS} {orders}.",
        plots_of(choices[0]),
    )


def chosen_clips(request: ReproductionRequest) -> list[list[str]]:
    """Return the names of the four clips of each choice; raises AppError."""
    if request.clips:
        names = clip_names(request.clips)
        if len(names) % 4:
            raise AppError(
                f"motion-graphs: {quantity(len(names), 'clip')}: give four, a walk, a run, long "
                "steps and a slow walk, or several choices of four"
            )
        return [names[first : first + 4] for first in range(0, len(names), 4)]
    folder = request.folder("cmu-mocap")
    paths = [[folder / name[:2] / f"{name}.amc" for name in names] for names in CHOICES]
    for path in (path for choice in paths for path in choice):
        if not path.is_file():
            raise AppError(f"there is no recording '{path}'")
    return [[str(path) for path in choice] for choice in paths]


def _table(found: TablesSummary, name: str, title: str) -> ReportTable:
    rows = []
    for key, cells in found.cells.items():
        if key[0] == name:
            ours = (_with_spread(cells[way]) for way in found.ways)
            rows.append((f"{key[1]} {key[2]}", printed_value(key), *ours))
    return ReportTable(title, ("", "printed", *found.ways), tuple(rows))


def _with_spread(estimate: Estimate) -> str:
    return f"{estimate.text} ({estimate.spread})" if estimate.spread else estimate.text


def plots_of(measured: Measurement) -> tuple[DrawnFigure, ...]:
    """Return connectivity and cost against the threshold, of one choice of clips."""
    shown = (
        ("Figure 3.14", measured.connectivity, "share of frames connected"),
        ("Figure 3.15", measured.cost, "mean cost of a transition"),
    )
    return tuple(
        DrawnFigure(f"{number}: {label} by split profile, ours", partial(_draw, curves, label))
        for number, curves, label in shown
        if curves
    )


def _draw(curves: Curves, label: str, figure: "Figure") -> None:
    axes = figure.subplots()
    for number, (name, (thresholds, values)) in enumerate(curves.items()):
        color, dashes = CURVE_STYLES[number % len(CURVE_STYLES)]
        marker = "o" if number < len(CURVE_STYLES) else "s"
        axes.plot(
            thresholds,
            values,
            label=name,
            markersize=3.5,
            color=color,
            linestyle=(0, dashes or None),
            marker=marker,
        )
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.set_xlabel("threshold")
    axes.set_ylabel(label)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
