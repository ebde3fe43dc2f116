"""The printed tables that are known, by name: an entry for each, whose module makes it."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from types import MappingProxyType

from cubeling.app.errors import AppError
from cubeling.app.workshop.reproduction.result import Reproduction

Progress = Callable[[str], None]
"""Called with what is being done."""


@dataclass(frozen=True)
class PrintedTable:
    """A table of one of the works."""

    name: str
    """What it is called on the command line."""

    source: str
    """Where it is printed."""

    title: str
    """What its figures are of, in a line."""

    module: str = ""
    """Module of this folder whose `reproduce(folder, progress)` makes it; empty if nobody can."""

    needs: str = ""
    """Folder of recordings, in that of `--data`, without which it cannot be made."""

    missing: str = ""
    """Why it cannot be made at all."""

    def reproduce(self, data: Path | None, progress: Progress) -> Reproduction:
        """Make the table again.

        Parameters
        ----------
        data
            The folder of recordings; None if the user named none.
        progress
            Called with what is being done.

        Raises
        ------
        AppError
            If it cannot be made, or not without recordings that are not there.
        """
        if self.missing:
            raise AppError(f"{self.name}: {self.missing}")
        folder = None
        if self.needs:
            if data is None:
                raise AppError(f"{self.name}: name the folder that holds '{self.needs}' by --data")
            folder = data / self.needs
            if not folder.is_dir():
                raise AppError(f"{self.name}: there is no folder '{self.needs}' in '{data}'")
        found: Reproduction = import_module(f"{__package__}.{self.module}").reproduce(
            folder, progress
        )
        return found


_GRAPHS = "Fernández-Baena 2015"
_FACES = "Huang 2013"
_IDLE = "Egges 2006"
_TWO_LABELLERS = "the labels of two experts, from which it was computed, were not published"

TABLES: Mapping[str, PrintedTable] = MappingProxyType(
    {
        table.name: table
        for table in (
            PrintedTable(
                "motion-graphs",
                f"{_GRAPHS}, tables 3.2, 3.3 and 3.4",
                "Graphs of whole bodies and of body parts: time between frames, response, profiles",
                "motion_graphs",
                needs="cmu-mocap",
            ),
            PrintedTable(
                "gesture-strength",
                f"{_GRAPHS}, table 4.1",
                "Telling weak strokes from strong ones (MCC)",
                missing=_TWO_LABELLERS,
            ),
            PrintedTable(
                "gesture-graph",
                f"{_GRAPHS}, table 4.2",
                "How well a gesture graph is connected, by threshold",
                "gesture_graph",
            ),
            PrintedTable(
                "accent-strength",
                f"{_GRAPHS}, tables 8.1 and 8.2",
                "Telling weak accents from strong ones (MCC)",
                missing=_TWO_LABELLERS,
            ),
            PrintedTable(
                "expressions",
                f"{_IDLE}, table 5.2",
                "Which of six faces shows each of 24 emotions",
                "expressions",
            ),
            PrintedTable(
                "ik-methods",
                f"{_FACES}, table 7.1",
                "Solvers of inverse kinematics: iterations and time",
                "ik_methods",
            ),
        )
    }
)
"""All printed tables that are known, by their names."""


def chosen_tables(names: Iterable[str]) -> list[PrintedTable]:
    """Return the tables of some names; of none, all.

    Raises
    ------
    AppError
        If there is no table of a name.
    """
    names = list(dict.fromkeys(names))
    for name in names:
        if name not in TABLES:
            raise AppError(f"there is no table '{name}': choose from {', '.join(TABLES)}")
    return [TABLES[name] for name in names or TABLES]
