"""One transition as the whole body makes it, and as its parts do in each way of searching."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.characters.motion import (
    PRINTED_COSTS,
    PRINTED_SEARCH,
    WHOLE_BODY,
    MotionLibrary,
    PartMove,
    PartStreams,
    StoredGraph,
    Transition,
    TransitionPlanner,
    part_graphs,
    standard_graph,
    whole_body_transition,
)

CHAIN_NAMES = {"1": "head", "2": "trunk", "3": "right arm", "4": "left arm"}
"""Names of the chains of M2.1 but the legs."""

SHORT_NAMES = {WHOLE_BODY: "whole body", "BP56": "legs", "BP34": "arms", "BP1234": "upper body"}

NO_WAY = {
    "legs": "; no way in the windows: all follow the legs",
    "standard": "; no way in the windows: all as one",
}
"""What is said of a transition by how far its search went."""


@dataclass(frozen=True)
class FoundTransition:
    """A transition, as one way of searching finds it."""

    title: str

    parts: tuple[str, ...]
    """Name of each part."""

    transition: Transition

    @property
    def summary(self) -> str:
        """When the first part leaves, and when the last has arrived."""
        found = self.transition
        return (
            f"{self.title}: the first part leaves after {quantity(found.response, 'frame')}, the "
            f"target plays after {found.duration}{NO_WAY.get(found.fallback, '')}"
        )

    def clips(self, library: MotionLibrary, context: int) -> NDArray[np.intp]:
        """Return the number of the clip that each part plays, (parts, times), from −context on.

        It ends as many frames after the arrival.
        """
        streams = PartStreams.of(self.transition, library, context, context)
        nearer = np.where(streams.between < 0.5, streams.before, streams.after)
        return library.clip_of[nearer]


def find_transitions(
    stored: StoredGraph, origin: str, target: str, at: float | None, as_printed: bool
) -> tuple[FoundTransition, ...]:
    """Return the transitions of the whole body and of the parts.

    Parameters
    ----------
    stored
        The graphs.
    origin, target
        Names of the clips.
    at
        Time in the clip at which the target is asked for [s], its middle if left out. The nearest
        frame that is in all graphs asks.
    as_printed
        Whether the parts are searched as the thesis prints it, too.

    Raises
    ------
    AppError
        If both clips are one, the time is not in the clip, or none of its frames is in all graphs.
    CharacterError
        If there is no such clip, or the target is in no graph.
    """
    library = stored.library
    frames, goals = library.clip(origin), np.isin(np.arange(len(library)), library.clip(target))
    if origin == target:
        raise AppError(f"{origin!r} is where it begins: give another clip as the target")
    length_s = len(frames) / library.rate
    if at is not None and not 0.0 <= at <= length_s:
        raise AppError(f"--at {at:g}: clip {origin!r} lasts {length_s:.2f} s")
    whole, parts = standard_graph(stored), part_graphs(stored)
    kept = frames[(whole.kept & parts.kept)[frames]]
    if not len(kept):
        raise AppError(
            f"clip {origin!r} is not in all graphs: its frames were pruned; raise the threshold"
        )
    wanted = frames[0] + (length_s / 2 if at is None else at) * library.rate
    request = int(kept[np.argmin(np.abs(kept - wanted))])
    alone = whole_body_transition(whole, request, goals)
    found = [FoundTransition("Whole body", (SHORT_NAMES[WHOLE_BODY],), alone)]
    names = tuple(part_name(part.name) for part in parts.parts)
    if as_printed:
        printed = part_graphs(replace(stored, rule=PRINTED_COSTS.rule))
        planned = TransitionPlanner(printed, None, PRINTED_SEARCH).plan(request, goals)
        found.append(FoundTransition("Parts as printed", names, planned))
    own = TransitionPlanner(parts, whole).plan(request, goals)
    return (*found, FoundTransition("Parts", names, own))


def part_name(name: str) -> str:
    """Return what a part of the body is called.

    >>> part_name("BP56"), part_name("BP12"), part_name("BP234")
    ('legs', 'head, trunk', 'trunk, right arm, left arm')
    """
    return SHORT_NAMES.get(name) or ", ".join(CHAIN_NAMES[digit] for digit in name[2:])


def clips_on_the_way(library: MotionLibrary, move: PartMove) -> list[str]:
    """Return the names of the clips that a part plays between its own and the target."""
    numbers = library.clip_of[move.frames]
    between = [n for n in dict.fromkeys(numbers.tolist()) if n not in (numbers[0], numbers[-1])]
    return [library.names[number] for number in between]
