"""The controllers, a file each. The first that suits a character plays it."""

from characters.control.controllers.controller import CharacterController
from characters.control.controllers.in_place import InPlaceController
from characters.control.controllers.tree import TreeController
from characters.control.controllers.walk import WalkController
from characters.model.character import Character

WALKER_HEIGHT_M = 0.17
"""Default height on the table of a character that walks [m]."""

ACTOR_HEIGHT_M = 0.15
"""Default height on the table of a character that acts in place [m]."""


CONTROLLERS: list[type[CharacterController]] = [TreeController, WalkController, InPlaceController]
"""All controllers, in the order in which they are tried."""


def default_height(character: Character) -> float:
    """Return the default height of a character on the table [m]."""
    return WALKER_HEIGHT_M if WalkController.suits(character) else ACTOR_HEIGHT_M
