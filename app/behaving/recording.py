"""Blocks played for a file: its frames, its sound, its feedback, and a video of it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cubeling.app.behaving.camera import FollowingCamera
from cubeling.app.behaving.player import BehaviourFrame, BehaviourPlayer
from cubeling.app.pipeline.table.spoken_line import SpokenLine
from cubeling.app.sound import SAMPLE_RATE
from cubeling.app.sound.mixer import FADE_OUT, limit
from cubeling.app.sound.session_sound import SPEECH_GAIN, at_sample_rate
from cubeling.app.speaking.speech_video import (
    AZIMUTH_RAD,
    ELEVATION_RAD,
    put_subtitle,
    sound_blocks,
)
from cubeling.app.speaking.view import View
from cubeling.app.ui.clip_video import write_clip
from cubeling.characters import Character, Clip, Pose, PosedCharacter, SpeechIntent
from cubeling.characters.behaviour import Feedback
from cubeling.characters.motion import rotations, stack

SETTLE_S = 2.0
"""Time before the first frame [s], which is not shown: eyes find the viewer."""

TAIL_S = 1.2
"""Time after the last behaviour [s]: the body comes to rest."""

LONGEST_S = 600.0
"""A recording is cut off there [s]."""


@dataclass(eq=False)
class SpokenPart:
    """A speech, or what was heard of it."""

    line: SpokenLine

    start: float
    """When it begins [s]."""

    heard_until: float
    """The last frame in which it was said [s]."""


@dataclass(eq=False)
class BehaviourRecording:
    """What a character did."""

    clip: Clip
    """Its poses, with the root where it stood."""

    feedback: tuple[Feedback, ...]
    """All feedback of the standard, in the order of time."""

    speeches: dict[str, SpokenPart] = field(default_factory=dict)
    """What was said, by key."""

    def sound(self) -> NDArray[np.float32]:
        """Return what is heard, (n, 2) at `SAMPLE_RATE`."""
        mixed = np.zeros(round(self.clip.duration * SAMPLE_RATE) + 1)
        for speech in self.speeches.values():
            samples = SPEECH_GAIN * at_sample_rate(speech.line)
            end = speech.start + speech.line.utterance.duration
            if speech.heard_until + 1.5 / self.clip.rate < end:
                samples = _cut(samples, speech.heard_until + 1.0 / self.clip.rate - speech.start)
            begin = max(round(speech.start * SAMPLE_RATE), 0)
            part = samples[: max(len(mixed) - begin, 0)]
            mixed[begin : begin + len(part)] += part
        return np.repeat(limit(mixed)[:, None], 2, axis=1).astype(np.float32)


def record_behaviour(
    player: BehaviourPlayer,
    documents: Sequence[str | bytes],
    rate: float,
    *,
    together: bool = False,
    name: str = "behaviour",
) -> BehaviourRecording:
    """Let a character play documents, each when those before it are over.

    Parameters
    ----------
    player
        The character; it has not been used before.
    documents
        BML or FML.
    rate
        Frames a second.
    together
        Whether all blocks arrive at the start, so that their composition counts.
    name
        Name of the clip.
    """
    player.settle(SETTLE_S, rate)
    waiting = list(documents)
    frames: list[BehaviourFrame] = []
    speeches: dict[str, SpokenPart] = {}
    end = math.inf
    while (now := len(frames) / rate) < min(end, LONGEST_S):
        if waiting and (together or player.director.over(now)):
            count = len(waiting) if together else 1
            for document in waiting[:count]:
                player.director.accept(document)
            del waiting[:count]
        frame = player.update(now)
        frames.append(frame)
        _hear(player, frame, speeches)
        if waiting or not player.director.over(now):
            end = math.inf
        elif end == math.inf:
            end = now + TAIL_S
    feedback = tuple(each for frame in frames for each in frame.feedback)
    return BehaviourRecording(_clip(frames, rate, name), feedback, speeches)


def _hear(player: BehaviourPlayer, frame: BehaviourFrame, speeches: dict[str, SpokenPart]) -> None:
    for saying in frame.realized.sayings:
        if saying.key in speeches:
            speeches[saying.key].heard_until = frame.realized.now
            continue
        line = player.line_of(saying)
        if line is not None:
            speeches[saying.key] = SpokenPart(line, saying.start, frame.realized.now)


def write_video(
    path: Path,
    character: Character,
    recording: BehaviourRecording,
    *,
    size: tuple[int, int],
    view: View,
    subtitles: bool,
    blood: float = 0.0,
    codec: str = "auto",
) -> None:
    """Write a recording as a video with sound.

    `blood` is that in the skin of the face, as in `SceneCharacter`; `codec` is as in `VideoFile`.

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
        codec=codec,
    )


def placed_pose(posed: PosedCharacter) -> Pose:
    """Return the pose of a character with its root joint where it stands, in its own metres."""
    placed, pose = posed.table_from_character, posed.pose
    scale = float(placed[1, 1])
    yaw = rotations.about("y", math.atan2(placed[0, 2], placed[2, 2]))
    translations, turns = pose.translations.copy(), pose.rotations.copy()
    translations[0] = rotations.rotate(yaw, translations[0]) + placed[:3, 3] / scale
    turns[0] = rotations.multiply(yaw, turns[0])
    return replace(pose, translations=translations, rotations=turns)


def _clip(frames: Sequence[BehaviourFrame], rate: float, name: str) -> Clip:
    poses = stack([placed_pose(frame.posed) for frame in frames])
    return Clip(name, rate, poses, loop=False, root_motion=True)


def _cut(samples: NDArray[np.float64], seconds: float) -> NDArray[np.float64]:
    """Return a sound that fades out at a time [s]."""
    kept = max(round(seconds * SAMPLE_RATE), 0)
    fading = samples[kept : kept + FADE_OUT]
    return np.concatenate([samples[:kept], fading * np.linspace(1.0, 0.0, len(fading))])
