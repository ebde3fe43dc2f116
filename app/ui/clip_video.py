"""A clip of a character as a video."""

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cubeling.app.ui.output_formats import AUTO_CODEC
from cubeling.app.ui.video_file import VideoFile
from cubeling.characters import Character, Clip, Pose
from cubeling.characters.rendering import draw_clip

Focus = tuple[NDArray[np.float64], float]
"""What fills the picture: a centre (3,) and a radius in the character frame [m]."""


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
    azimuth, elevation, focus, blood
        As in `draw_clip`.
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
    pictures = draw_clip(
        character, clip, size, azimuth=azimuth, elevation=elevation, focus=focus, blood=blood
    )
    with closing(pictures), VideoFile(path, size, clip.rate, sound, codec) as video:
        for number, picture in enumerate(pictures):
            now = number / clip.rate
            if draw_over is not None:
                draw_over(picture, now)
            video.write(picture, now)
