"""Tables 3.2 to 3.4 of Fernández-Baena 2015, on recordings of the CMU motion capture database."""

from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.app.workshop.motion_graphs.recordings import gather
from cubeling.app.workshop.motion_graphs.summary import (
    TITLES,
    Estimate,
    printed_value,
    summarize,
)
from cubeling.app.workshop.motion_graphs.tables import AS_PRINTED, OURS, Measurement, measure
from cubeling.app.workshop.reproduction.registry import Progress
from cubeling.app.workshop.reproduction.result import Reproduction, ResultTable
from cubeling.characters import Character
from cubeling.characters.model import with_root_joint
from cubeling.characters.motion import DEFAULT_RATE_HZ, MotionLibrary

CHOICES = (
    ("16_15", "16_35", "16_21", "16_11"),
    ("16_16", "16_36", "16_22", "16_12"),
    ("02_01", "02_03", "16_57", "49_01"),
)
"""Recordings of a walk, a run, a walk with long steps and a slow walk: subject and take."""

STRIDE = 16
"""Frames from one request to the next."""


def reproduce(folder: Path | None, progress: Progress) -> Reproduction:
    """Return the tables in the thesis's way of searching and in ours, beside the printed ones."""
    assert folder is not None  # the registry says that it needs one
    choices: list[Measurement] = []
    body = with_root_joint(Character.load("human"))
    for number, names in enumerate(CHOICES, 1):
        paths = [folder / name[:2] / f"{name}.amc" for name in names]
        for path in paths:
            if not path.is_file():
                raise AppError(f"there is no recording '{path}'")

        def report(what: str, number: int = number) -> None:
            progress(f"choice {number} of {len(CHOICES)}, {what}")

        report("reading")
        clips = gather([str(path) for path in paths], body)
        library = MotionLibrary.of(clips, body.skeleton, body.anatomy, DEFAULT_RATE_HZ)
        choices.append(measure(library, STRIDE, (AS_PRINTED, OURS), False, report))
    found = summarize(choices)
    tables = []
    for name, title in TITLES.items():
        rows = []
        for key, cells in found.cells.items():
            if key[0] == name:
                ours = (_with_spread(cells[way]) for way in found.ways)
                rows.append((f"{key[1]} {key[2]}", printed_value(key), *ours))
        tables.append(ResultTable(title, ("", "printed", *found.ways), tuple(rows)))
    orders = ". ".join(found.order(way).capitalize() for way in found.ways)
    return Reproduction(
        tuple(tables),
        f"{len(CHOICES)} choices of four recordings of CMU's subjects 2, 16 and 49; means, and "
        "95 % intervals by the bootstrap",
        "The clips of the thesis are not public, and thresholds depend on clips and convention: "
        f"ours are the printed multiples of the first that joins all clips. {orders}.",
    )


def _with_spread(estimate: Estimate) -> str:
    return f"{estimate.text} ({estimate.spread})" if estimate.spread else estimate.text
