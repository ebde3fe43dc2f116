"""What a robot has: joints, motions, sounds and moods. The robot reports it at connect."""

from dataclasses import dataclass

MAX_NAME_BYTES = 16
"""Longest name of a robot, joint, motion, sound or mood [bytes of UTF-8] in every protocol; it is
the limit of the protocol "cubeling"."""


@dataclass(frozen=True)
class JointLimits:
    """Limits of one joint. Zero is neutral; positive is forward, up or right."""

    name: str
    """Unique in the catalogue."""

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
    """Its name, at most `MAX_NAME_BYTES`."""

    firmware: str
    """Its firmware and version."""

    joints: tuple[JointLimits, ...]
    """Its joints, at most 16."""

    motions: tuple[str, ...]
    """Motions that it can play."""

    sounds: tuple[str, ...]
    """Sounds that it can play."""

    moods: tuple[str, ...]
    """Moods that it can show, neutral first."""
