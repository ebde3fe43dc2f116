"""The printed tables and figures that are known, by name: an entry each, whose module makes it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib import import_module
from types import MappingProxyType

from cubeling.app.errors import AppError
from cubeling.app.workshop.pages.report_table import ReportTable
from cubeling.app.workshop.reproduction.result import Reproduction, ReproductionRequest

GRAPHS, IDLE, FACES = "Fernández-Baena 2015", "Egges 2006", "Huang 2013"
"""The theses, by author and year."""


@dataclass(frozen=True)
class PrintedTable:
    """A table or figures of one of the works."""

    name: str
    """What it is called on the command line."""

    work: str

    printed_in: str
    """Where it is printed there."""

    title: str
    """What its figures are of, in a line."""

    module: str = ""
    """Module of this folder, and after a colon the function in it if that is not `reproduce`, which
    makes it from a request; empty if nobody can."""

    needs: tuple[str, ...] = ()
    """Folders of recordings, in that of `--data`, without which it cannot be made."""

    takes_clips: bool = False
    """Whether it can be made from motions of the user's own."""

    missing: str = ""
    """Why it cannot be made at all."""

    printed: ReportTable | None = None
    """The printed figures of what cannot be made."""

    @property
    def source(self) -> str:
        """The work, and where in it."""
        return f"{self.work}, {self.printed_in}"

    def reproduce(self, request: ReproductionRequest) -> Reproduction:
        """Make it again.

        Raises
        ------
        AppError
            If it cannot be made, or not without recordings that are not there.
        """
        if self.missing:
            raise AppError(f"{self.name}: {self.missing}")
        if request.clips and not self.takes_clips:
            raise AppError(f"{self.name}: it is made from no clips; leave out --clip")
        for name in () if request.clips else self.needs:
            try:
                request.folder(name)
            except AppError as error:
                raise AppError(f"{self.name}: {error}") from error
        module, _, function = self.module.partition(":")
        make = getattr(import_module(f"{__package__}.{module}"), function or "reproduce")
        found: Reproduction = make(request)
        return found


TABLES: Mapping[str, PrintedTable] = MappingProxyType(
    {
        table.name: table
        for table in (
            PrintedTable(
                "motion-graphs",
                GRAPHS,
                "tables 3.2 to 3.4, figures 3.14 and 3.15",
                "Motion graphs of whole bodies and of body parts: time, response, best split",
                "motion_graphs.body_parts",
                needs=("cmu-mocap",),
                takes_clips=True,
            ),
            PrintedTable(
                "transitions",
                GRAPHS,
                "figures 3.8 to 3.10, equation 3.3",
                "Progressive transitions: which part of the body leaves and arrives when",
                "motion_graphs.transitions",
                needs=("cmu-mocap",),
            ),
            PrintedTable(
                "gesture-strength",
                GRAPHS,
                "table 4.1",
                "Telling weak strokes from strong ones (MCC)",
                missing="the labels of two experts for 792 strokes, from which it was computed, "
                "were not published",
                printed=ReportTable(
                    "As printed",
                    ("classifier", "printed MCC"),
                    (
                        ("FMDistance alone (GSI)", "0.563"),
                        ("Fisher discriminant", "0.562"),
                        ("SPegasos", "0.554"),
                        ("Logistic regression", "0.551"),
                        ("SMO (SVM)", "0.525"),
                    ),
                ),
            ),
            PrintedTable(
                "gesture-graph",
                GRAPHS,
                "table 4.2",
                "How well a gesture graph is connected, by threshold",
                "gesturing.connectivity",
            ),
            PrintedTable(
                "gesture-timing",
                GRAPHS,
                "figures 4.7 and 4.8",
                "How long gestures lead their accents, and how strong they are",
                "gesturing.timing",
                needs=("speech",),
            ),
            PrintedTable(
                "gesture-votes",
                GRAPHS,
                "tables 4.3 and 4.4, figures 4.13 and 4.14",
                "Which gestures suit the speech: votes of 62 evaluators",
                "studies:gesture_votes",
            ),
            PrintedTable(
                "visemes",
                GRAPHS,
                "table 4.5",
                "Which speech sounds share a shape of the mouth",
                "gesturing.visemes",
            ),
            PrintedTable(
                "vleo-and-pleo",
                GRAPHS,
                "table 5.1, figures 5.22 to 5.24",
                "Children play with Vleo and Pleo: answers, times, preference",
                "studies:vleo_and_pleo",
            ),
            PrintedTable(
                "accent-strength",
                GRAPHS,
                "tables 8.1 and 8.2",
                "Telling weak accents from strong ones (MCC)",
                "gesturing.accent_strength",
                needs=("speech",),
            ),
            PrintedTable(
                "posture-distance",
                IDLE,
                "figures 3.3 to 3.6",
                "How many components of a posture find its nearest neighbour",
                "standing.posture_distance",
                needs=("idle", "cmu-mocap", "bvh"),
            ),
            PrintedTable(
                "idle-motion",
                IDLE,
                "figures 3.8 and 3.12",
                "A person's balance shifts, rests and small variations",
                "standing.idle_figures",
                needs=("idle",),
            ),
            PrintedTable(
                "idle-study",
                IDLE,
                "section 3.3.2",
                "Whose idle motion is it, and is it recorded or generated",
                "standing.idle_study",
                needs=("idle",),
            ),
            PrintedTable(
                "expressions",
                IDLE,
                "table 5.2",
                "Which of six faces shows each of 24 emotions",
                "standing.expressions",
            ),
            PrintedTable(
                "ambient-occlusion",
                FACES,
                "table 3.1, figure 3.10",
                "Ambient occlusion in full and separable form: time and difference",
                "bodies.ambient_occlusion",
            ),
            PrintedTable(
                "facial-actions",
                FACES,
                "tables 4.3 to 4.5",
                "Single facial actions: how well they are identified",
                "studies:facial_actions",
            ),
            PrintedTable(
                "ik-methods",
                FACES,
                "table 7.1",
                "Solvers of inverse kinematics: iterations and time",
                "bodies.ik_methods",
            ),
            PrintedTable(
                "expressivity",
                FACES,
                "figure 8.13",
                "One gesture with two settings of its expressivity",
                "bodies.expressivity",
            ),
        )
    }
)
"""All printed tables that are known, by their names, work by work."""


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
