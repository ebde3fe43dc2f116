"""Pictures of one character: a portrait, a turntable, a strip of frames side by side."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.control.command import PosedCharacter
from cubeling.characters.model.character import Character
from cubeling.characters.motion.clip import Clip
from cubeling.characters.rendering.portrait_camera import (
    CharacterExtent,
    PortraitCamera,
    joints_below,
)
from cubeling.characters.rendering.quality import FULL
from cubeling.characters.rendering.scene import CameraView, SceneCharacter
from cubeling.characters.rendering.stage import Stage
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.smoothing import smoothstep

Image = NDArray[np.uint8]
Focus = str | tuple[Array, float] | None

PAPER_BGR = 236, 240, 242
"""Colour of the backdrop."""

HEIGHT_M = 0.17
"""Height of the character on the table [m], for which light and shadow are made."""

FADE_SHARE = 0.06
"""Share of the picture over which shadows fade to paper at its sides; less than the margin."""

SAMPLED_POSES = 24
"""Poses of a clip that are sampled for its extent."""

MAX_DRIFT = 0.6
"""A clip that moves further over the ground, in character heights, is followed by the camera."""

MAX_HEADING_RAD = 0.5
"""A clip whose mean heading is further from the front is turned to the front [rad]."""


class PortraitRenderer:
    """Draws portraits of characters.

    The character turns and the camera stays, so that light and shadow have the same direction in
    every picture. The pictures of one turntable or strip share one camera that sees all of them.

    Parameters
    ----------
    context
        From `create_context`; the renderer does not release it.
    size
        Of one picture, (width, height) [px].
    drawn
        Called after each picture, to show progress.
    levels
        Whether small characters are drawn with fewer triangles: these take longer to find than a
        few pictures to draw.
    """

    def __init__(
        self,
        context: moderngl.Context,
        size: tuple[int, int] = (360, 420),
        drawn: Callable[[], None] | None = None,
        *,
        levels: bool = True,
    ) -> None:
        self.size = size
        self._drawn = drawn
        self._stage = Stage(context, size)
        if not levels:
            self._stage.quality = replace(FULL, max_error_px=0.0)
        self._fade = _fade_mask(size)
        self._extents: dict[int, tuple[Character, CharacterExtent]] = {}

    def portrait(
        self,
        character: Character,
        pose: Pose | None = None,
        *,
        azimuth: float = 0.4,
        elevation: float = 0.16,
        focus: Focus = None,
        extent: Clip | Sequence[Pose] = (),
        wrinkles: bool = True,
        blood: float = 0.0,
    ) -> Image:
        """Return a picture of a character, (height, width, 3) BGR.

        Parameters
        ----------
        character, pose
            The character and its pose; its rest pose if None.
        azimuth, elevation
            Direction of the camera: to the character's left from straight in front, and up [rad].
        focus
            What fills the picture: "face", a part of `Anatomy` such as "leftHand", or a centre (3,)
            and a radius in the character frame [m]; the whole character if None.
        extent
            A clip or poses that fit into the picture as well, so that pictures of them can be
            compared.
        wrinkles, blood
            As in `SceneCharacter`.

        Raises
        ------
        CharacterError
            The character has no such part.
        """
        pose = character.skeleton.rest if pose is None else pose
        framed = [pose, *(_sample(extent) if isinstance(extent, Clip) else extent)]
        place = _place(character, azimuth)
        camera = self._camera(character, [(each, place) for each in framed], elevation, focus)
        return self._draw(character, pose, place, camera, wrinkles, blood)

    def portraits(
        self,
        character: Character,
        poses: Sequence[Pose],
        *,
        azimuth: float = 0.4,
        elevation: float = 0.16,
        focus: Focus = None,
    ) -> list[Image]:
        """Return a picture of a character in each pose, by one camera that sees all of them."""
        place = _place(character, azimuth)
        camera = self._camera(character, [(pose, place) for pose in poses], elevation, focus)
        return [self._draw(character, pose, place, camera) for pose in poses]

    def turntable(
        self,
        character: Character,
        pose: Pose | None = None,
        count: int = 8,
        *,
        elevation: float = 0.16,
        focus: Focus = None,
    ) -> Image:
        """Return a character from `count` sides, side by side, from the front to its left."""
        pose = character.skeleton.rest if pose is None else pose
        ((_, back),) = _center([pose], character)
        places = [_place(character, math.tau * turn / count) @ back for turn in range(count)]
        camera = self._camera(character, [(pose, place) for place in places], elevation, focus)
        return side_by_side([self._draw(character, pose, place, camera) for place in places])

    def strip(
        self,
        character: Character,
        clip: "str | Clip",
        count: int = 8,
        *,
        azimuth: float = 0.7,
        elevation: float = 0.16,
        focus: Focus = None,
    ) -> Image:
        """Return `count` frames of a clip, or of the clip of that name, side by side.

        The camera follows a character that moves over the ground, and a character that mostly looks
        elsewhere is turned to the front.
        """
        clip = character.clips[clip] if isinstance(clip, str) else clip
        times = np.linspace(0.0, clip.duration, count, endpoint=not clip.loop)
        shown = [clip.sample(float(time)) for time in times]
        place = _place(character, azimuth)
        framed = [
            (pose, place @ back) for pose, back in _center([*shown, *_sample(clip)], character)
        ]
        camera = self._camera(character, framed, elevation, focus)
        return side_by_side([self._draw(character, *each, camera) for each in framed[: len(shown)]])

    def release(self) -> None:
        """Release the buffers; a second call does nothing."""
        self._stage.release()
        self._extents.clear()

    def _camera(
        self,
        character: Character,
        poses: Sequence[tuple[Pose, Array]],
        elevation: float,
        focus: Focus,
    ) -> PortraitCamera:
        """Return one camera for a character in several poses and places (4, 4)."""
        extent = self._extent(character)
        framed = []
        for pose, place in poses:
            if isinstance(focus, tuple):
                points = focus[0] + focus[1] * np.concatenate([np.eye(3), -np.eye(3)])
            else:
                points = _focused_points(extent, character, pose, focus)
            framed.append(points @ place[:3, :3].T + place[:3, 3])
        return PortraitCamera.around(np.concatenate(framed), elevation, self.size)

    def _extent(self, character: Character) -> CharacterExtent:
        if id(character) not in self._extents:
            self._extents[id(character)] = character, CharacterExtent(character)
        return self._extents[id(character)][1]

    def _draw(
        self,
        character: Character,
        pose: Pose,
        place: Array,
        camera: PortraitCamera,
        wrinkles: bool = True,
        blood: float = 0.0,
    ) -> Image:
        width, height = self.size
        paper = np.full((height, width, 3), PAPER_BGR, np.uint8)
        view = CameraView(paper, camera.matrix, np.zeros(0), camera.camera_from_table)
        posed = PosedCharacter(pose, place, True, "", 0.0, 0.0, 0.0, 0.0)
        picture = self._stage.draw(view, [SceneCharacter(character, posed, wrinkles, blood)])
        faded = np.asarray(cv2.blendLinear(picture, paper, self._fade, 1.0 - self._fade), np.uint8)
        if self._drawn is not None:
            self._drawn()
        return faded


def side_by_side(pictures: Sequence[Image], columns: int = 8) -> Image:
    """Return pictures of one size in rows of at most `columns`; empty cells are paper."""
    blank = np.full_like(pictures[0], PAPER_BGR)
    rows = [list(pictures[at : at + columns]) for at in range(0, len(pictures), columns)]
    if len(rows) > 1:
        rows[-1] += [blank] * (columns - len(rows[-1]))
    return np.concatenate([np.concatenate(row, axis=1) for row in rows], axis=0)


def _focused_points(
    extent: CharacterExtent, character: Character, pose: Pose, focus: str | None
) -> Array:
    """Return points around the focused part of a character, (n, 3) in the character frame."""
    if focus is None:
        return extent.points(pose)
    return extent.points(pose, joints_below(character, "head" if focus == "face" else focus))


def _place(character: Character, azimuth: float) -> Array:
    """Return `table_from_character`, turned so that the camera is `azimuth` to its left."""
    low, high = character.bounds
    scale = HEIGHT_M / max(character.height, 0.5 * float((high - low).max()), 1e-6)
    place = np.eye(4)
    place[:3, :3] = scale * rotations.to_matrix(rotations.about("y", -azimuth))
    return place


def _sample(clip: Clip) -> list[Pose]:
    """Return evenly spaced poses of a clip."""
    count = min(SAMPLED_POSES, len(clip))
    return [clip.sample(float(time)) for time in np.linspace(0.0, clip.duration, count)]


def _center(poses: Sequence[Pose], character: Character) -> list[tuple[Pose, Array]]:
    """Return poses, each with the transform (4, 4) back to the centre and to the front."""
    joints = np.stack([pose.globals(character.skeleton) for pose in poses])[..., :3, 3]
    rotation = rotations.to_matrix(rotations.about("y", -_mean_heading(joints, character.anatomy)))
    drift = joints[:, character.anatomy.joint("hips") or 0] * [1.0, 0.0, 1.0]
    far = np.abs(drift).max() > MAX_DRIFT * character.height
    backs = np.tile(np.eye(4), (len(poses), 1, 1))
    backs[:, :3, :3] = rotation
    backs[:, :3, 3] = -drift @ rotation.T if far else 0.0
    return list(zip(poses, backs, strict=True))


def _mean_heading(joints: Array, anatomy: Anatomy) -> float:
    """Return the mean heading of a body from its joint positions (n, joints, 3) [rad].

    It is 0 for headings below `MAX_HEADING_RAD`, so that a swaying character is not turned.
    """
    left, right = anatomy.joint("leftUpperLeg"), anatomy.joint("rightUpperLeg")
    if left is None or right is None:
        return 0.0
    x, _, z = (joints[:, left] - joints[:, right]).mean(axis=0)
    heading = math.atan2(-z, x)
    return heading if abs(heading) > MAX_HEADING_RAD else 0.0


def _fade_mask(size: tuple[int, int]) -> NDArray[np.float32]:
    """Return the picture's opacity, 0…1 (height, width): it fades at the sides and below."""
    columns, rows = (np.arange(side) + 0.5 for side in size)
    from_side = np.minimum(columns, columns[::-1]) / (FADE_SHARE * size[0])
    from_bottom = rows[::-1] / (FADE_SHARE * size[1])
    share = np.clip(np.minimum(from_side[None], from_bottom[:, None]), 0.0, 1.0)
    return np.asarray(smoothstep(share), np.float32)
