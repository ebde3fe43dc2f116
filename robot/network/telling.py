"""When a robot's state is worth a message: when it has changed, and not too often."""

import math
from collections.abc import Mapping
from dataclasses import replace

from affect.emotion import Emotion
from robot.contract.telemetry import Telemetry
from robot.network import messages as m
from robot.network.topics import Member

STATE_EVERY = 0.2
"""The robot's state is published at most this often [s], and only when it has changed."""


class Telling:
    """Makes a robot's state messages."""

    def __init__(self) -> None:
        self._told: m.RobotState | None = None
        self._when = -math.inf
        self._number = 0

    def again(self) -> None:
        """Tell all again, as soon as asked."""
        self._told, self._when = None, -math.inf

    def state(
        self, telemetry: Telemetry, holder: Member | None, counts: Mapping[str, int], now: float
    ) -> m.RobotState | None:
        """Return what is to be told now, the session left to the caller; None for nothing."""
        if now - self._when < STATE_EVERY:
            return None
        state = _known(telemetry, holder, counts)
        if state == self._told:
            return None
        self._told, self._when = state, now
        self._number += 1
        return replace(state, number=self._number)


def _known(telemetry: Telemetry, holder: Member | None, counts: Mapping[str, int]) -> m.RobotState:
    """Return what is known of the robot, in steps that are worth a message."""
    battery = telemetry.battery
    return m.RobotState(
        session=0,
        number=0,
        link=telemetry.state,
        player=None if holder is None else holder.place,
        commanded=_point(telemetry.commanded),
        acknowledged=_point(telemetry.acknowledged),
        observed=_point(telemetry.observed),
        label=telemetry.label,
        motion=telemetry.motion,
        battery=None if battery is None else round(battery, 2),
        charging=telemetry.charging,
        **counts,
    )


def _point(emotion: Emotion | None) -> tuple[float, float] | None:
    return None if emotion is None else (round(emotion.valence, 2), round(emotion.arousal, 2))
