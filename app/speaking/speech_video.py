"""The video of a speech: the poses of a character that says it, and its sound."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cubeling.affect import Emotion
from cubeling.app.pipeline.table.spoken_line import SpokenLine
from cubeling.app.sound import SAMPLE_RATE
from cubeling.app.sound.session_sound import at_sample_rate
from cubeling.app.speaking.view import View
from cubeling.app.ui.canvas import PICTURE_HEIGHT
from cubeling.app.ui.cards.subtitles import draw_subtitle, subtitle, subtitle_place
from cubeling.app.ui.clip_video import Focus, write_clip
from cubeling.characters import (
    Animator,
    Character,
    CharacterCommand,
    Clip,
    Pose,
    RootDelta,
    SpeechIntent,
)
from cubeling.characters.motion import stack
from cubeling.characters.rendering import (
    CharacterExtent,
    joints_below,
)

LEAD_S, TAIL_S = 0.6, 1.2
"""Time before and after the speech [s]: hands get ready, and come to rest."""

SETTLE_S = 2.0
"""Time before that [s], which is not shown: eyes find the viewer, and the body its posture."""

VIEWER = np.array([0.1, 0.16, 0.7])
"""Whom the speaker looks at, in the table frame [m]."""

BODY_MARGIN, FACE_MARGIN = 0.52, 0.62
"""Radius of what is seen, as a part of the character's size, and of that of its head."""

CHEST, REACH = 0.7, 0.37
"""For the hands of a person: height of the middle, and radius, as parts of the body's height."""

AZIMUTH_RAD, ELEVATION_RAD = 0.22, 0.08
"""Where the camera is: to the left of straight in front, and above."""

NAME_LETTERS = 40
"""Letters of a text that name its clip."""


@dataclass(frozen=True)
class Direction:
    """What a speech expresses beside its words, and its random choices."""

    emotion: Emotion | None = None
    """What the speaker feels; None for nothing in particular."""

    seed: int = 0
    """Of blinks, sway and the choice between gestures."""


def speech_clip(character: Character, line: SpokenLine, direction: Direction, rate: float) -> Clip:
    """Return the motion of a character that says a line, `LEAD_S` after its start.

    `rate` is the number of frames a second.
    """
    animator = Animator(character, place=RootDelta(), seed=direction.seed)
    speech = SpeechIntent(line.utterance, LEAD_S, line.profile)
    count = round((LEAD_S + line.utterance.duration + TAIL_S) * rate) + 1
    settling = round(SETTLE_S * rate)
    poses = [
        animator.update(
            CharacterCommand(number / rate, gaze=VIEWER, emotion=direction.emotion, speech=speech)
        ).pose
        for number in range(-settling, count)
    ][settling:]
    name = line.utterance.text[:NAME_LETTERS] or "speech"
    return Clip(name, rate, stack(poses), loop=False)


def sound_track(line: SpokenLine) -> Callable[[int], NDArray[np.float32]]:
    """Return what gives the stereo sound of a spoken line block by block, (count, 2)."""
    lead = np.zeros(round(LEAD_S * SAMPLE_RATE))
    samples = np.concatenate([lead, at_sample_rate(line)]).astype(np.float32)
    return sound_blocks(samples[:, None])


def sound_blocks(samples: NDArray[np.float32]) -> Callable[[int], NDArray[np.float32]]:
    """Return what gives sound, (n, 1) or (n, 2), in stereo blocks, and silence at the end."""
    at = 0

    def next_block(count: int) -> NDArray[np.float32]:
        nonlocal at
        block = np.zeros((count, 2), np.float32)
        part = samples[at : at + count]
        block[: len(part)] = part
        at += count
        return block

    return next_block


def put_subtitle(picture: NDArray[np.uint8], speech: SpeechIntent, now: float) -> None:
    """Write what is being said at a time [s] over a picture."""
    said = subtitle(speech, now)
    if said:
        height, width = picture.shape[:2]
        scale = height / PICTURE_HEIGHT
        canvas = draw_subtitle(said, width / scale, scale)
        canvas.card(*subtitle_place(canvas.size, width / scale)).blend_over(picture)


def write_video(
    path: Path,
    character: Character,
    clip: Clip,
    line: SpokenLine,
    *,
    size: tuple[int, int],
    view: View,
    subtitles: bool,
    blood: float = 0.0,
    codec: str = "auto",
) -> None:
    """Write the clip of a speech as a video with sound.

    `blood` is that in the skin of the face, as in `SceneCharacter`; `codec` is as in `VideoFile`.

    Raises
    ------
    AppError
        The file cannot be written.
    """
    seen = focus_of(character, clip.poses[0], view)
    speech = SpeechIntent(line.utterance, LEAD_S)

    def subtitle_over(picture: NDArray[np.uint8], now: float) -> None:
        if now >= LEAD_S:
            put_subtitle(picture, speech, now)

    write_clip(
        path,
        character,
        clip,
        size,
        azimuth=AZIMUTH_RAD,
        elevation=ELEVATION_RAD,
        focus=lambda _pose, _now: seen,
        blood=blood,
        sound=sound_track(line),
        draw_over=subtitle_over if subtitles else None,
        codec=codec,
    )


def focus_of(character: Character, pose: Pose, view: View) -> Focus:
    """Return what is seen of a character: a centre (3,) and a radius in its frame [m]."""
    joints = joints_below(character, "head") if view == "face" else None
    points = CharacterExtent(character).points(pose, joints)
    middle = (points.min(0) + points.max(0)) / 2
    if view == "hands" and character.anatomy.kind == "humanoid":
        middle[1] = CHEST * character.height
        return middle, REACH * character.height
    margin = FACE_MARGIN if view == "face" else BODY_MARGIN
    return middle, margin * float(np.ptp(points, axis=0).max())
