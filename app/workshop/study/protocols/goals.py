"""Goals of tasks: whether and when the channels of a session reach one."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

from cubeling.app.errors import AppError
from cubeling.app.session import WizardAct

Value = float | str | tuple[str, ...]


class Measured(NamedTuple):
    """A value of a channel that a goal may ask for."""

    topic: str
    """The channel of the session whose messages have it."""

    of: Callable[[Any], Value | None]
    """Takes it from a message."""

    low: float | None = None
    """Least number; None for a value that is a text."""

    high: float | None = None


MEASURED: Mapping[str, Measured] = {
    "mood": Measured("/robot/emotion", lambda message: message.emotion.label),
    "valence": Measured("/robot/emotion", lambda message: message.emotion.valence, -1.0, 1.0),
    "arousal": Measured("/robot/emotion", lambda message: message.emotion.arousal, -1.0, 1.0),
    "action": Measured("/character/command", lambda message: message.activity),
    "intensity": Measured("/character/command", lambda message: message.weight, -1.0, 1.0),
    "speed": Measured("/character/command", lambda message: message.speed, 0.0, 5.0),
    "face": Measured("/cube/controls", lambda message: message.top_face),
    "gesture": Measured("/cube/controls", lambda message: tuple(message.gestures)),
    "turns": Measured("/cube/controls", lambda message: message.turns, -1000.0, 1000.0),
    "placements": Measured("/cube/controls", lambda message: message.placements, 0.0, 1000.0),
}
"""What goals may ask for, by name."""

GOAL_TOPICS = tuple(dict.fromkeys(each.topic for each in MEASURED.values()))


@dataclass(frozen=True)
class Goal:
    """What is to be reached: a text, or a number from `at_least` to `at_most`."""

    value: str
    """One of `MEASURED`."""

    equals: str = ""
    """The text; for gestures, one of them."""

    at_least: float | None = None
    """The least number that will do; None for no lower bound."""

    at_most: float | None = None
    """The greatest number that will do; None for no upper bound."""

    hold_s: float = 0.0
    """How long it must stay so [s]."""

    def __post_init__(self) -> None:
        if self.value not in MEASURED:
            raise AppError(f"a goal cannot ask for '{self.value}': choose {', '.join(MEASURED)}")
        measured = MEASURED[self.value]
        low, high = measured.low, measured.high
        if low is None or high is None:
            if not self.equals or self.at_least is not None or self.at_most is not None:
                raise AppError(f"the goal '{self.value}' needs 'equals', and no numbers")
            return
        if self.equals or (self.at_least is None and self.at_most is None):
            raise AppError(f"the goal '{self.value}' needs 'at_least' or 'at_most'")
        least, most = self.at_least, self.at_most
        if max(low, low if least is None else least) > min(high, high if most is None else most):
            raise AppError(
                f"the goal '{self.value}' cannot be reached: it is always from {low:g} to {high:g}"
            )

    @property
    def words(self) -> str:
        """What it asks for, for tables.

        >>> Goal("mood", "happy").words, Goal("valence", at_least=0.5).words
        ('mood = happy', 'valence ≥ 0.5')
        """
        parts = [f"{self.value} = {self.equals}"] if self.equals else []
        parts += [] if self.at_least is None else [f"{self.value} ≥ {self.at_least:g}"]
        parts += [] if self.at_most is None else [f"{self.value} ≤ {self.at_most:g}"]
        held = f" for {self.hold_s:g} s" if self.hold_s else ""
        return " and ".join(parts) + held

    def met_by(self, value: Value | None) -> bool:
        """Return whether a value is as it asks for; None is an unknown one."""
        if value is None:
            return False
        if isinstance(value, tuple):
            return self.equals in value
        if isinstance(value, str):
            return value == self.equals
        least, most = self.at_least, self.at_most
        return (least is None or value >= least) and (most is None or value <= most)


Ending = Literal["goal", "limit", "person", "source"]
"""What ended a task: the goal was reached, the time was up, the participant ended it, or there were
no more pictures."""


@dataclass(frozen=True)
class TaskResult:
    """How a task ended."""

    reached: bool
    """Whether its goal was reached within the limit."""

    time_s: float | None
    """When, from the first frame [s]; None if it was not."""

    played_s: float
    """How long it lasted [s]."""

    ended_by: Ending

    acts: tuple[WizardAct, ...] = ()
    """What a wizard did in it."""


class GoalWatch:
    """Follows the messages of a task, in the order of time.

    A goal that must hold is reached at the end of that time.
    """

    def __init__(self, goal: Goal, limit_s: float) -> None:
        self._goal, self._limit_s = goal, limit_s
        self._topic, self._of = MEASURED[goal.value].topic, MEASURED[goal.value].of
        self._first: float | None = None
        self._since: float | None = None
        self._last = 0.0
        self._reached: float | None = None

    def see(self, topic: str, time: float, message: Any) -> None:
        """Take a message of a channel at a time of the session [s]."""
        self._first = time if self._first is None else self._first
        now = self._last = time - self._first
        if topic != self._topic or self._reached is not None or now > self._limit_s:
            return
        if not self._goal.met_by(self._of(message)):
            self._since = None
            return
        self._since = now if self._since is None else self._since
        if now - self._since >= self._goal.hold_s:
            self._reached = now

    @property
    def reached(self) -> bool:
        """Whether the goal was reached within the limit."""
        return self._reached is not None

    @property
    def time_is_up(self) -> bool:
        """Whether the task has lasted as long as it may."""
        return self._last >= self._limit_s

    @property
    def result(self) -> TaskResult:
        """How it ended so far."""
        reached = None if self._reached is None else round(self._reached, 6)
        ended: Ending = "goal" if self.reached else "limit" if self.time_is_up else "source"
        played_s = round(min(self._last, self._limit_s), 6)
        return TaskResult(reached is not None, reached, played_s, ended)


def result_of(goal: Goal, limit_s: float, messages: Iterable[tuple[str, float, Any]]) -> TaskResult:
    """Return how a task ended whose messages (topic, time [s], message) are all there."""
    watch = GoalWatch(goal, limit_s)
    for topic, time, message in messages:
        watch.see(topic, time, message)
    return watch.result
