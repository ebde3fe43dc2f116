"""How hard a place on the table is to reach for a character."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.ik.reaching.upper_body import UpperBody
from cubeling.characters.ik.reaching.whole_body import WholeBody
from cubeling.characters.skeleton.pose import Skeleton
from cubeling.characters.smoothing import smoothstep

GAIN_RANGE = (1.5, 2.2)
"""Effort of torso and arm up to which it counts what the whole body does, and from which on that
does not help."""


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

    @property
    def whole_body(self) -> WholeBody | None:
        """All of it, if it reaches with that."""
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
        0 within the arm's reach … 1 at the limit of torso and arm, and where the whole body gets
        there; beyond it 1 + what is missing in parts of the arm's length. Infinite without arms.
    """
    placed = table_from_character
    offset = np.asarray(target, float) - placed[:3, 3]
    place = offset @ placed[:3, :3] / float(placed[1, 1]) ** 2
    rest, whole = character.skeleton.rest, character.whole_body
    effort = character.upper_body.effort(rest, place)
    least, most = GAIN_RANGE
    if whole is None or not 1.0 < effort < most:
        return effort
    alone = smoothstep(min(max((effort - least) / (most - least), 0.0), 1.0))
    return alone * effort + (1.0 - alone) * (1.0 + whole.shortfall(rest, place))
