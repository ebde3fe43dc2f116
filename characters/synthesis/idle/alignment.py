"""Recordings brought to one place: where the hips are, and where the body faces.

Source: Egges 2006, section 3.1.1 (S2). What is aligned is the first frame; the height stays as it
was recorded.
"""

import numpy as np

from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.choices import Alignment


def align(places: Array, turns: Array, how: Alignment) -> tuple[Array, Array]:
    """Return hips (frames, 3), and their orientations (frames, 4), with the first frame aligned.

    >>> at = np.array([[1.0, 0.9, 2.0], [1.0, 0.8, 3.0]])
    >>> facing = rotations.about("y", np.array([0.5, 0.5]))
    >>> moved, turned = align(at, facing, "turn")
    >>> moved.round(3).tolist()
    [[0.0, 0.9, 0.0], [-0.479, 0.8, 0.878]]
    """
    if how == "none":
        return places, turns
    ahead = rotations.rotate(turns[0], np.array([0.0, 0.0, 1.0]))
    back = rotations.about("y", -np.arctan2(ahead[0], ahead[2]))
    if how == "place":
        back = rotations.IDENTITY
    # Printed, the path is turned by the whole orientation, which would tip it over.
    moved = rotations.rotate(back, places - places[0] * [1.0, 0.0, 1.0])
    moved[:, 1] = places[:, 1]
    if how == "full":
        back = rotations.conjugate(turns[0])
    return moved, rotations.multiply(back, turns)
