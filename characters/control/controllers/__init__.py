"""The controllers, a file each; `controller_choices` has the names by which a user chooses one."""

from collections.abc import Callable

from cubeling.characters.control.controllers.controller import CharacterController
from cubeling.characters.control.controllers.walk import WalkController
from cubeling.characters.model.character import Character
from cubeling.characters.motion.motion import RootDelta

WALKER_HEIGHT_M = 0.17
"""Default height on the table of a character that walks [m]."""

ACTOR_HEIGHT_M = 0.15
"""Default height on the table of a character that acts in place [m]."""


ControllerFactory = Callable[[Character, float, RootDelta | None], CharacterController]
"""Makes the controller of a character from it, the scale and the first place on the table."""


def first_suitable(
    character: Character, scale: float, place: RootDelta | None
) -> CharacterController:
    """Make the controller of "tree" for a character: by its plan, walking, or acting in place."""
    if character.plan is not None:
        from cubeling.characters.control.controllers.tree import TreeController

        return TreeController(character, scale, place)
    if WalkController.suits(character):
        return WalkController(character, scale, place)
    from cubeling.characters.control.controllers.in_place import InPlaceController

    return InPlaceController(character, scale, place)


def default_height(character: Character) -> float:
    """Return the default height of a character on the table [m]."""
    return WALKER_HEIGHT_M if WalkController.suits(character) else ACTOR_HEIGHT_M
