"""The requests that a driver keeps: the desired state, and a queue of actions.

An emotion or a stop is a state: only the latest counts, and it is restored after every break.
Motions and sounds are events: each is sent at most once, in order, and dropped with the session.
"""

from collections import deque
from typing import TypeVar

from cubeling.affect import Emotion

Action = TypeVar("Action")


class CommandQueue(deque[Action]):
    """Motions and sounds that wait to be sent; at most `limit`."""

    def __init__(self, limit: int) -> None:
        super().__init__()
        self.dropped = 0
        """Actions given up before the robot acknowledged them."""
        self._limit = limit

    def add(self, action: Action) -> bool:
        """Append an action; return False if too many wait already."""
        if len(self) >= self._limit:
            return False
        self.append(action)
        return True

    def drop_all(self) -> None:
        """Drop and count every action that waits."""
        self.dropped += len(self)
        self.clear()


class DesiredState:
    """The emotion or the stop that was requested last, and what the robot has confirmed.

    A robot that knows only words takes every emotion that is requested while its word is shown.
    """

    def __init__(self) -> None:
        self.commanded: Emotion | None = None
        """The emotion requested last; None before the first, and after a stop."""
        self.acknowledged: Emotion | None = None
        """The emotion that the robot confirmed and, as far as is known, still holds."""
        self.stopped = False
        """Whether the robot has confirmed the stop and still holds it."""
        self.sent: Emotion | None = None
        """The emotion for which the last command of a mood was sent."""
        self.shown: str | None = None
        """The word of the acknowledged emotion, until another command displaces it."""

    def follow(self, word: str, emotion: Emotion, *, sent: bool) -> None:
        """Record another emotion with the same word; `sent`: whether that word was sent."""
        if sent:
            self.sent = emotion
        if self.shown == word:
            self.acknowledged = emotion

    def begin(self, word: str | None) -> None:
        """Record that a command for a word is sent: it displaces any other word."""
        if self.shown != word:
            self.shown = None  # `acknowledged` stays until the next confirmation

    def confirm(
        self, emotion: Emotion | None, word: str | None = None, *, stopped: bool = False
    ) -> None:
        """Record what the robot has taken: an emotion, with its word if it needs one, or a stop."""
        self.acknowledged, self.shown, self.stopped = emotion, word, stopped

    def forget(self) -> None:
        """Record that the robot may hold nothing any more."""
        self.confirm(None)
