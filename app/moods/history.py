"""What a character did in a recorded session, and what was felt of it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from affect import Personality
from app.errors import AppError
from app.pipeline.scenario import EmotionTarget
from app.scenarios.follow import gait
from app.scenarios.mood import MoodController
from app.session import SessionInfo, messages, session_info, start_over_times
from app.session.encoding import decode
from characters import CharacterCommand
from tracking import CubeControls

Array = NDArray[np.float64]

KINDS: dict[str, type[Any]] = {
    "/cube/controls": CubeControls,
    "/character/command": CharacterCommand,
    "/robot/emotion": EmotionTarget,
}


@dataclass(frozen=True)
class Felt:
    """A feeling over time."""

    who: str
    """Whose it is: the name of a personality, or "" for what was recorded."""

    times: Array
    """When, (n,) [s]."""

    emotion: Array
    """Valence and arousal, (n, 2)."""

    labels: tuple[str, ...]
    """The words for it, n of them."""


@dataclass(frozen=True)
class History:
    """All of a session that has to do with moods."""

    name: str
    """Name of the session's file."""

    about: SessionInfo
    """What the session says of itself."""

    felt: Felt
    """What character and robot were asked to feel."""

    controls: tuple[CubeControls, ...]
    """What the hand did, frame by frame."""

    commands: tuple[CharacterCommand, ...]
    """What the character was asked to do, frame by frame."""

    started_over: frozenset[float]
    """When the player started over [s]."""

    @property
    def actions(self) -> tuple[str, ...]:
        """What the character did in each frame, as an icon names it; "" while out of sight."""
        return tuple(_action(command) for command in self.commands)

    @property
    def weights(self) -> Array:
        """How intensely, (n,), −1…1."""
        return np.array([command.weight for command in self.commands])


def _action(command: CharacterCommand) -> str:
    if not command.visible:
        return ""
    return gait(command.speed) if command.activity == "move" else command.activity


def read_history(path: Path, *, salvage: bool = False) -> History:
    """Read a session.

    Parameters
    ----------
    path
        The .mcap file.
    salvage
        Whether to take what is whole of a session that was cut off.

    Raises
    ------
    AppError
        It is no session, was cut off, or holds no feelings.
    """
    info = session_info(path, salvage=salvage)
    frames: list[dict[str, Any]] = []
    frame: dict[str, Any] = {}
    for topic, _, data in messages(path, *KINDS):
        try:
            frame[topic] = decode(KINDS[topic], data)
        except ValueError as error:
            raise AppError(f"cannot read the session '{path}': {topic} is {error}") from error
        if topic == "/robot/emotion":  # the last of a frame that is taken here
            if len(frame) == len(KINDS):
                frames.append(frame)
            frame = {}
    if len(frames) < 2:
        raise AppError(f"the session '{path}' holds no feelings to show")
    targets: list[EmotionTarget] = [each["/robot/emotion"] for each in frames]
    return History(
        path.name,
        info,
        _felt("", targets),
        tuple(each["/cube/controls"] for each in frames),
        tuple(each["/character/command"] for each in frames),
        start_over_times(path),
    )


def felt_by(history: History, personality: Personality) -> Felt:
    """Return what another personality would have felt of what was done in a session."""
    mood = MoodController(personality)
    # Only the companion's knob says how intensely; elsewhere an action is always a whole one.
    intense = history.about.scenario == "companion"
    targets = []
    for controls, command in zip(history.controls, history.commands, strict=True):
        if controls.timestamp in history.started_over:
            mood.reset()
        action, weight, speed = "idle", 0.0, 0.0
        if command.visible:
            action, speed = command.activity, command.speed
            weight = command.weight if intense else 1.0
        targets.append(mood.update(controls, action, weight, speed))
    return _felt(personality.name, targets)


def _felt(who: str, targets: list[EmotionTarget]) -> Felt:
    return Felt(
        who,
        np.array([target.timestamp for target in targets]),
        np.array([(target.emotion.valence, target.emotion.arousal) for target in targets]),
        tuple(target.emotion.label for target in targets),
    )
