"""The controllers, a file each. The first that suits a character plays it."""

from characters.control.controllers.controller import ControllerType
from characters.control.controllers.in_place import InPlaceController
from characters.control.controllers.tree import TreeController
from characters.control.controllers.walk import WalkController
from characters.model.character import Character

WALKER_HEIGHT_M = 0.17
"""Default height on the table of a character that walks [m]."""

ACTOR_HEIGHT_M = 0.15
"""Default height on the table of a character that acts in place [m]."""


def _height(character: Character) -> float:
    return WALKER_HEIGHT_M if WalkController.suits(character) else ACTOR_HEIGHT_M


CONTROLLERS = [
    ControllerType(TreeController.suits, TreeController, _height),
    ControllerType(WalkController.suits, WalkController, _height),
    ControllerType(lambda _: True, InPlaceController, _height),
]
"""All controllers, in the order in which they are tried."""


def controller_for(character: Character) -> ControllerType:
    """Return the controller that plays a character."""
    return next(kind for kind in CONTROLLERS if kind.suits(character))
