"""How an emotion changes: actions and events move it, and it decays to the temperament."""

import math

from cubeling.affect.emotion import Emotion
from cubeling.affect.errors import AffectError
from cubeling.affect.personality import Personality, check_range

TOP_SPEED = 5.0
"""AvatAR's Speed at which a character moves as fast as it can."""

MAX_TIME_STEP_S = 0.5
"""Longest time that one update accounts for [s]: a camera that hung saw no kisses."""


class Feelings:
    """The emotional state of one character; everything that shows an emotion takes it from here.

    Between two updates valence and arousal obey x′ = g·(1 + w)/2 + (home − x)·ln 2/half-life, each
    with its own numbers, and stop at ±1. The solution is exact: the result does not depend on how
    often `update` is called, except for the times at which a label may change.

    Parameters
    ----------
    personality
        A personality, or the name of a bundled one or a .toml file.

    Raises
    ------
    AffectError
        If there is no such personality, or its file is invalid.
    """

    def __init__(self, personality: Personality | str = "thesis") -> None:
        if isinstance(personality, str):
            personality = Personality.load(personality)
        self.personality = personality
        """What sets how the emotion changes."""
        home = personality.temperament
        self._valence, self._arousal = home.valence, home.arousal
        self._label_set = personality.label_set
        self._next_word = self._word = self._label_set.start
        # Infinitely long ago: the dwell time never holds back the first word.
        self._word_since = -math.inf
        self._movement = 0.0
        self._timestamp: float | None = None

    def update(self, action: str, weight: float, timestamp: float, speed: float = 0.0) -> Emotion:
        """Account for what the character did since the last update.

        Parameters
        ----------
        action
            What the character did. An action without a gain in the personality has no effect.
        weight
            Intensity of the action, −1…1: the rate is gain · (1 + weight) / 2.
        timestamp
            Now [s]. The first update only starts the clock; at most `MAX_TIME_STEP_S` counts.
        speed
            AvatAR's Speed, 0…5; more counts as 5.

        Raises
        ------
        AffectError
            If the weight or the speed is out of range, or time runs backwards. The state is then
            unchanged.
        """
        check_range(f"the weight of {action!r}", weight, -1.0, 1.0)
        check_range("the speed", speed, 0.0, math.inf)
        # Before anything is changed: a refused update leaves the state as it was.
        elapsed = self._time_since_update(timestamp)
        personality, gain = self.personality, self.personality.gain(action)
        self._movement = min(speed / TOP_SPEED, 1.0) * personality.movement
        home = personality.temperament
        strength = 1.0 + weight
        rate = gain.valence * strength / 2.0
        self._valence = _decay(
            self._valence, home.valence, rate, personality.valence_half_life, elapsed
        )
        # With "magnitude" arousal is computed from valence and movement in `emotion`, and has no
        # state.
        if personality.arousal == "own":
            rate, level = gain.arousal * strength / 2.0, home.arousal + self._movement
            self._arousal = _decay(
                self._arousal, level, rate, personality.arousal_half_life, elapsed
            )
        self._choose_word(timestamp)
        return self.emotion

    def apply_event(self, event: str, strength: float = 1.0) -> bool:
        """Apply an event, which takes effect at once: the cube is shaken, say.

        Parameters
        ----------
        event
            Its name. One that the personality does not know has no effect.
        strength
            How strong it is, 0…1.

        Returns
        -------
        bool
            Whether the personality knows the event. The next update shows the effect.

        Raises
        ------
        AffectError
            If the strength is out of range.
        """
        check_range(f"the strength of {event!r}", strength, 0.0, 1.0)
        impulse = self.personality.event(event).times(strength)
        self._valence = _clamp(self._valence + impulse.valence)
        self._arousal = _clamp(self._arousal + impulse.arousal)
        return event in self.personality.events

    @property
    def emotion(self) -> Emotion:
        """The emotion now; its word has hysteresis and dwell."""
        arousal = self._arousal
        if self.personality.arousal == "magnitude":
            arousal = _clamp(max(abs(self._valence), self._movement))
        return Emotion(self._valence, arousal, self._word)

    def _choose_word(self, now: float) -> None:
        """Choose the next word, and take it once the present one has lasted its dwell time."""
        # The candidate has hysteresis against itself, not against the word that is shown: during
        # the
        # dwell time it goes on moving, and the newest one is taken at its end.
        labels, personality = self._label_set, self.personality
        self._next_word = labels.next(self._next_word, self.emotion, personality.hysteresis)
        if self._next_word == self._word or now - self._word_since < personality.dwell:
            return
        # Robots have motions only from and to neutral: from happy to angry it passes the hub.
        through_hub = labels.hub not in (None, self._next_word, self._word)
        self._word = str(labels.hub) if through_hub else self._next_word
        self._word_since = now

    def _time_since_update(self, now: float) -> float:
        last = now if self._timestamp is None else self._timestamp
        if not last <= now < math.inf:  # also refuses NaN
            raise AffectError(
                f"feelings at {last} s cannot go back to {now} s: "
                "give each recording its own Feelings"
            )
        self._timestamp = now
        return min(now - last, MAX_TIME_STEP_S)


def _decay(value: float, home: float, rate: float, half_life: float, elapsed: float) -> float:
    """Return the value after `elapsed` [s]: the exact solution, clamped to −1…1.

    The solution is monotone, so clamping its end is exact too.
    """
    # The limit of the formula below, which would divide by a decay of zero.
    if half_life == math.inf:
        return _clamp(value + rate * elapsed)
    decay = math.log(2.0) / half_life
    # 1 − e^−x loses its digits for the small x of one frame; expm1 keeps them.
    share = -math.expm1(-decay * elapsed)
    return _clamp(value + (home - value) * share + rate * share / decay)


def _clamp(value: float) -> float:
    return min(max(value, -1.0), 1.0)
