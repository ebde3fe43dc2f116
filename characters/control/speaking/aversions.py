"""Where a speaker looks besides at the listener.

Times: Andrist, Mutlu and Gleicher, "Conversational gaze aversion for virtual agents", 2013. Who
begins to speak thinks, and mostly looks up; later a speaker mostly looks aside.
"""

import math
from bisect import bisect_right

import numpy as np

from cubeling.characters.body.gaze import Aversion
from cubeling.characters.speech.speech import SILENCE, Utterance

BEFORE_S, AFTER_S = (1.0, 0.25), (1.2, 0.25)
"""From when before the first word to when after it eyes are away: mean and deviation [s]."""

BACK_S = (2.3, 0.5)
"""From when before the end on they are on the listener: mean and deviation [s]."""

EVERY_S, LASTS_S = (4.0, 1.0), (1.0, 0.2)
"""Between: after how long they look away again, and for how long [s]."""

LIKELY_DIRECTION_SHARE = 0.7
"""Share of looks that go up while thinking, and aside later."""

THINKING_HEAD, LATER_HEAD = 0.4, 0.1
"""Share of the way that the head goes along."""

MIN_S = 0.3
"""A shorter look away is left out [s]."""

UP_RAD, ASIDE_RAD = math.radians(14.0), math.radians(17.0)
"""How far eyes look away, up and aside [rad]."""


class Aversions:
    """When a speaker looks away from the listener, planned for a whole speech."""

    def __init__(self, utterance: Utterance, rng: np.random.Generator) -> None:
        self._looks: list[tuple[float, float, Aversion]] = []
        spoken = [phone for phone in utterance.phones if phone.symbol != SILENCE]
        if not spoken:  # nobody knows what is being said, as of a live voice
            return
        begin, latest = spoken[0].start, spoken[-1].end - _draw(BACK_S, rng)
        self._add(begin - _draw(BEFORE_S, rng), min(begin + _draw(AFTER_S, rng), latest), True, rng)
        start = begin + AFTER_S[0] + _draw(EVERY_S, rng)
        while start < latest:
            end = start + _draw(LASTS_S, rng)
            self._add(start, min(end, latest), False, rng)
            start = end + _draw(EVERY_S, rng)

    def _add(self, start: float, end: float, thinking: bool, rng: np.random.Generator) -> None:
        up = (rng.uniform() < LIKELY_DIRECTION_SHARE) == thinking
        side, size = rng.choice((-1.0, 1.0)), rng.uniform(0.8, 1.2)
        yaw, pitch = (0.4, 1.0) if up else (1.0, rng.uniform(-0.5, 0.2))
        head = THINKING_HEAD if thinking else LATER_HEAD
        look = Aversion(size * side * yaw * ASIDE_RAD, size * pitch * UP_RAD, head)
        if end - start >= MIN_S:
            self._looks.append((start, end, look))

    def at(self, time: float) -> Aversion | None:
        """Return where the eyes are at a time of the speech [s]; None on the listener."""
        place = bisect_right(self._looks, time, key=lambda look: look[0]) - 1
        if place < 0:
            return None
        _, end, look = self._looks[place]
        return look if time < end else None


def _draw(normal: tuple[float, float], rng: np.random.Generator) -> float:
    mean, deviation = normal
    return max(float(rng.normal(mean, deviation)), 0.2)
