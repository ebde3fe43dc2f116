"""What a character did in a recorded session, and the emotions that followed from it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cubeling.affect import Personality
from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.app.scenarios import find_scenario, scenario_names
from cubeling.app.scenarios.follow import gait
from cubeling.app.scenarios.mood import MoodController
from cubeling.app.session import SessionFile, SessionInfo
from cubeling.app.session.encoding import MESSAGE_TYPES
from cubeling.characters import CharacterCommand
from cubeling.tracking import CubeControls

Array = NDArray[np.float64]

MOOD_TOPICS = ("/cube/controls", "/character/command", "/robot/emotion")
"""The channels that are read, in the order of a frame."""


@dataclass(frozen=True)
class EmotionTrack:
    """An emotion over time, one sample for each frame."""

    personality: str
    """Name of the personality that has it; "" for the recorded emotion."""

    times: Array
    """(n,) [s]."""

    emotion: Array
    """Valence and arousal, (n, 2)."""

    labels: tuple[str, ...]
    """The label of each sample."""


@dataclass(frozen=True)
class MoodHistory:
    """Everything in a session that concerns moods."""

    name: str
    """Name of the session's file."""

    info: SessionInfo

    recorded: EmotionTrack
    """The emotion that character and robot were asked to show."""

    controls: tuple[CubeControls, ...]
    """The cube's controls in each frame."""

    commands: tuple[CharacterCommand, ...]
    """The character's command in each frame."""

    start_over_times: frozenset[float]
    """When the player started over [s]."""

    @property
    def actions(self) -> tuple[str, ...]:
        """The character's action in each frame, named as its icon; "" while it is not visible."""
        return tuple(_action(command) for command in self.commands)

    @property
    def has_intensity(self) -> bool:
        """Whether the actions of the session's scenario have an intensity."""
        name = self.info.options.scenario  # that of a package may be uninstalled
        return name in scenario_names() and find_scenario(name).has_intensity


def _action(command: CharacterCommand) -> str:
    if not command.visible:
        return ""
    return gait(command.speed) if command.activity == "move" else command.activity


def read_history(path: Path, *, salvage: bool = False) -> MoodHistory:
    """Read a session; with `salvage`, the intact part of one that was cut off.

    Raises
    ------
    AppError
        The file is not a session, was cut off, or has no emotions.
    """
    with SessionFile(path, salvage=salvage) as session:
        return _history(session)


def _history(session: SessionFile) -> MoodHistory:
    path, info = session.path, session.info
    frames: list[dict[str, Any]] = []
    frame: dict[str, Any] = {}
    for topic, _, message in session.decode_messages(
        {topic: MESSAGE_TYPES[topic] for topic in MOOD_TOPICS}
    ):
        frame[topic] = message
        if topic == "/robot/emotion":  # the last of these channels in a frame
            if len(frame) == len(MOOD_TOPICS):
                frames.append(frame)
            frame = {}
    if len(frames) < 2:
        raise AppError(f"the session '{path}' has no emotions to show")
    return MoodHistory(
        path.name,
        info,
        _track("", [each["/robot/emotion"] for each in frames]),
        tuple(each["/cube/controls"] for each in frames),
        tuple(each["/character/command"] for each in frames),
        session.start_overs,
    )


def replay_with(history: MoodHistory, personality: Personality) -> EmotionTrack:
    """Return the emotion that another personality would have had in a session."""
    mood = MoodController(personality)
    targets = []
    for controls, command in zip(history.controls, history.commands, strict=True):
        if controls.timestamp in history.start_over_times:
            mood.reset()
        action, weight, speed = "idle", 0.0, 0.0
        if command.visible:
            action, speed = command.activity, command.speed
            weight = command.weight if history.has_intensity else 1.0
        targets.append(mood.update(controls, action, weight, speed))
    return _track(personality.name, targets)


def _track(personality: str, targets: list[EmotionTarget]) -> EmotionTrack:
    return EmotionTrack(
        personality,
        np.array([target.timestamp for target in targets]),
        np.array([(target.emotion.valence, target.emotion.arousal) for target in targets]),
        tuple(target.emotion.label for target in targets),
    )
