"""A video of a performance of blocks, with sound."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from app.behaving.camera import FollowingCamera
from app.behaving.recording import BehaviourRecording
from app.speaking.performance import AZIMUTH_RAD, ELEVATION_RAD, View
from app.ui.canvas import PICTURE_HEIGHT
from app.ui.subtitles import draw_subtitle, subtitle
from app.ui.video_file import VideoFile
from characters import Character
from characters.control.command import SpeechIntent
from characters.rendering import create_context
from characters.rendering.portrait import PortraitRenderer


def write_video(
    path: Path,
    character: Character,
    recording: BehaviourRecording,
    *,
    size: tuple[int, int],
    view: View,
    subtitles: bool,
) -> None:
    """Write a performance as a video with sound.

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
        with VideoFile(path, size, clip.rate, _blocks(recording.sound())) as video:
            for number in range(len(clip)):
                now = number / clip.rate
                pose = clip.poses[number]
                picture = renderer.portrait(
                    character,
                    pose,
                    azimuth=AZIMUTH_RAD,
                    elevation=ELEVATION_RAD,
                    focus=camera.focus(pose, now),
                )
                if subtitles:
                    _subtitle(picture, recording, now)
                video.write(picture, now)
    finally:
        renderer.release()
        context.release()


def _blocks(samples: NDArray[np.float32]) -> Callable[[int], NDArray[np.float32]]:
    """Return what gives stereo sound block by block, (count, 2), and silence at the end."""
    at = 0

    def following(count: int) -> NDArray[np.float32]:
        nonlocal at
        block = np.zeros((count, 2), np.float32)
        part = samples[at : at + count]
        block[: len(part)] = part
        at += count
        return block

    return following


def _subtitle(picture: NDArray[np.uint8], recording: BehaviourRecording, now: float) -> None:
    height, width = picture.shape[:2]
    scale = height / PICTURE_HEIGHT
    for speech in recording.speeches.values():
        if speech.start <= now <= speech.heard_until:
            said = subtitle(SpeechIntent(speech.line.utterance, speech.start), now)
            if said:
                draw_subtitle(said, width / scale, scale, beside=0.0).blend_over(picture)
