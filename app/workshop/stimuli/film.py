"""A film of a study."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cubeling.app.speaking.speech_video import focus_of
from cubeling.app.speaking.view import View
from cubeling.app.ui.clip_video import write_clip
from cubeling.characters import Character, Clip
from cubeling.characters.rendering import standing_pose

ELEVATION_RAD = 0.08


@dataclass(frozen=True)
class FilmLook:
    """How the films of a study are drawn: all alike, by a camera that stays."""

    view: View
    """What is seen of the character."""

    size: tuple[int, int]
    """Width and height [px]."""

    rate: float = 25.0
    """Frames a second of all films."""


def write_film(
    path: Path,
    body: Character,
    clip: Clip,
    look: FilmLook,
    sound: Callable[[int], NDArray[np.float32]] | None = None,
) -> None:
    """Write a clip as a film; raises AppError."""
    seen = focus_of(body, standing_pose(body), look.view)
    write_clip(
        path,
        body,
        clip,
        look.size,
        azimuth=0.0,
        elevation=ELEVATION_RAD,
        focus=lambda _pose, _now: seen,
        sound=sound,
    )
