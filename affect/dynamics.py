"""What a character feels: moved by what it does and what happens to it, and drawn home."""

import math

from affect.emotion import Emotion
from affect.mood_line import Mood, time_counted
from affect.personality import Personality, in_range

TOP_SPEED = 5.0
"""AvatAR's Speed at which a character moves as fast as it can."""


class Feelings:
    """One character's feelings; everything that shows them shows this one object's.

    Between two updates valence and arousal obey x′ = g·(1 + w)/2 + (home − x)·ln 2/half-life, each
    with its own numbers, and stop at ±1. The solution is exact, so nothing depends on how often
    `update` is called, but for when a label is looked at.

    Parameters
    ----------
    personality
        Who feels. "thesis" gives the law of `MoodLine`, bit for bit.
    """

    def __init__(self, personality: Personality | str = "thesis") -> None:
        if isinstance(personality, str):
            personality = Personality.load(personality)
        self.personality = personality
        """Who feels."""
        home = personality.temperament
        self._valence, self._arousal = home.valence, home.arousal
        self._labels = personality.label_set
        self._wanted = self._shown = self._labels.start
        self._since = -math.inf
        self._speed = 0.0
        self._timestamp: float | None = None

    def update(self, action: str, weight: float, timestamp: float, speed: float = 0.0) -> Mood:
        """Account for what was done since the last update.

        Parameters
        ----------
        action
            What the character did. One that the personality has no gain for moves nothing.
        weight
            Intensity of the action, −1…1: the rate is gain · (1 + weight) / 2.
        timestamp
            Now [s]. The first update only starts the clock; one more than `GAP_MAX` after the last
            counts as `GAP_MAX`.
        speed
            AvatAR's Speed, 0…5; more counts as 5.

        Raises
        ------
        AffectError
            If the weight or the speed is out of range, or time runs backwards; nothing has changed.
        """
        in_range(f"the weight of {action!r}", weight, -1.0, 1.0)
        in_range("the speed", speed, 0.0, math.inf)
        elapsed = self._elapsed(timestamp)
        who, push = self.personality, self.personality.gain(action)
        self._speed = min(speed / TOP_SPEED, 1.0) * who.movement
        home = who.temperament
        strength = 1.0 + weight
        rate = push.valence * strength / 2.0
        self._valence = _moved(self._valence, home.valence, rate, who.valence_half_life, elapsed)
        if who.arousal == "own":
            rate, level = push.arousal * strength / 2.0, home.arousal + self._speed
            self._arousal = _moved(self._arousal, level, rate, who.arousal_half_life, elapsed)
        self._name_it(timestamp)
        return Mood(self._valence, self._shown, self.emotion, timestamp)

    def strike(self, event: str, strength: float = 1.0) -> bool:
        """Let something happen at once: it is shaken, say, or petted.

        Parameters
        ----------
        event
            What happens. One that the personality does not know moves nothing.
        strength
            How strongly, 0…1.

        Returns
        -------
        bool
            Whether the personality knows the event. The next update shows what it did.
        """
        in_range(f"the strength of {event!r}", strength, 0.0, 1.0)
        push = self.personality.event(event).times(strength)
        self._valence = _kept(self._valence + push.valence)
        self._arousal = _kept(self._arousal + push.arousal)
        return event in self.personality.events

    @property
    def emotion(self) -> Emotion:
        """Where in the plane the feeling is now."""
        if self.personality.arousal == "magnitude":
            return Emotion(self._valence, _kept(max(abs(self._valence), self._speed)))
        return Emotion(self._valence, self._arousal)

    @property
    def label(self) -> str:
        """The word for it, with hysteresis and dwell."""
        return self._shown

    def _name_it(self, now: float) -> None:
        """Choose the label wanted, and show it as soon as the one before has had its time."""
        labels, who = self._labels, self.personality
        self._wanted = labels.next(self._wanted, self.emotion, who.hysteresis)
        if self._wanted == self._shown or now - self._since < who.dwell:
            return
        passes = labels.hub not in (None, self._wanted, self._shown)
        self._shown = str(labels.hub) if passes else self._wanted
        self._since = now

    def _elapsed(self, timestamp: float) -> float:
        elapsed = time_counted(self._timestamp, timestamp, "feelings", "Feelings")
        self._timestamp = timestamp
        return elapsed


def _moved(value: float, home: float, rate: float, half_life: float, elapsed: float) -> float:
    """Return the value after `elapsed` [s]: the exact solution, kept in the plane.

    It is monotone, so where it meets ±1 it stays, and keeping its end there is exact too.
    """
    if half_life == math.inf:
        return _kept(value + rate * elapsed)
    decay = math.log(2.0) / half_life
    share = -math.expm1(-decay * elapsed)
    return _kept(value + (home - value) * share + rate * share / decay)


def _kept(value: float) -> float:
    return min(max(value, -1.0), 1.0)
