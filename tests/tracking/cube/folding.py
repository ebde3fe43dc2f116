"""Paper that folds: where the parts of a net are when every fold is bent by some angle.

The frame of a face has the axes of the paper, with the origin in the middle of the face. It folds
with the face, so what is printed on a face keeps its coordinates.
"""

import math

import numpy as np
from numpy.typing import NDArray

from cubeling.tracking.cube.printing.unfolding import HINGES, SIDE_DIRECTIONS, Tab, Unfolding

Array = NDArray[np.float64]


def cube_from_face(net: Unfolding, face: str, angle: float = math.pi / 2) -> Array:
    """Pose of a face, (4, 4). Right angles make the cube; 0 leaves the paper flat."""
    if face == "front":
        return shift(0, 0, net.edge / 2)
    parent, side = HINGES[face]
    return cube_from_face(net, parent, angle) @ over(net, side, angle, net.edge / 2)


def cube_from_tab(net: Unfolding, tab: Tab) -> Array:
    """Pose of a tab of the folded cube, (4, 4), with the origin in the middle of its fold."""
    return cube_from_face(net, tab.face) @ over(net, tab.side, math.pi / 2, 0.0)


def over(net: Unfolding, side: str, angle: float, beyond: float) -> Array:
    """Pose, in the frame of a face, of a part `beyond` the fold over one of its sides."""
    x, y = SIDE_DIRECTIONS[side]
    half = net.edge / 2
    return shift(x * half, y * half, 0) @ bend(x, y, angle) @ shift(x * beyond, y * beyond, 0)


def shift(x: float, y: float, z: float) -> Array:
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def bend(x: int, y: int, angle: float) -> Array:
    """Rotate the paper's direction (x, y) away from the reader."""
    cosine, sine = math.cos(angle), math.sin(angle)
    matrix = np.eye(4)
    if x:
        matrix[0, 0], matrix[0, 2], matrix[2, 0], matrix[2, 2] = cosine, x * sine, -x * sine, cosine
    else:
        matrix[1, 1], matrix[1, 2], matrix[2, 1], matrix[2, 2] = cosine, y * sine, -y * sine, cosine
    return matrix
