"""What a robot has: joints, motions, sounds and moods, as it says itself at connect."""

from dataclasses import dataclass

NAME_MAX = 16
"""Longest name of a robot, a joint, a motion, a sound or a mood [bytes of UTF-8], whatever the
protocol: our own has no room for more."""


@dataclass(frozen=True)
class JointLimits:
    """One joint of a robot. Zero is neutral; positive is forward, up or right."""

    name: str
    """What it is called."""

    low: float
    """Smallest angle [rad]."""

    high: float
    """Largest angle [rad]."""

    speed: float
    """Top speed [rad/s]."""


@dataclass(frozen=True)
class Catalogue:
    """What a robot has."""

    name: str
    """What the robot is called, at most `NAME_MAX` bytes of UTF-8."""

    firmware: str
    """What runs on it, and which version."""

    joints: tuple[JointLimits, ...]
    """Its joints, at most 16."""

    motions: tuple[str, ...]
    """What its body can play."""

    sounds: tuple[str, ...]
    """What its loudspeaker can play."""

    moods: tuple[str, ...]
    """The words for what it feels, the first one being neutral."""
