"""Where the hand of a character touches its body: forehead, chin, hip, the other hand."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from characters.model.mesh import Mesh
from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Array, Pose, Skeleton

CONE = 0.92
"""Cosine of the angle within which vertices are in a direction."""

QUANTILE = 0.9
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
    """Along +y."""

    forward: float
    """Along +z."""


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


@dataclass(frozen=True, eq=False)
class BodySurface:
    """Places on the surface of a character, for either hand."""

    joints: Mapping[tuple[str, bool], int]
    """The joint that carries each contact, of the left hand if true."""

    points: Mapping[tuple[str, bool], Array]
    """Where it is, (3,) in the frame of its joint [m]."""

    @staticmethod
    def of(
        skeleton: Skeleton, anatomy: Anatomy, meshes: Sequence[Mesh], pose: Pose
    ) -> "BodySurface":
        """Return the contacts of a character, with directions as in an upright pose.

        Without a mesh they are at the joints.
        """
        frames = pose.globals(skeleton)
        owned = _vertices_by_joint(meshes, frames)
        joints, points = {}, {}
        for name, contact in CONTACTS.items():
            for left in (False, True):
                joint = anatomy.joint(_part(contact.part, left))
                if joint is None:
                    continue
                side = 1.0 if left else -1.0
                towards = np.array([side * contact.outward, contact.up, contact.forward])
                place = _surface(owned[joint], frames[joint, :3, 3], towards)
                joints[name, left] = joint
                points[name, left] = (np.linalg.inv(frames[joint]) @ [*place, 1.0])[:3]
        return BodySurface(joints, points)

    def place(self, contact: str, left: bool, character_from_joint: Array) -> Array | None:
        """Return where a contact is, (3,) in the character frame [m]; None if it has none."""
        joint = self.joints.get((contact, left))
        if joint is None:
            return None
        frame = character_from_joint[joint]
        place: Array = frame[:3, :3] @ self.points[contact, left] + frame[:3, 3]
        return place


def _part(part: str, left: bool) -> str:
    own, other = ("left", "right") if left else ("right", "left")
    return part.replace("own", own).replace("other", other)


def _vertices_by_joint(meshes: Sequence[Mesh], frames: Array) -> list[Array]:
    """Return the vertices that each joint moves most, in a pose of its frames, (n, 3) each."""
    places, strongest = [np.zeros((0, 3))], [np.zeros(0, int)]
    for mesh in meshes:
        column = mesh.weights.argmax(axis=1)[:, None]
        joint = np.take_along_axis(mesh.joints, column, axis=1)[:, 0].astype(int)
        posed = (frames @ mesh.inverse_bind)[joint]
        places.append(np.einsum("nij,nj->ni", posed[:, :3, :3], mesh.positions) + posed[:, :3, 3])
        strongest.append(joint)
    number, place = np.concatenate(strongest), np.concatenate(places)
    return [place[number == joint] for joint in range(len(frames))]


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
    near = along > CONE * np.linalg.norm(offsets, axis=1)
    depth = np.quantile(along[near], QUANTILE) if near.any() else float(along.max())
    place: Array = middle + ray * depth
    return place
