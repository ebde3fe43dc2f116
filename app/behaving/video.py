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
from cubeling.app.ui.video_file import VideoFile
from cubeling.characters import Character, SpeechIntent
from cubeling.characters.rendering import PortraitRenderer, create_context


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
    clip = recording.clip
    context = create_context()
    renderer = PortraitRenderer(context, size)
    camera = FollowingCamera(character, view)
    try:
        with VideoFile(path, size, clip.rate, sound_blocks(recording.sound())) as video:
            for number in range(len(clip)):
                now = number / clip.rate
                pose = clip.poses[number]
                picture = renderer.portrait(
                    character,
                    pose,
                    azimuth=AZIMUTH_RAD,
                    elevation=ELEVATION_RAD,
                    focus=camera.focus(pose, now),
                    blood=blood,
                )
                if subtitles:
                    _subtitle(picture, recording, now)
                video.write(picture, now)
    finally:
        renderer.release()
        context.release()


def _subtitle(picture: NDArray[np.uint8], recording: BehaviourRecording, now: float) -> None:
    for speech in recording.speeches.values():
        if speech.start <= now <= speech.heard_until:
            put_subtitle(picture, SpeechIntent(speech.line.utterance, speech.start), now)
