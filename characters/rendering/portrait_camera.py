"""Camera positions from which a character fills the picture."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.rendering.geometry.morph_mixer import MorphMixer
from cubeling.characters.rendering.geometry.vertices import CharacterVertices
from cubeling.characters.rendering.scene import Drawable
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Pose

FIELD_OF_VIEW_RAD = math.radians(24.0)
"""Along the picture's shorter side; portraits look best with a long lens."""

MARGIN_SHARE = 0.07
"""Share of the picture that stays free on each side."""

MIN_DISTANCE_M = 0.04
"""Distance of the camera from the nearest point [m]; the near plane is closer."""


@dataclass(frozen=True)
class PortraitCamera:
    """A camera in front of a character, which looks straight ahead and a little down."""

    size: tuple[int, int]
    """Of the picture, (width, height) [px]."""

    camera_from_table: Array
    """(4, 4) [m], as OpenCV's cameras: x right, y down, z forward."""

    @classmethod
    def around(
        cls, points: Array, elevation: float, size: tuple[int, int], margin: float = MARGIN_SHARE
    ) -> Self:
        """Return the nearest camera that sees all of some points (n, 3) of the table frame.

        It looks down by the angle `elevation` [rad]; `size` is (width, height) [px]; `margin` is
        the share of the picture that stays free on each side.
        """
        sine, cosine = math.sin(elevation), math.cos(elevation)
        rotation = np.array([[1.0, 0.0, 0.0], [0.0, -cosine, sine], [0.0, -sine, -cosine]])
        rotated = points @ rotation.T
        slopes = math.tan(FIELD_OF_VIEW_RAD / 2) * np.array(size) / min(size) * (1.0 - 2.0 * margin)
        # A point is in the picture if |x - eye x| ≤ slope · (z - eye z), and the same for y: each
        # side of the picture is a plane through the eye, and the outermost points define it.
        xy, z = rotated[:, :2], rotated[:, 2:]
        low = (xy + z * slopes).min(axis=0)
        high = (xy - z * slopes).max(axis=0)
        distance = max(((high - low) / (2.0 * slopes)).max(), MIN_DISTANCE_M - z.min())
        camera_from_table = np.eye(4)
        camera_from_table[:3, :3] = rotation
        camera_from_table[:3, 3] = *(-(low + high) / 2.0), distance
        return cls(size, camera_from_table)

    @property
    def matrix(self) -> Array:
        """Pinhole matrix, (3, 3) [px]."""
        width, height = self.size
        focal = min(self.size) / 2 / math.tan(FIELD_OF_VIEW_RAD / 2)
        return np.array(
            [[focal, 0.0, (width - 1) / 2], [0.0, focal, (height - 1) / 2], [0.0, 0.0, 1.0]]
        )


class CharacterExtent:
    """The extent of a character in any pose, by its extreme vertices."""

    def __init__(self, character: Drawable) -> None:
        self._character = character
        self._vertices = CharacterVertices.of(character.meshes)
        self._extreme = self._vertices.extreme()
        self._owners = self._vertices.owners[self._extreme] % len(character.skeleton)
        neutral = self._vertices.shape_records[: self._vertices.moved]
        self._mixer = MorphMixer(neutral, self._vertices.morphs, character.morphs)
        self._positions = self._vertices.positions.copy()  # with the morphs of the last pose

    def points(self, pose: Pose, part: NDArray[np.bool_] | None = None) -> Array:
        """Return points that enclose a character in a pose, (n, 3), in the character frame.

        `part` (joints,) selects joints; without, all are included.
        """
        vertices, joints = self._vertices, pose.globals(self._character.skeleton)
        mixed = self._mixer.mix(pose.morphs)
        if mixed is not None:
            self._positions[: vertices.moved] = mixed[:, :3]
        selected = self._extreme if part is None else self._extreme[part[self._owners]]
        return vertices.skin(vertices.palette(joints), selected, self._positions[selected])


def joints_below(character: Drawable, part: str) -> NDArray[np.bool_]:
    """Return a mask of the joints of a body part and of all joints below it, (joints,).

    `part` is one of `Anatomy`, such as "head" or "leftHand".

    Raises
    ------
    CharacterError
        No joint was recognised as that part.
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
