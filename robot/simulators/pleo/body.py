"""The body of the simulated Pleo: joints, motions, sounds and battery."""

from collections import deque
from dataclasses import dataclass
from typing import Literal, NamedTuple
from zlib import crc32

import numpy as np

from cubeling.affect.words import WORD_PLACES
from cubeling.robot.drivers.pleo.joints import JOINTS, PleoJoint

MOTION_LENGTH_RANGE_S = (2.0, 5.0)
"""Shortest and longest motion [s]; the name of a motion determines its length."""

BATTERY_LIFE_S = 3600.0
"""Time from full to empty [s]."""

MAX_PLAYED = 1000
"""Number of played motions and sounds that are kept."""


class Played(NamedTuple):
    """A motion or a sound that was played."""

    time: float
    """Its start by the clock of the body [s]."""

    kind: Literal["motion", "sound"]

    name: str
    """Its file, as the console names it."""


@dataclass
class _JointMove:
    """A move of a joint."""

    start: float = 0.0
    began: float = 0.0
    goal: float = 0.0

    def at(self, joint: PleoJoint, now: float) -> float:
        reach = joint.speed * max(now - self.began, 0.0)
        way = self.goal - self.start
        return self.start + min(max(way, -reach), reach)


class PleoBody:
    """Joints, loudspeaker and battery, with its first charge, from 0 to 1, at its start [s]."""

    def __init__(self, battery: float, now: float) -> None:
        self.now = now
        """Its own time [s]; it never runs backwards."""
        self.played: deque[Played] = deque(maxlen=MAX_PLAYED)
        """The motions and sounds that were played."""
        self.motion_speed = 100
        """Speed of motions [%]."""
        self.motion: str | None = None
        """The file of the motion that is playing, or None."""
        self._motion_ends = 0.0
        self.mood = "neutral"
        """The mood that it shows: the last one after which a motion was named."""
        self._moves = [_JointMove() for _ in JOINTS]
        self._battery = battery + now / BATTERY_LIFE_S

    @property
    def battery(self) -> float:
        """From 0, empty, to 1, full; it is charged before it is empty."""
        return max(0.1, (self._battery - self.now / BATTERY_LIFE_S) % 1.0)

    @property
    def angles(self) -> tuple[float, ...]:
        """Angles of the joints [°]."""
        return tuple(
            move.at(joint, self.now) for move, joint in zip(self._moves, JOINTS, strict=True)
        )

    def advance(self, now: float) -> None:
        """Advance to time `now` [s]."""
        self.now = max(self.now, now)
        if self.motion is not None and self.now >= self._motion_ends:
            self.motion = None

    def move(self, joint: int, degrees: float) -> float:
        """Start a move of a joint; return when it ends [s]."""
        start = self._moves[joint].at(JOINTS[joint], self.now)
        goal = JOINTS[joint].nearest(degrees)
        self._moves[joint] = _JointMove(start, self.now, goal)
        return self.now + JOINTS[joint].time(start, goal)

    def neutral(self) -> None:
        """Move every joint to zero and end the motion."""
        self.motion, self.mood = None, "neutral"
        for number in range(len(JOINTS)):
            self.move(number, 0)

    def play_motion(self, name: str) -> None:
        """Start a motion; it ends any other."""
        self.played.append(Played(self.now, "motion", name))
        random = np.random.default_rng(crc32(name.encode()))
        self.motion = name
        length = random.uniform(*MOTION_LENGTH_RANGE_S)
        self._motion_ends = self.now + length * 100 / self.motion_speed
        for number, joint in enumerate(JOINTS):
            self.move(number, random.uniform(joint.low, joint.high))
        word = name.partition(":")[2].partition(".")[0].casefold()
        if word in WORD_PLACES:
            self.mood = word

    def play_sound(self, name: str) -> None:
        """Start a sound; it ends any other."""
        self.played.append(Played(self.now, "sound", name))
