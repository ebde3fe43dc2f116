"""How hard a place on the table is to reach for a character."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.ik.reaching.upper_body import UpperBody
from cubeling.characters.skeleton.pose import Skeleton


class Reacher(Protocol):
    """A character, as far as it reaches."""

    @property
    def skeleton(self) -> Skeleton:
        """The whole skeleton, not only what reaches."""
        ...

    @property
    def upper_body(self) -> UpperBody:
        """Its torso and arms."""
        ...


def reach_effort(
    character: Reacher,
    table_from_character: NDArray[np.float64],
    target: NDArray[np.float64],
) -> float:
    """Return the effort to bring a palm to a point while standing.

    Parameters
    ----------
    table_from_character
        Where it stands, (4, 4), as in `PosedCharacter`.
    target
        The point, (3,) in the table frame [m].

    Returns
    -------
    float
        0 within the arm's reach … 1 at the limit of torso and arm; beyond it 1 + what is missing
        in parts of the arm's length. Infinite without arms.
    """
    placed = table_from_character
    offset = np.asarray(target, float) - placed[:3, 3]
    place = offset @ placed[:3, :3] / float(placed[1, 1]) ** 2
    return character.upper_body.effort(character.skeleton.rest, place)
