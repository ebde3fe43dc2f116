"""A picture and a clip of a character, in one call each."""

from collections.abc import Callable, Generator

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.character import Character
from cubeling.characters.motion.clip import Clip
from cubeling.characters.rendering.context import create_context
from cubeling.characters.rendering.portrait import SAMPLED_POSES, Focus, PortraitRenderer
from cubeling.characters.retargeting.lent_motions import with_lent_motions
from cubeling.characters.skeleton.pose import Array, Pose

Image = NDArray[np.uint8]

PICTURE_SIZE = 360, 420
"""Width and height of a picture unless the caller says otherwise [px]."""


def draw_picture(
    character: Character,
    pose: Pose | None = None,
    size: tuple[int, int] = PICTURE_SIZE,
    *,
    azimuth: float = 0.4,
    elevation: float = 0.16,
    focus: Focus = None,
) -> Image:
    """Return a picture of a character on paper, (height, width, 3) uint8 BGR.

    For many pictures, keep one `PortraitRenderer`: to prepare a character takes longer than to draw
    it.

    Parameters
    ----------
    character, pose
        Who is drawn, and how it stands; if None, as `standing_pose` says, with lent motions for a
        character that has none to stand.
    size
        Width and height of the picture [px].
    azimuth, elevation, focus
        As in `PortraitRenderer.portrait`.

    Raises
    ------
    CharacterError
        There is no OpenGL to draw with, or the character has nothing to draw.
    """
    context = create_context()
    renderer = PortraitRenderer(context, size)
    if pose is None:
        character = with_lent_motions(character)
        pose = standing_pose(character)
    try:
        return renderer.portrait(character, pose, azimuth=azimuth, elevation=elevation, focus=focus)
    finally:
        renderer.release()
        context.release()


def draw_clip(
    character: Character,
    clip: Clip,
    size: tuple[int, int] = PICTURE_SIZE,
    *,
    every: int = 1,
    azimuth: float = 0.4,
    elevation: float = 0.16,
    focus: Callable[[Pose, float], tuple[Array, float]] | None = None,
    blood: float = 0.0,
) -> Generator[Image, None, None]:
    """Yield pictures of a character that moves through a clip, (height, width, 3) uint8 BGR.

    Parameters
    ----------
    character, clip
        Who moves, and how: one of `character.clips`, or a clip of its skeleton.
    size
        Width and height of the pictures [px].
    every
        1 draws each frame of the clip, 3 the first of every three: `clip.rate / every` a second.
    azimuth, elevation, blood
        As in `PortraitRenderer.portrait`.
    focus
        Returns what is seen of a pose at a time [s]: a centre (3,) and a radius in the character
        frame [m]; None for the whole clip in every picture.

    Raises
    ------
    CharacterError
        There is no OpenGL to draw with, or the character has nothing to draw.
    """
    sampled = np.linspace(0, len(clip) - 1, SAMPLED_POSES).astype(int).tolist()
    extent = [clip.poses[number] for number in sampled] if focus is None else []
    context = create_context()
    renderer = PortraitRenderer(context, size)
    try:
        for number in range(0, len(clip), every):
            pose = clip.poses[number]
            yield renderer.portrait(
                character,
                pose,
                azimuth=azimuth,
                elevation=elevation,
                focus=None if focus is None else focus(pose, number / clip.rate),
                extent=extent,
                blood=blood,
            )
    finally:  # also when the caller stops in the middle
        renderer.release()
        context.release()


def standing_pose(character: Character) -> Pose:
    """Return the first pose of a character's idle clip, or its rest pose.

    Without an idle clip, the first pose of the first clip is used if the rest pose has its hips on
    the ground, as motion capture may have.
    """
    clips = character.clips
    idle = next((name for name in clips if name.lower().endswith("idle")), None)
    if idle is None and character.bounds[0, 1] < -0.2 * character.height:
        idle = next(iter(clips), None)
    return character.skeleton.rest if idle is None else clips[idle].sample(0.0)
