"""Where a camera stands so that all of something fills its picture."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from characters.errors import CharacterError
from characters.rendering.geometry.morph_mixer import MorphMixer
from characters.rendering.geometry.vertices import CharacterVertices
from characters.rendering.scene import Drawable
from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Array, Pose

FIELD = math.radians(24.0)
"""Of view, along the picture's shorter side: long lenses flatter."""

MARGIN = 0.07
"""Share of the picture that stays free on each side."""

_NEAREST = 0.04  # the camera keeps this distance [m]: the lens cuts off what is nearer


@dataclass(frozen=True)
class Framing:
    """A camera that looks straight ahead and a little down, before what is on the table."""

    size: tuple[int, int]
    """Of the picture, (width, height) [px]."""

    camera_from_table: Array
    """(4, 4) [m], as OpenCV's cameras: x right, y down, z forward."""

    @classmethod
    def around(
        cls, points: Array, above: float, size: tuple[int, int], margin: float = MARGIN
    ) -> Self:
        """Return the camera nearest to some points that sees all of them.

        Parameters
        ----------
        points
            In the table frame, (n, 3).
        above
            How far the camera looks down [rad].
        size
            Of the picture, (width, height) [px].
        margin
            Share of the picture that stays free on each side.
        """
        sine, cosine = math.sin(above), math.cos(above)
        turn = np.array([[1.0, 0.0, 0.0], [0.0, -cosine, sine], [0.0, -sine, -cosine]])
        seen = points @ turn.T
        slopes = math.tan(FIELD / 2) * np.array(size) / min(size) * (1.0 - 2.0 * margin)
        # A point is in the picture if |x - eye x| ≤ slope · (z - eye z), and so for y: each side of
        # it is a plane through the eye, and the one furthest out holds the points in.
        across, ahead = seen[:, :2], seen[:, 2:]
        low = (across + ahead * slopes).min(axis=0)
        high = (across - ahead * slopes).max(axis=0)
        back = max(((high - low) / (2.0 * slopes)).max(), _NEAREST - ahead.min())
        camera_from_table = np.eye(4)
        camera_from_table[:3, :3] = turn
        camera_from_table[:3, 3] = *(-(low + high) / 2.0), back
        return cls(size, camera_from_table)

    @property
    def matrix(self) -> Array:
        """Pinhole matrix, (3, 3) [px]."""
        width, height = self.size
        focal = min(self.size) / 2 / math.tan(FIELD / 2)
        return np.array(
            [[focal, 0.0, (width - 1) / 2], [0.0, focal, (height - 1) / 2], [0.0, 0.0, 1.0]]
        )


class Extent:
    """How far a character reaches in any pose, by the vertices that stand out.

    Parameters
    ----------
    character
        Whose meshes are looked at.
    """

    def __init__(self, character: Drawable) -> None:
        self._character = character
        self._geometry = CharacterVertices.of(character.meshes)
        self._outline = self._geometry.extreme()
        strongest = self._geometry.weights[self._outline].argmax(axis=1)
        rows = self._geometry.joints[self._outline, strongest]
        self._owners = rows % len(character.skeleton)
        self._still = self._geometry.shape_records[: self._geometry.moved]

    def points(self, pose: Pose, part: NDArray[np.bool_] | None = None) -> Array:
        """Return points that enclose a character in a pose, (n, 3), in the character frame.

        `part` (joints,) says of which joints; all without.
        """
        geometry, joints = self._geometry, pose.globals(self._character.skeleton)
        shape = geometry.positions.copy()
        morphing = MorphMixer(self._still, geometry.morphs, self._character.morphs)
        mixed = morphing.mix(pose.morphs)
        if mixed is not None:
            shape[: geometry.moved] = mixed[:, :3]
        chosen = self._outline if part is None else self._outline[part[self._owners]]
        return geometry.skinned(geometry.palette(joints), chosen, shape[chosen])


def joints_of(character: Drawable, part: str) -> NDArray[np.bool_]:
    """Return which joints move a part of a body and what hangs on it, (joints,).

    Parameters
    ----------
    character
        Whose joints are looked at.
    part
        A part of `Anatomy`, such as "head" or "leftHand".

    Raises
    ------
    CharacterError
        If no joint was recognised as that part, or it has no skin of its own.
    """
    skeleton = character.skeleton
    anatomy = getattr(character, "anatomy", None) or Anatomy.guess(skeleton)
    joint = anatomy.joint(part)
    if joint is None:
        raise CharacterError(
            f"no joint was recognised as {part!r}; say which one it is in a .toml beside the file"
        )
    below = np.zeros(len(skeleton), bool)
    below[joint] = True
    for child, parent in enumerate(skeleton.parents):
        below[child] |= parent >= 0 and below[parent]
    return below
