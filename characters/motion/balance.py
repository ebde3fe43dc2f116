"""How a body holds itself over its feet: the lean of its trunk, and hips beyond the support."""

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.pose import Array

FAR_BEYOND_HEIGHTS = 0.1
"""Hips this far beyond the feet are held by nothing but speed [body heights]."""


MAX_UNLEANED_M_S2 = 1.0
"""How fast a bend that is added may turn the velocity of a body that does not lean into it [m/s²]:
it would have to by 6°."""

GRAVITY_M_S2 = 9.81


def trunk_lean(positions: Array, anatomy: Anatomy) -> Array:
    """Return how far the trunk leans forward and to the left, (frames, 2) [rad].

    The trunk is the line from the hips to the neck, else to the head; a body without them does not
    lean.

    Parameters
    ----------
    positions
        Of all joints, in the character's axes: +y up, +z forward, (frames, joints, 3).
    anatomy
        Which joint is which body part.
    """
    hips = anatomy.joint("hips")
    top = next((anatomy.joint(part) for part in ("neck", "head") if part in anatomy.joints), None)
    if hips is None or top is None:
        return np.zeros((len(positions), 2))
    trunk = positions[:, top] - positions[:, hips]
    lean: Array = np.arctan2(trunk[:, [2, 0]], trunk[:, 1:2])
    return lean


def hips_beyond_feet(
    positions: Array, anatomy: Anatomy, acceleration: Array | None = None
) -> Array:
    """Return how far the hips are beyond the feet on the ground plane, (frames,) [m].

    The support is the convex hull of ankles and toes of both feet, also while they are in the air.
    0 above it.

    Parameters
    ----------
    positions, anatomy
        As for `trunk_lean`.
    acceleration
        Of the body ahead, (frames,) [m/s²]. Who speeds up leans ahead of his feet, and who brakes
        leans back: the hips are then moved to where they would push straight down (the zero-moment
        point of M. Vukobratović, 1972, with the mass in the hips).
    """
    hips = anatomy.joint("hips")
    parts = [side + part for side in SIDES for part in ("Foot", "Toes")]
    feet = [anatomy.joints[part] for part in parts if part in anatomy.joints]
    if hips is None or not feet:
        return np.zeros(len(positions))
    # About the hips, whose distance from the hull is then that of the origin.
    around = positions[:, feet][..., [0, 2]] - positions[:, None, hips][..., [0, 2]]
    if acceleration is not None:
        around[..., 1] += (positions[:, hips, 1] * acceleration / GRAVITY_M_S2)[:, None]
    corners = [around[:, number] for number in range(len(feet))]
    beyond: Array = np.min([np.linalg.norm(corner, axis=-1) for corner in corners], axis=0)
    for a, b in combinations(corners, 2):
        beyond = np.minimum(beyond, _distance_to_segment(a, b))
    for triangle in combinations(corners, 3):
        beyond[_is_inside(*triangle)] = 0.0
    return beyond


def _distance_to_segment(a: Array, b: Array) -> Array:
    """Return the distance of the origin to segments from a to b (n, 2)."""
    along = b - a
    u = -(a * along).sum(-1) / np.maximum(np.square(along).sum(-1), 1e-12)
    distance: Array = np.linalg.norm(a + np.clip(u, 0.0, 1.0)[:, None] * along, axis=-1)
    return distance


def _is_inside(a: Array, b: Array, c: Array) -> NDArray[np.bool_]:
    """Return in which triangles (n, 2) the origin is; not in those without area."""
    turns = np.stack([p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0] for p, q in ((a, b), (b, c), (c, a))])
    inside: NDArray[np.bool_] = np.all(turns > 0.0, axis=0) | np.all(turns < 0.0, axis=0)
    return inside
