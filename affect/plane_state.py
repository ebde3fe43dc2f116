"""A state of valence and arousal: what a character feels, as a point of the plane."""

from cubeling.affect.decay import decay
from cubeling.affect.emotion import Emotion
from cubeling.affect.labels import LabelSet
from cubeling.affect.occ import OCC_PLACES
from cubeling.affect.personality import Personality


class PlaneState:
    """Valence and arousal, which obey x′ = g·(1 + w)/2 + (home − x)·ln 2/half-life, within ±1."""

    def __init__(self, personality: Personality) -> None:
        self._personality = personality
        home = personality.temperament
        self._valence, self._arousal = home.valence, home.arousal
        self._movement = 0.0

    def advance(self, action: str, share: float, movement: float, elapsed: float) -> None:
        """Account for a time [s] of an action, at a share of its gain, 0…1.

        `movement` raises the arousal that it decays to.
        """
        personality, gain = self._personality, self._personality.gain(action)
        self._movement = movement
        home = personality.temperament
        rate = gain.valence * share
        self._valence = _clamp(
            decay(self._valence, home.valence, rate, personality.valence_half_life, elapsed)
        )
        # With "magnitude" arousal is computed from valence and movement in `show`, and has no
        # state.
        if personality.arousal == "own":
            rate, level = gain.arousal * share, home.arousal + movement
            self._arousal = _clamp(
                decay(self._arousal, level, rate, personality.arousal_half_life, elapsed)
            )

    def apply_event(self, event: str, strength: float) -> None:
        """Move at once by an event's impulse, times a strength, 0…1."""
        impulse = self._personality.event(event)
        self._move(impulse.valence * strength, impulse.arousal * strength)

    def influence(self, word: str, value: float) -> None:
        """Move towards the place of one of the 24 emotions."""
        impulse = self._personality.influence(word, value)
        self._move(impulse.valence, impulse.arousal)

    @property
    def intensities(self) -> dict[str, float]:
        """How far the point has gone towards the place of each of the 24 emotions, 0…1."""
        here = self.show("neutral")
        return {
            word: min(
                max(here.valence * valence + here.arousal * arousal, 0.0)
                / (valence * valence + arousal * arousal),
                1.0,
            )
            for word, (valence, arousal) in OCC_PLACES.items()
        }

    def next_word(self, word: str, labels: LabelSet, hysteresis: float) -> str:
        """Return the word that follows another one."""
        return labels.next(word, self.show(word), hysteresis)

    def show(self, word: str) -> Emotion:
        """Return the emotion under a word."""
        arousal = self._arousal
        if self._personality.arousal == "magnitude":
            arousal = _clamp(max(abs(self._valence), self._movement))
        return Emotion(self._valence, arousal, word)

    def _move(self, valence: float, arousal: float) -> None:
        self._valence = _clamp(self._valence + valence)
        self._arousal = _clamp(self._arousal + arousal)


def _clamp(value: float) -> float:
    return min(max(value, -1.0), 1.0)
