"""Moods on a line, angry – neutral – happy, and what moves along it.

Kisses move the mood towards happy, shouting towards angry, idle leaves it, and intensity makes it
faster (Fernández-Baena 2015, section 5.3; law and numbers by the specification, M11).
"""

import math
from dataclasses import dataclass
from typing import Literal

from affect.emotion import ANGRY_BELOW, HAPPY_ABOVE, Emotion
from affect.errors import AffectError

Label = Literal["angry", "neutral", "happy"]
Action = Literal["idle", "kiss", "shout"]

LABELS: tuple[Label, ...] = ("neutral", "happy", "angry")
"""Every label; the first is the one to start with."""

GAP_MAX = 0.5
"""Longest time that one update accounts for [s]. A camera that hung saw no kisses meanwhile."""

_DIRECTION = {"idle": 0.0, "kiss": 1.0, "shout": -1.0}


def next_label(
    label: Label,
    value: float,
    happy_above: float = HAPPY_ABOVE,
    angry_below: float = ANGRY_BELOW,
    hysteresis: float = 0.05,
) -> Label:
    """Return the label of a mood that had `label` before.

    Happy is entered above `happy_above` and left below `happy_above` − `hysteresis`; angry
    likewise. From one extreme the next label is always neutral, however far the value has jumped.

    >>> next_label("neutral", 0.30), next_label("happy", 0.30), next_label("happy", -1.0)
    ('neutral', 'happy', 'neutral')
    """
    if label == "happy":
        return "happy" if value >= happy_above - hysteresis else "neutral"
    if label == "angry":
        return "angry" if value <= angry_below + hysteresis else "neutral"
    if value > happy_above:
        return "happy"
    return "angry" if value < angry_below else "neutral"


@dataclass(frozen=True)
class Mood:
    """Where on the line the mood is."""

    value: float
    """From angry, −1, over neutral, 0, to happy, 1: its valence."""

    label: str
    """The word for it, with hysteresis: of a `MoodLine` a `Label`, else one of its label set's."""

    emotion: Emotion
    """The same for a robot: valence is the value. On the line the arousal is its magnitude, for the
    further from neutral the more excited, whichever way, and neutral the origin of the plane."""

    timestamp: float
    """When [s]."""


def time_counted(last: float | None, now: float, what: str, kind: str) -> float:
    """Return how much time [s] an update accounts for: none the first time, at most `GAP_MAX`.

    Raises
    ------
    AffectError
        If time runs backwards; the line names what was updated, and the class to make anew.
    """
    last = now if last is None else last
    if not last <= now < math.inf:  # also refuses NaN
        raise AffectError(
            f"{what} at {last} s cannot go back to {now} s: give each recording its own {kind}"
        )
    return min(now - last, GAP_MAX)


class MoodLine:
    """Moves a mood along the line.

    Parameters
    ----------
    gain
        How fast an action of full intensity moves it [1/s].
    happy_above, angry_below
        Values beyond which the mood is happy or angry.
    hysteresis
        How far back it must come for the label to return to neutral.
    """

    def __init__(
        self,
        gain: float = 0.10,
        happy_above: float = HAPPY_ABOVE,
        angry_below: float = ANGRY_BELOW,
        hysteresis: float = 0.05,
    ) -> None:
        if not 0 < gain < math.inf:
            raise AffectError(f"the gain of a mood must be positive, not {gain!r}")
        if not -1 <= angry_below < happy_above <= 1:
            raise AffectError(
                f"a mood needs -1 ≤ angry_below < happy_above ≤ 1, not {angry_below}, {happy_above}"
            )
        if not 0 <= hysteresis < (happy_above - angry_below) / 2:
            raise AffectError(
                f"the hysteresis of a mood must be from 0 to less than half the neutral stretch, "
                f"not {hysteresis}"
            )
        self._gain = gain
        self._thresholds = happy_above, angry_below, hysteresis
        self._value = 0.0
        self._label: Label = "neutral"
        self._timestamp: float | None = None

    def update(self, action: Action, weight: float, timestamp: float) -> Mood:
        """Account for what was done since the last update.

        Parameters
        ----------
        action
            "kiss" moves the mood towards happy, "shout" towards angry, "idle" leaves it.
        weight
            Intensity of the action, −1…1: the rate is gain · (1 + weight) / 2.
        timestamp
            Now [s]. The first update only starts the clock; one more than `GAP_MAX` after the last
            counts as `GAP_MAX`.

        Raises
        ------
        AffectError
            If the action is unknown, the weight is out of range, or time runs backwards.
        """
        if action not in _DIRECTION:
            raise AffectError(f"{action!r} moves no mood: it must be idle, kiss or shout")
        if not -1.0 <= weight <= 1.0:
            raise AffectError(f"the weight of {action!r} must be from -1 to 1, not {weight!r}")
        rate = _DIRECTION[action] * self._gain * (1.0 + weight) / 2.0
        value = self._value + rate * self._elapsed(timestamp)
        self._value = min(max(value, -1.0), 1.0)
        self._label = next_label(self._label, self._value, *self._thresholds)
        emotion = Emotion(self._value, abs(self._value))
        return Mood(self._value, self._label, emotion, timestamp)

    def _elapsed(self, timestamp: float) -> float:
        elapsed = time_counted(self._timestamp, timestamp, "a mood", "MoodLine")
        self._timestamp = timestamp
        return elapsed
