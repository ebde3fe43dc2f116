"""The body of the simulated Pleo: joints that take their time, motions and sounds that end."""

from collections import deque
from dataclasses import dataclass
from typing import Literal, NamedTuple
from zlib import crc32

import numpy as np

from affect.words import PLACES
from robot.drivers.pleo.joints import JOINTS, Joint

MOTION_LASTS = (2.0, 5.0)
"""A motion's file lasts between these [s], the same one always as long."""

SOUND_LASTS = 1.5
"""A sound lasts so long [s]."""

BATTERY_LIFE = 3600.0
"""A full battery lasts so long [s]."""

REMEMBERED = 1000
"""Only so many things that were played are remembered, the last ones."""


class Played(NamedTuple):
    """Something that the body was told to play."""

    time: float
    """When it began [s], by the body's own clock."""

    kind: Literal["motion", "sound"]
    """What it is."""

    name: str
    """Its file."""


@dataclass
class _Way:
    """Where a joint comes from and goes to."""

    start: float = 0.0
    began: float = 0.0
    goal: float = 0.0

    def at(self, joint: Joint, now: float) -> float:
        reach = joint.speed * max(now - self.began, 0.0)
        way = self.goal - self.start
        return self.start + min(max(way, -reach), reach)


class PleoBody:
    """The joints, the loudspeaker and the battery.

    Parameters
    ----------
    battery
        How full it is at first, 0 to 1.
    now
        When it got power [s].
    """

    def __init__(self, battery: float, now: float) -> None:
        self.now = now
        """Its own time [s]; never runs backwards."""
        self.played: deque[Played] = deque(maxlen=REMEMBERED)
        """What it was told to play."""
        self.volume = 50
        """How loud it is [%]."""
        self.motion_speed = 100
        """How fast motions are [%]."""
        self.motion: str | None = None
        """The motion's file that is played; None when it has ended."""
        self._motion_ends = 0.0
        self._mood = "neutral"
        self._sound: str | None = None
        self._sound_ends = 0.0
        self._ways = [_Way() for _ in JOINTS]
        self._battery = battery + now / BATTERY_LIFE

    @property
    def battery(self) -> float:
        """From empty, 0, to full, 1; somebody puts it on its charger before it is empty."""
        return max(0.1, (self._battery - self.now / BATTERY_LIFE) % 1.0)

    @property
    def angles(self) -> tuple[float, ...]:
        """Where every joint is [°]."""
        return tuple(way.at(joint, self.now) for way, joint in zip(self._ways, JOINTS, strict=True))

    @property
    def sound(self) -> str | None:
        """The sound's file that is played; None when it is quiet."""
        return self._sound if self.now < self._sound_ends else None

    @property
    def mood(self) -> str:
        """The word that the last motion is named after, if it is one for a feeling."""
        return self._mood

    def live(self, now: float) -> None:
        """Live until time `now` [s]."""
        self.now = max(self.now, now)
        if self.motion is not None and self.now >= self._motion_ends:
            self.motion = None

    def move(self, joint: int, degrees: float) -> float:
        """Send a joint on its way; return when it will be there [s]."""
        start = self._ways[joint].at(JOINTS[joint], self.now)
        goal = JOINTS[joint].nearest(degrees)
        self._ways[joint] = _Way(start, self.now, goal)
        return self.now + JOINTS[joint].time(start, goal)

    def neutral(self) -> None:
        """Send every joint to zero, and end the motion."""
        self.motion, self._mood = None, "neutral"
        for number in range(len(JOINTS)):
            self.move(number, 0)

    def play_motion(self, name: str) -> None:
        """Begin a motion; it ends any other."""
        self.played.append(Played(self.now, "motion", name))
        random = np.random.default_rng(crc32(name.encode()))
        self.motion = name
        self._motion_ends = self.now + random.uniform(*MOTION_LASTS) * 100 / self.motion_speed
        for number, joint in enumerate(JOINTS):
            self.move(number, random.uniform(joint.low, joint.high))
        word = name.partition(":")[2].partition(".")[0].casefold()
        if word in PLACES:
            self._mood = word

    def play_sound(self, name: str) -> None:
        """Begin a sound; it ends any other."""
        self.played.append(Played(self.now, "sound", name))
        self._sound, self._sound_ends = name, self.now + SOUND_LASTS
