"""Where the hand of a character touches its body: forehead, chin, hip, the other hand."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

DIRECTION_COSINE = 0.92
"""Cosine of the angle within which vertices are in a direction."""

SURFACE_QUANTILE = 0.9
"""Share of these vertices that are inside the surface: hair and clothes may be outside."""

OTHER_HAND = "other hand"
"""The contact that moves by itself: the hands meet."""


class Contact(NamedTuple):
    """A place on the surface of a body part, as seen from the middle of the part."""

    part: str
    """One of `BODY_PARTS`; "own" and "other" stand for the side of the hand."""

    outward: float
    """To the side of the hand."""

    up: float
    """Along +y; only the direction of the three numbers counts."""

    forward: float
    """Along +z; only the direction of the three numbers counts."""


CONTACTS: Mapping[str, Contact] = {
    "top of head": Contact("head", 0.3, 1.0, 0.1),
    "forehead": Contact("head", 0.15, 0.35, 1.0),
    "brow": Contact("head", 0.5, 0.25, 0.9),
    "temple": Contact("head", 1.0, 0.25, 0.5),
    "eye": Contact("head", 0.4, 0.0, 1.0),
    "ear": Contact("head", 1.0, -0.05, -0.1),
    "cheek": Contact("head", 0.75, -0.45, 0.75),
    "mouth": Contact("head", 0.1, -0.5, 1.0),
    "chin": Contact("head", 0.15, -0.9, 0.75),
    "nape": Contact("head", 0.4, -0.3, -1.0),
    "chest": Contact("chest", 0.15, 0.3, 1.0),
    "heart": Contact("chest", -0.35, 0.35, 1.0),
    "belly": Contact("spine", 0.2, 0.0, 1.0),
    "waist": Contact("spine", 1.0, -0.2, 0.3),
    "hip": Contact("hips", 1.0, 0.45, 0.15),
    "thigh": Contact("ownUpperLeg", 0.3, 0.3, 1.0),
    "other shoulder": Contact("otherUpperArm", 0.2, 0.8, 0.7),
    "other arm": Contact("otherLowerArm", 0.0, 0.3, 1.0),
    OTHER_HAND: Contact("", 0.0, 0.0, 0.0),
}
"""What a `Place` may touch."""


class ContactPoints:
    """Places on the surface of a character in a posture, for either hand.

    Directions are those of the character in the posture. Without a mesh, places are at joints.
    """

    def __init__(
        self, skeleton: Skeleton, anatomy: Anatomy, meshes: Sequence[Mesh], posture: Pose
    ) -> None:
        self._anatomy = anatomy
        self._meshes = meshes
        self._frames = posture.globals(skeleton)
        self._points: dict[tuple[str, bool], Array] = {}

    def place(self, contact: str, left: bool, character_from_joint: Array) -> Array | None:
        """Return where a contact of a hand is in a pose, (3,) in the character frame [m].

        None if the body has no such part.
        """
        joint = self._anatomy.joint(_part(CONTACTS[contact].part, left))
        if joint is None:
            return None
        if (contact, left) not in self._points:
            self._points[contact, left] = self._point(CONTACTS[contact], left, joint)
        place: Array = (character_from_joint[joint] @ self._points[contact, left])[:3]
        return place

    def _point(self, contact: Contact, left: bool, joint: int) -> Array:
        """Return where a contact is in the frame of its joint, (4,)."""
        vertices = _vertices_of(joint, self._meshes, self._frames)
        towards = np.array([contact.outward, contact.up, contact.forward])
        towards[0] *= 1.0 if left else -1.0
        frame = self._frames[joint]
        point: Array = np.linalg.pinv(frame) @ [*_surface(vertices, frame[:3, 3], towards), 1.0]
        return point


def _part(part: str, left: bool) -> str:
    own, other = ("left", "right") if left else ("right", "left")
    return part.replace("own", own).replace("other", other)


def _vertices_of(joint: int, meshes: Sequence[Mesh], frames: Array) -> Array:
    """Return the vertices that a joint moves most, in a pose of its frames, (n, 3)."""
    places = [np.zeros((0, 3))]
    for mesh in meshes:
        column = mesh.weights.argmax(axis=1)[:, None]
        own = np.take_along_axis(mesh.joints, column, axis=1)[:, 0] == joint
        posed = frames[joint] @ mesh.inverse_bind[joint]
        places.append(mesh.positions[own] @ posed[:3, :3].T + posed[:3, 3])
    return np.concatenate(places)


def _surface(vertices: Array, joint: Array, towards: Array) -> Array:
    """Return where a line from the middle of a body part leaves it."""
    if len(vertices) == 0:
        return joint
    low, high = vertices.min(0), vertices.max(0)
    middle, half = (low + high) / 2, np.maximum((high - low) / 2, 1e-6)
    ray = towards * half  # the direction is that on a sphere, stretched to the part's shape
    ray /= np.linalg.norm(ray)
    offsets = vertices - middle
    along = offsets @ ray
    near = along > DIRECTION_COSINE * np.linalg.norm(offsets, axis=1)
    depth = np.quantile(along[near], SURFACE_QUANTILE) if near.any() else float(along.max())
    place: Array = middle + ray * depth
    return place
