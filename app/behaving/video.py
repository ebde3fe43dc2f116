"""A video of a performance of blocks, with sound."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cubeling.app.behaving.camera import FollowingCamera
from cubeling.app.behaving.recording import BehaviourRecording
from cubeling.app.speaking.performance import (
    AZIMUTH_RAD,
    ELEVATION_RAD,
    put_subtitle,
    sound_blocks,
)
from cubeling.app.speaking.view import View
from cubeling.app.ui.clip_video import write_clip
from cubeling.characters import Character, SpeechIntent


def write_video(
    path: Path,
    character: Character,
    recording: BehaviourRecording,
    *,
    size: tuple[int, int],
    view: View,
    subtitles: bool,
    blood: float = 0.0,
) -> None:
    """Write a performance as a video with sound.

    `blood` is that in the skin of the face, as in `SceneCharacter`.

    Raises
    ------
    AppError
        The file cannot be written.
    """

    def subtitle_over(picture: NDArray[np.uint8], now: float) -> None:
        for speech in recording.speeches.values():
            if speech.start <= now <= speech.heard_until:
                put_subtitle(picture, SpeechIntent(speech.line.utterance, speech.start), now)

    write_clip(
        path,
        character,
        recording.clip,
        size,
        azimuth=AZIMUTH_RAD,
        elevation=ELEVATION_RAD,
        focus=FollowingCamera(character, view).focus,
        blood=blood,
        sound=sound_blocks(recording.sound()),
        draw_over=subtitle_over if subtitles else None,
    )
