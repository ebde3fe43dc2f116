"""What the characters speak with, and lines from a recording."""

from collections.abc import Mapping
from typing import Protocol

from cubeling.app.pipeline.step import Step
from cubeling.app.pipeline.table.spoken_line import Lines
from cubeling.characters.speech import DEFAULT_PROFILE, SpeechProfile


class Speaker(Protocol):
    """Says what the characters say in a session. Whoever opens it closes it."""

    problem: str
    """Why it is silent; "" while all is well."""

    profile: SpeechProfile
    """How the next lines are said with the body; may be changed at any time."""

    language: str
    """Code of the language; may be changed to another one of `languages`, or to `SILENT`."""

    languages: tuple[str, ...]
    """The languages that can be chosen."""

    live: bool
    """Whether profile and language change what is said next."""

    def lines(self, timestamp: float) -> Lines:
        """Return what the cast wants to say from the frame of a timestamp on [s]."""
        ...

    def hear(self, step: Step) -> None:
        """Take a step, to say something about it."""
        ...

    def notice(self) -> str:
        """Return what the player should know, in one line, once; "" for nothing."""
        ...

    def close(self) -> None:
        """End; a second call does nothing."""
        ...


class RecordedSpeaker:
    """Says again what a recorded session has, by the frame in which it begins [s]."""

    live = False
    languages: tuple[str, ...] = ()

    def __init__(self, lines: Mapping[float, Lines], problem: str = "") -> None:
        self.problem, self.language = problem, ""
        self.profile = DEFAULT_PROFILE
        self._lines = lines

    def lines(self, timestamp: float) -> Lines:
        """Return what the cast wants to say from the frame of a timestamp on [s]."""
        return self._lines.get(timestamp, {})

    def hear(self, step: Step) -> None:
        """Do nothing: what is said was recorded."""

    def notice(self) -> str:
        """Return nothing: who listens to a recording can change nothing in it."""
        return ""

    def close(self) -> None:
        """Do nothing: there is no voice to close."""
