"""The three labels of the thesis, chosen by the valence with hysteresis."""

from typing import Literal

Label = Literal["angry", "neutral", "happy"]

THESIS_LABELS: tuple[Label, ...] = ("neutral", "happy", "angry")
"""The labels; the first is the initial one."""

HAPPY_ABOVE = 0.33
"""Valence above which an emotion is called happy (Fernández-Baena 2015, section 5.3, names the
moods; the value is the specification's)."""

ANGRY_BELOW = -0.33
"""Valence below which it is called angry."""


def next_label(label: str, valence: float, hysteresis: float = 0.05) -> Label:
    """Return the label that follows `label` at a valence.

    Happy is entered above `HAPPY_ABOVE` and left below `HAPPY_ABOVE` − `hysteresis`; angry is
    entered below `ANGRY_BELOW` and left above `ANGRY_BELOW` + `hysteresis`. The label between happy
    and angry is always neutral, however far the valence jumps.

    >>> next_label("neutral", 0.30), next_label("happy", 0.30), next_label("happy", -1.0)
    ('neutral', 'happy', 'neutral')
    """
    if label == "happy":
        return "happy" if valence >= HAPPY_ABOVE - hysteresis else "neutral"
    if label == "angry":
        return "angry" if valence <= ANGRY_BELOW + hysteresis else "neutral"
    return label_at(valence)


def label_at(valence: float) -> Label:
    """Return the label at a valence, without hysteresis."""
    if valence > HAPPY_ABOVE:
        return "happy"
    return "angry" if valence < ANGRY_BELOW else "neutral"
