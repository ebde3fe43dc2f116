"""What `cubeling robot try` asks a robot to do, and how its telemetry answers."""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from cubeling.affect import WORD_PLACES, Emotion
from cubeling.robot import Robot, RobotError, Telemetry, joint_move

EMOTION_TOLERANCE = 0.05
"""Largest distance from a requested emotion at which it counts as shown."""

ANGLE_TOLERANCE_RAD = math.radians(3)
"""Largest distance from a requested angle at which it counts as reached [rad]."""

MOVE_DURATION_S = 1.0
"""Time for the way of a joint [s]."""

_UNITS = {"deg": math.radians(1), "°": math.radians(1), "rad": 1.0}
_JOINT = re.compile(r"(?P<name>.+)=(?P<angle>[-+]?[0-9]*\.?[0-9]+) ?(?P<unit>deg|°|rad)")


@dataclass(frozen=True)
class RobotTrial:
    """Something that a robot is asked to do, and how its telemetry answers."""

    name: str
    """The mood, emotion, motion, sound or joint."""

    start: Callable[[], None]
    """Asks the robot for it, and returns at once."""

    shown: Callable[[Telemetry], bool]
    """Whether the robot reports that it shows or plays it."""

    emotion: Emotion | None
    """The emotion that the robot acknowledges; None for a motion, a sound or a joint."""

    answer: str = "shown"
    """The word for what `shown` tells."""


def trials_of(robot: Robot, words: Sequence[str], joints: Sequence[str]) -> list[RobotTrial]:
    """Return what to try: moods by their words, joints as "neck=10deg", or all that it has."""
    catalogue = robot.catalogue
    moods = catalogue.moods
    for word in words:
        if word not in moods:
            known = ", ".join(moods) or "it has none"
            raise RobotError(f"{catalogue.name} has no mood {word!r}: {known}")
    if joints:
        turned = [_joint_trial(robot, text) for text in joints]
        return [*(_mood_trial(robot, word) for word in words), *turned]
    if moods:
        return [_mood_trial(robot, word) for word in words or (*moods, moods[0])]
    played = [_play_trial(robot, name) for name in catalogue.motions + catalogue.sounds]
    return [*(_emotion_trial(robot, word) for word in ("happy", "angry", "neutral")), *played]


def _mood_trial(robot: Robot, word: str) -> RobotTrial:
    emotion = Emotion(*WORD_PLACES.get(word, (0.0, 0.0)), word)
    return RobotTrial(
        word, lambda: robot.express(emotion), lambda telemetry: telemetry.label == word, emotion
    )


def _emotion_trial(robot: Robot, word: str) -> RobotTrial:
    """Return the trial of the emotion of a word, for a robot that has no moods."""
    emotion = Emotion(*WORD_PLACES[word])

    def shown(telemetry: Telemetry) -> bool:
        observed = telemetry.observed
        return observed is not None and (
            math.dist((observed.valence, observed.arousal), (emotion.valence, emotion.arousal))
            < EMOTION_TOLERANCE
        )

    return RobotTrial(word, lambda: robot.express(emotion), shown, emotion)


def _play_trial(robot: Robot, name: str) -> RobotTrial:
    return RobotTrial(
        name,
        lambda: robot.play(name),
        lambda telemetry: name in (telemetry.motion, telemetry.sound),
        None,
        "played",
    )


def _joint_trial(robot: Robot, text: str) -> RobotTrial:
    """Return the trial of a joint; raises RobotError for one that the robot cannot turn so."""
    found = _JOINT.fullmatch(text)
    if found is None:
        raise RobotError(
            f"a joint is given as NAME=ANGLE, 'neck up=10deg' or 'neck up=0.2rad', not {text!r}"
        )
    name, angle = found["name"], float(found["angle"]) * _UNITS[found["unit"]]
    if robot.moves_joints:  # or else `move` says so at the first of them
        joint_move(robot.catalogue, {name: angle}, MOVE_DURATION_S)

    def shown(telemetry: Telemetry) -> bool:
        reached = abs(telemetry.joints.get(name, math.inf) - angle) < ANGLE_TOLERANCE_RAD
        return reached and name in telemetry.held

    return RobotTrial(
        text, lambda: robot.move({name: angle}, MOVE_DURATION_S), shown, None, "reached"
    )
