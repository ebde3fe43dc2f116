"""The states of a pipeline at some frames of a recording, to go on from."""

import math
import pickle
from dataclasses import dataclass

from cubeling.app.pipeline.checkpoint import Checkpoint
from cubeling.app.pipeline.playground import Playground
from cubeling.tracking import Frame

FIRST_INTERVAL_S, MAX_STATES = 0.7, 64
"""Time between two states at first, and how many are kept: of more, every second one is forgotten,
and the time between them is doubled. One takes 1 MB and 10 ms, and the frames of 0.7 s take a
quarter of a second to be decided again."""


@dataclass(frozen=True)
class SavedState:
    """The state of a pipeline after a frame."""

    timestamp: float
    """That of the frame [s]."""

    index: int
    """That of the frame in its source."""

    checkpoint: Checkpoint


class SavedStates:
    """Saves the state of a pipeline at even intervals of a recording, and where a player acted.

    They are those of one course of events: what a player does, and a return to before that, begin
    another one, and the later states are forgotten.
    """

    def __init__(self) -> None:
        self._states: list[SavedState] = []
        self._acted: list[int] = []  # indices of the frames after which a player had acted
        self._interval = FIRST_INTERVAL_S

    def save(self, playground: Playground, frame: Frame, *, acted: bool = False) -> None:
        """Save the state after a frame, if no other is near it or if a player has acted in it."""
        now = frame.timestamp
        if acted:
            self._states = [each for each in self._states if each.index < frame.index]
            self._acted = [*(each for each in self._acted if each < frame.index), frame.index]
        elif any(abs(now - state.timestamp) < self._interval for state in self._states):
            return
        if math.isinf(self._interval):
            return
        try:
            state = SavedState(now, frame.index, playground.checkpoint())
        except (TypeError, AttributeError, pickle.PicklingError):
            # The scenario of another package may hold what cannot be copied.
            self._interval = math.inf
            return
        self._states.append(state)
        if len(self._states) > MAX_STATES:
            self._states = [
                each
                for place, each in enumerate(sorted(self._states, key=lambda each: each.index))
                if place % 2 == 0 or each.index in self._acted
            ]
            self._interval *= 2.0

    def clear(self) -> None:
        """Forget all of them."""
        self._states.clear()
        self._acted.clear()

    def go_on_from(self, state: SavedState | None) -> None:
        """Forget what comes after a state, or after the start, if a player acted in between."""
        index = -1 if state is None else state.index
        later = [each for each in self._acted if each > index]
        if later:
            self._states = [each for each in self._states if each.index < later[0]]
            self._acted = self._acted[: -len(later)]

    def last_before(self, timestamp: float, index: int) -> SavedState | None:
        """Return the last state before a timestamp or before a frame; None if there is none."""
        before = [each for each in self._states if each.timestamp < timestamp or each.index < index]
        return max(before, key=lambda each: each.index, default=None)
