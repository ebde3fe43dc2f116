"""Characters alone in a picture: a portrait, a turntable, a strip of frames side by side."""

import math
from collections.abc import Sequence

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.control.command import PosedCharacter
from characters.model.character import Character
from characters.motion.clip import Clip
from characters.rendering.framing import Extent, Framing, joints_of
from characters.rendering.scene import SceneCharacter, View
from characters.rendering.stage import Stage
from characters.skeleton import rotations
from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Array, Pose

Image = NDArray[np.uint8]
Focus = str | tuple[Array, float] | None

PAPER = 236, 240, 242
"""The backdrop, BGR."""

_TALL = 0.17  # height on the table [m], which light and shadow are made for
_FACE = "face"
_FRINGE = (
    0.06  # share of the picture over which shadows fade to paper at its sides; within its margin
)
_LOOKS = 24  # poses of a clip that are looked at to see how far it reaches
_STRAYS = 0.6  # of its height: a clip that goes further over the ground is followed
_TURNED = 0.5  # [rad]: a clip that looks so far elsewhere is turned to the front


class PortraitRenderer:
    """Takes portraits of one character after the other.

    The character turns and the camera stays, so that light and shadow fall the same way in every
    picture. Pictures of one turntable or strip have one camera, which sees all of them whole.

    Parameters
    ----------
    context
        From `create_context`; the studio does not release it.
    size
        Of one picture, (width, height) [px].
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int] = (360, 420)) -> None:
        self.size = size
        self._stage = Stage(context, size)
        self._fringe = _fringe(size)
        self._extents: dict[int, tuple[Character, Extent]] = {}

    def portrait(
        self,
        character: Character,
        pose: Pose | None = None,
        *,
        around: float = 0.4,
        above: float = 0.16,
        focus: Focus = None,
        reach: Clip | Sequence[Pose] = (),
    ) -> Image:
        """Return a picture of a character, (height, width, 3) BGR.

        Parameters
        ----------
        character, pose
            Who, and how; at rest without.
        around, above
            Where the camera stands, to the character's left of straight in front and upwards [rad].
        focus
            What fills the picture: "face", a part of `Anatomy` such as "leftHand", or a centre (3,)
            and a radius in the character frame [m]; the whole character without.
        reach
            A clip or poses that fit into the picture as well, so that pictures of them can be
            compared.

        Raises
        ------
        CharacterError
            If the character has no such part.
        """
        pose = character.skeleton.rest if pose is None else pose
        framed = [pose, *(_some_of(reach) if isinstance(reach, Clip) else reach)]
        place = _place(character, around)
        framing = self._framing(character, [(each, place) for each in framed], above, focus)
        return self._taken(character, pose, place, framing)

    def turntable(
        self,
        character: Character,
        pose: Pose | None = None,
        count: int = 8,
        *,
        above: float = 0.16,
        focus: Focus = None,
    ) -> Image:
        """Return a character from `count` sides, side by side, from the front to its left."""
        pose = character.skeleton.rest if pose is None else pose
        ((_, back),) = _followed([pose], character)
        places = [_place(character, math.tau * turn / count) @ back for turn in range(count)]
        framing = self._framing(character, [(pose, place) for place in places], above, focus)
        return side_by_side([self._taken(character, pose, place, framing) for place in places])

    def strip(
        self,
        character: Character,
        clip: "str | Clip",
        count: int = 8,
        *,
        around: float = 0.7,
        above: float = 0.16,
        focus: Focus = None,
    ) -> Image:
        """Return `count` frames of a clip, by its name or itself, side by side.

        A character that goes over the ground is followed, and one that mostly looks elsewhere is
        turned to the front.
        """
        clip = character.clips[clip] if isinstance(clip, str) else clip
        times = np.linspace(0.0, clip.duration, count, endpoint=not clip.loop)
        shown = [clip.sample(float(time)) for time in times]
        place = _place(character, around)
        framed = [
            (pose, place @ back) for pose, back in _followed([*shown, *_some_of(clip)], character)
        ]
        framing = self._framing(character, framed, above, focus)
        return side_by_side(
            [self._taken(character, *each, framing) for each in framed[: len(shown)]]
        )

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        self._stage.release()
        self._extents.clear()

    def _framing(
        self,
        character: Character,
        poses: Sequence[tuple[Pose, Array]],
        above: float,
        focus: Focus,
    ) -> Framing:
        """Return one camera for a character in several poses and places (4, 4)."""
        extent = self._extent(character)
        seen = []
        for pose, place in poses:
            if isinstance(focus, tuple):
                points = focus[0] + focus[1] * np.concatenate([np.eye(3), -np.eye(3)])
            else:
                points = _points(extent, character, pose, focus)
            seen.append(points @ place[:3, :3].T + place[:3, 3])
        return Framing.around(np.concatenate(seen), above, self.size)

    def _extent(self, character: Character) -> Extent:
        if id(character) not in self._extents:
            self._extents[id(character)] = character, Extent(character)
        return self._extents[id(character)][1]

    def _taken(self, character: Character, pose: Pose, place: Array, framing: Framing) -> Image:
        width, height = self.size
        paper = np.full((height, width, 3), PAPER, np.uint8)
        view = View(paper, framing.matrix, np.zeros(0), framing.camera_from_table)
        posed = PosedCharacter(pose, place, True, "", 0.0, 0.0, 0.0, 0.0)
        picture = self._stage.draw(view, [SceneCharacter(character, posed)])
        return np.asarray(
            cv2.blendLinear(picture, paper, self._fringe, 1.0 - self._fringe), np.uint8
        )


def side_by_side(pictures: Sequence[Image], columns: int = 8) -> Image:
    """Return pictures of one size in rows of at most `columns`; empty places stay paper."""
    blank = np.full_like(pictures[0], PAPER)
    rows = [list(pictures[at : at + columns]) for at in range(0, len(pictures), columns)]
    if len(rows) > 1:
        rows[-1] += [blank] * (columns - len(rows[-1]))
    return np.concatenate([np.concatenate(row, axis=1) for row in rows], axis=0)


def _points(extent: Extent, character: Character, pose: Pose, focus: str | None) -> Array:
    """Return what of a character fills the picture, (n, 3) in the character frame."""
    if focus is None:
        return extent.points(pose)
    return extent.points(pose, joints_of(character, "head" if focus == _FACE else focus))


def _place(character: Character, around: float) -> Array:
    """Return where a character stands, turned so that the camera is `around` to its left."""
    low, high = character.bounds
    scale = _TALL / max(character.height, 0.5 * float((high - low).max()), 1e-6)
    place = np.eye(4)
    place[:3, :3] = scale * rotations.to_matrix(rotations.about("y", -around))
    return place


def _some_of(clip: Clip) -> list[Pose]:
    """Return poses of a clip, evenly spread over it."""
    count = min(_LOOKS, len(clip))
    return [clip.sample(float(time)) for time in np.linspace(0.0, clip.duration, count)]


def _followed(poses: Sequence[Pose], character: Character) -> list[tuple[Pose, Array]]:
    """Return poses with the way back (4, 4) of each, where a body goes far or looks elsewhere."""
    joints = np.stack([pose.globals(character.skeleton) for pose in poses])[..., :3, 3]
    back = rotations.to_matrix(rotations.about("y", -_mean_heading(joints, character.anatomy)))
    over = joints[:, character.anatomy.joint("hips") or 0] * [1.0, 0.0, 1.0]
    far = np.abs(over).max() > _STRAYS * character.height
    backs = np.tile(np.eye(4), (len(poses), 1, 1))
    backs[:, :3, :3] = back
    backs[:, :3, 3] = -over @ back.T if far else 0.0
    return list(zip(poses, backs, strict=True))


def _mean_heading(joints: Array, anatomy: Anatomy) -> float:
    """Return where a body looks on average over places of its joints (n, joints, 3) [rad].

    0 is forward, and is returned for small angles too: who sways is not turned back.
    """
    left, right = anatomy.joint("leftUpperLeg"), anatomy.joint("rightUpperLeg")
    if left is None or right is None:
        return 0.0
    x, _, z = (joints[:, left] - joints[:, right]).mean(axis=0)
    heading = math.atan2(-z, x)
    return heading if abs(heading) > _TURNED else 0.0


def _fringe(size: tuple[int, int]) -> NDArray[np.float32]:
    """Return how much of a picture stays, 0…1 (height, width): paper at its sides and its foot."""
    columns, rows = (np.arange(side) + 0.5 for side in size)
    across = np.minimum(columns, columns[::-1]) / (_FRINGE * size[0])
    up = rows[::-1] / (_FRINGE * size[1])
    shares = np.clip(np.minimum(across[None], up[:, None]), 0.0, 1.0)
    return np.asarray(shares**2 * (3.0 - 2.0 * shares), np.float32)
