"""Comparing a recorded session with what its frames lead to now."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import zip_longest

from rich.table import Table

from cubeling.app.pipeline.step import Step
from cubeling.app.running.opened_session import OpenedSession
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import Progress
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.app.session.encoding import APPEARANCE_TOPIC, CHANNEL_TYPES, encode, upgrade


@dataclass
class ComparisonResult:
    """The number of messages that agree and differ, by channel."""

    counts: Counter[str] = field(default_factory=Counter)
    """Messages of each channel."""

    different: Counter[str] = field(default_factory=Counter)
    """Messages of each channel that differ in any byte."""

    first: dict[str, float] = field(default_factory=dict)
    """Time of the first one that differs, by channel [s]."""

    @property
    def identical(self) -> bool:
        """Whether every message of every channel is the same."""
        return not self.different and bool(self.counts)

    def __rich__(self) -> Table:
        table = Table("channel", "messages", "different", "first at")
        cast = sorted(each for each in self.counts if each and each not in CHANNEL_TYPES)
        for topic in (*CHANNEL_TYPES, *cast):
            if not self.counts[topic]:
                continue
            first = self.first.get(topic)
            first_at = "" if first is None else f"{first:.3f} s"
            table.add_row(topic, str(self.counts[topic]), str(self.different[topic]), first_at)
        return table


def check_session(
    session: SessionFile, options: SessionOptions, progress: Progress | None = None
) -> ComparisonResult:
    """Process a session's frames again and compare every message with the recorded one."""
    result = ComparisonResult()
    options = replace(
        options,
        source=str(session.path),
        pictures=False,
        appearance=session.has(APPEARANCE_TOPIC),
        robot="none",
        second_robot="none",
        record=None,
        output=None,
    )
    recorded = (
        (topic, time, upgrade(topic, data))
        for topic, time, data in session.messages(*session.channels)
    )
    with open_session(options, replayed=session) as opened:
        made = (
            (topic, step.frame.timestamp, encode(message))
            for step in _steps(opened, progress)
            for topic, message in step.messages().items()
        )
        for old, new in zip_longest(recorded, made):
            topic, time, _ = old or new or ("", 0.0, b"")
            result.counts[topic] += 1
            if old != new:
                result.different[topic] += 1
                result.first.setdefault(topic, time)
    return result


def _steps(session: OpenedSession, progress: Progress | None) -> Iterator[Step]:
    """Process every frame, whatever its time."""
    for frame in session.source:
        step = session.playground.step(frame, session.recorded_inputs(frame.timestamp))
        if progress is not None:
            progress(step)
        yield step
