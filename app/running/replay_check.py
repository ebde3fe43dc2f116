"""Holding a recorded session against what its frames lead to now."""

from collections import Counter
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from itertools import zip_longest
from pathlib import Path

from rich.table import Table

from app.pipeline.scenario import Inputs
from app.running.opening import Wish, open_session
from app.session import messages
from app.session.encoding import ARROWS, encode


@dataclass
class Verdict:
    """How the channels of a session compare."""

    counts: Counter[str] = field(default_factory=Counter)
    """Messages of each channel."""

    different: Counter[str] = field(default_factory=Counter)
    """Messages of each channel that are not the same, byte for byte."""

    first: dict[str, float] = field(default_factory=dict)
    """Time of the first one that differs, by channel [s]."""

    @property
    def identical(self) -> bool:
        """Whether every message of every channel is the same."""
        return not self.different and bool(self.counts)

    def __rich__(self) -> Table:
        table = Table("channel", "messages", "different", "first at")
        for topic in ARROWS:
            first = self.first.get(topic)
            told = "" if first is None else f"{first:.3f} s"
            table.add_row(topic, str(self.counts[topic]), str(self.different[topic]), told)
        return table


def check_session(path: Path, wish: Wish) -> Verdict:
    """Walk a session's frames down the line again and compare every arrow with the recorded one."""
    verdict = Verdict()
    wish = replace(wish, pictures=False, robot="none", record=None, output=None)
    recorded = messages(path, *ARROWS)
    with ExitStack() as closing:
        plan = open_session(wish, closing)
        made = (
            (topic, step.frame.timestamp, encode(arrow))
            for frame in plan.source
            for step in (plan.playground.step(frame, Inputs(frame.timestamp in plan.cues)),)
            for topic, arrow in step.arrows().items()
        )
        for old, new in zip_longest(recorded, made):
            topic, time, _ = old or new or ("", 0.0, b"")
            verdict.counts[topic] += 1
            if old != new:
                verdict.different[topic] += 1
                verdict.first.setdefault(topic, time)
    return verdict
