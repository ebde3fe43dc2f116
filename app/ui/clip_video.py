"""A clip of a character as a video."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cubeling.app.ui.output_formats import AUTO_CODEC
from cubeling.app.ui.video_file import VideoFile
from cubeling.characters import Character, Clip, Pose
from cubeling.characters.rendering import PortraitRenderer, create_context

Focus = tuple[NDArray[np.float64], float]
"""What fills the picture: a centre (3,) and a radius in the character frame [m]."""

_POSES_SEEN = 24
"""Poses of a clip that fit into the picture where nothing says what is seen."""


def write_clip(
    path: Path,
    character: Character,
    clip: Clip,
    size: tuple[int, int],
    *,
    azimuth: float = 0.4,
    elevation: float = 0.16,
    focus: Callable[[Pose, float], Focus] | None = None,
    blood: float = 0.0,
    sound: Callable[[int], NDArray[np.float32]] | None = None,
    draw_over: Callable[[NDArray[np.uint8], float], None] | None = None,
    codec: str = AUTO_CODEC,
) -> None:
    """Write a clip as a video.

    Parameters
    ----------
    path, size
        The file, and width and height of its pictures [px].
    character, clip
        Who moves, and how.
    azimuth, elevation, blood
        As in `PortraitRenderer.portrait`.
    focus
        Returns what is seen of a pose at a time [s]; None for the whole clip in every picture.
    sound
        What is heard, as `VideoFile` takes it; None for a silent video.
    draw_over
        Draws over a picture of a time [s], such as subtitles.
    codec
        What encodes the pictures, as in `VideoFile`.

    Raises
    ------
    AppError
        The file cannot be written.
    """
    sampled = np.linspace(0, len(clip) - 1, _POSES_SEEN).astype(int).tolist()
    extent = [clip.poses[number] for number in sampled] if focus is None else []
    context = create_context()
    renderer = PortraitRenderer(context, size)
    try:
        with VideoFile(path, size, clip.rate, sound, codec) as video:
            for number in range(len(clip)):
                pose, now = clip.poses[number], number / clip.rate
                picture = renderer.portrait(
                    character,
                    pose,
                    azimuth=azimuth,
                    elevation=elevation,
                    focus=None if focus is None else focus(pose, now),
                    extent=extent,
                    blood=blood,
                )
                if draw_over is not None:
                    draw_over(picture, now)
                video.write(picture, now)
    finally:
        renderer.release()
        context.release()
