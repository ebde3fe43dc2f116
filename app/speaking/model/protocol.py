"""What a language model is to a talk."""

from typing import Protocol

from cubeling.affect import Emotion
from cubeling.app.errors import AppError

TIMEOUT_S = 8.0
"""How long a reply may take from its question to its last byte [s]."""


class ModelError(AppError):
    """A model that gave no reply, and why, in one line."""


class LanguageModel(Protocol):
    """Replies to what a player says."""

    note: str
    """What was left out of the last reply, in one line; "" for nothing."""

    def reply(self, text: str, emotion: Emotion) -> str:
        """Return what a character says in an emotion, with tags; see `tagged_reply`.

        Raises ModelError, after a bounded time.
        """
        ...

    def remember(self, said: str) -> None:
        """Take what the character has said by itself, so that the next reply follows it."""
        ...
