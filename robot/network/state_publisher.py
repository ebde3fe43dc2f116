"""Publication of a robot's state: when it has changed, at a limited rate."""

import math
from collections.abc import Mapping

from msgspec.structs import replace

from cubeling.affect.emotion import Emotion
from cubeling.robot.contract.telemetry import Telemetry
from cubeling.robot.network.messages import StateMessage
from cubeling.robot.network.topics import Member

STATE_EVERY_S = 0.2
"""Shortest time between two messages of a robot's state [s]."""


class StatePublisher:
    """Makes the state messages of a robot."""

    def __init__(self) -> None:
        self._last: StateMessage | None = None
        self._last_time = -math.inf
        self._number = 0

    def reset(self) -> None:
        """Forget what was published, so that the state is published again at once."""
        self._last, self._last_time = None, -math.inf

    def update(
        self,
        session: int,
        telemetry: Telemetry,
        active: Member | None,
        counts: Mapping[str, int],
        now: float,
    ) -> StateMessage | None:
        """Return the message to publish now; None if nothing changed, or if it is too soon."""
        if now - self._last_time < STATE_EVERY_S:
            return None
        state = _state(telemetry, active, counts)
        if state == self._last:
            return None
        self._last, self._last_time = state, now
        self._number += 1
        return replace(state, session=session, number=self._number)


def _state(telemetry: Telemetry, active: Member | None, counts: Mapping[str, int]) -> StateMessage:
    """Return the state in steps that are worth a message; session and number are left out."""
    battery = telemetry.battery
    return StateMessage(
        session=0,
        number=0,
        link=telemetry.state,
        player=None if active is None else active.place,
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
