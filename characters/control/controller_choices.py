"""The names by which a user chooses a controller, which is loaded only then."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from cubeling.characters.errors import CharacterError

if TYPE_CHECKING:
    from cubeling.characters.control.controllers import ControllerFactory
    from cubeling.characters.model.character import Character


@dataclass(frozen=True)
class ControllerChoice:
    """A controller that a user may choose."""

    summary: str
    """What it plays, for the help of the command line: one phrase, no full stop."""

    prepare: Callable[[Character, Sequence[str]], ControllerFactory]
    """Prepares it for a character from the motions that the user names; may take seconds.

    It raises a CharacterError if the character or a motion does not suit.
    """


def _tree(character: Character, motions: Sequence[str]) -> ControllerFactory:
    if motions:
        raise CharacterError(
            f"{motions[0]}: the controller 'tree' plays the character's own clips; leave the "
            "motions out, or choose a controller that takes them"
        )
    from cubeling.characters.control.controllers import first_suitable

    return first_suitable


def _graph(kind: str, character: Character, motions: Sequence[str]) -> ControllerFactory:
    from cubeling.characters.control.controllers.graph import graph_factory

    return graph_factory(kind, character, motions)


def _matching(character: Character, motions: Sequence[str]) -> ControllerFactory:
    from cubeling.characters.control.controllers.matching import matching_factory

    return matching_factory(character, motions)


CONTROLLER_CHOICES: dict[str, ControllerChoice] = {
    "tree": ControllerChoice("the character's own blend trees", _tree),
    "graph": ControllerChoice(
        "a motion graph, of a .graph file, of motions or of its own clips",
        partial(_graph, "graph"),
    ),
    "parts": ControllerChoice(
        "the same with a graph for each part of its body", partial(_graph, "parts")
    ),
    "matching": ControllerChoice(
        "at each moment the frame of its motions that suits best", _matching
    ),
}
"""What a user may choose, by name; a new controller is registered here."""


def check_controller(name: str) -> None:
    """Raise CharacterError if no controller has a name."""
    if name not in CONTROLLER_CHOICES:
        raise CharacterError(
            f"no controller is called {name!r}: choose one of {', '.join(CONTROLLER_CHOICES)}"
        )


def choose_controller(
    name: str, character: Character, motions: Sequence[str] = ()
) -> ControllerFactory:
    """Prepare the controller of a name for a character.

    Parameters
    ----------
    name
        One of `CONTROLLER_CHOICES`.
    character
        Whom it is to play.
    motions
        Files that it takes its motions from; without any, the character's own clips.

    Raises
    ------
    CharacterError
        If no controller has that name, or the character or a motion does not suit it.
    """
    check_controller(name)
    return CONTROLLER_CHOICES[name].prepare(character, motions)
