"""The states of a pipeline at some frames of a recording, to go on from."""

import math
import pickle
from dataclasses import dataclass

from cubeling.app.pipeline.checkpoint import Checkpoint
from cubeling.app.pipeline.playground import Playground
from cubeling.tracking import Frame

FIRST_INTERVAL_S, MAX_STATES = 1.0, 64
"""Time between two states at first, and how many are kept: of more, every second one is forgotten,
and the time between them is doubled."""


@dataclass(frozen=True)
class SavedState:
    """The state of a pipeline after a frame."""

    timestamp: float
    """That of the frame [s]."""

    index: int
    """That of the frame in its source."""

    checkpoint: Checkpoint


class SavedStates:
    """Saves the state of a pipeline at even intervals of a recording."""

    def __init__(self) -> None:
        self._states: list[SavedState] = []
        self._interval = FIRST_INTERVAL_S

    def save(self, playground: Playground, frame: Frame) -> None:
        """Save the state after a frame, if no other is near it."""
        now = frame.timestamp
        if math.isinf(self._interval):
            return
        if any(abs(now - state.timestamp) < self._interval for state in self._states):
            return
        try:
            state = SavedState(now, frame.index, playground.checkpoint())
        except (TypeError, AttributeError, pickle.PicklingError):
            # The scenario of another package may hold what cannot be copied.
            self._interval = math.inf
            return
        self._states.append(state)
        if len(self._states) > MAX_STATES:
            self._states = sorted(self._states, key=lambda each: each.index)[::2]
            self._interval *= 2.0

    def clear(self) -> None:
        """Forget all of them."""
        self._states.clear()

    def last_before(self, timestamp: float, index: int) -> SavedState | None:
        """Return the last state before a timestamp or before a frame; None if there is none."""
        before = [each for each in self._states if each.timestamp < timestamp or each.index < index]
        return max(before, key=lambda each: each.index, default=None)
