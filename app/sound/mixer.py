"""Mixing the sounds that play at one time into two channels."""

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.app.sound.bank import SoundBank
from cubeling.app.sound.cues import Cue
from cubeling.app.sound.synthesis import SAMPLE_RATE, Array

MAX_SOUNDS = 24
"""Sounds that play at one time, and cues that wait; the oldest give way to newer ones."""

USUAL_FADE_S = 0.02
"""Time in which a sound fades that is cut off [s]."""

FADE_OUT = round(USUAL_FADE_S * SAMPLE_RATE)
"""How many samples `USUAL_FADE_S` has."""

KNEE, CEILING = 0.6, 0.95
"""Amplitudes up to the first are kept; greater ones are bent to stay below the second."""


@dataclass
class _Playing:
    """A sound that plays."""

    samples: Array
    """What is left of it, (n,)."""

    gains: Array
    """Amplitudes on the left and on the right, (2,)."""


class Mixer:
    """Plays cues into blocks of stereo samples.

    `start` may be called on another thread than `render`. The same cues between the same blocks
    give the same samples.

    Parameters
    ----------
    bank
        The sounds.
    volume
        Factor of all amplitudes, 0…1; may be changed at any time.
    """

    def __init__(self, bank: SoundBank, volume: float = 1.0) -> None:
        self.bank = bank
        self.volume = volume
        self._waiting: deque[Cue] = deque(maxlen=MAX_SOUNDS)
        self._playing: deque[_Playing] = deque(maxlen=MAX_SOUNDS)
        self._keyed: dict[str, _Playing] = {}
        self._next: dict[str, tuple[_Playing, int]] = {}

    def start(self, cue: Cue) -> None:
        """Let a sound begin with the next block."""
        self._waiting.append(cue)

    def say(self, samples: Array, pan: float = 0.0) -> None:
        """Let a voice say something from the next block on, instead of what it says now.

        `samples` are at `SAMPLE_RATE`, (n,); without any, it falls silent. What is cut off fades.
        """
        self.play("voice", samples, pan)

    def play(
        self, key: str, samples: Array, pan: float = 0.0, fade_s: float = USUAL_FADE_S
    ) -> None:
        """Let a sound be heard from the next block on, instead of the one with the same key.

        That one fades out in `fade_s`; without samples there is silence after it.
        """
        self._next[key] = _Playing(samples, _gains(pan)), max(round(fade_s * SAMPLE_RATE), 1)

    def render(self, count: int) -> NDArray[np.float32]:
        """Return the next samples, (count, 2)."""
        while self._waiting:
            self._begin(self._waiting.popleft())
        while self._next:
            self._exchange(*self._next.popitem())
        block = np.zeros((count, 2))
        for sound in self._playing:
            part, sound.samples = sound.samples[:count], sound.samples[count:]
            block[: len(part)] += part[:, None] * sound.gains
        self._playing = deque((s for s in self._playing if len(s.samples)), MAX_SOUNDS)
        self._keyed = {key: sound for key, sound in self._keyed.items() if len(sound.samples)}
        return (self.volume * limit(block)).astype(np.float32)

    def _begin(self, cue: Cue) -> None:
        variants = self.bank.variants(cue.name)
        if not variants:
            return
        samples = variants[cue.variant % len(variants)]
        if cue.rate != 1.0:
            wanted = np.arange(0.0, len(samples) - 1.0, cue.rate)
            samples = np.interp(wanted, np.arange(len(samples)), samples)
        self._playing.append(_Playing(samples, cue.gain * _gains(cue.pan)))

    def _exchange(self, key: str, change: tuple[_Playing, int]) -> None:
        """Begin a sound, and let the one with its key fade out over a number of samples."""
        following, count = change
        if key in self._keyed:
            playing = self._keyed.pop(key)
            fade = playing.samples[:count]
            playing.samples = fade * np.linspace(1.0, 0.0, count)[: len(fade)]
        if len(following.samples):
            self._keyed[key] = following
            self._playing.append(following)


def _gains(pan: float) -> Array:
    """Return the amplitudes on the left and right, (2,): as loud at the side as in the middle."""
    angle = (pan + 1.0) * np.pi / 4.0
    return np.array([np.cos(angle), np.sin(angle)])


def limit(block: Array) -> Array:
    """Return samples bent so that none is beyond `CEILING`; quiet ones are unchanged.

    >>> limit(np.array([-0.5, 0.6, 3.0])).round(3).tolist()
    [-0.5, 0.6, 0.95]
    """
    loud = np.maximum(np.abs(block) - KNEE, 0.0)
    if not loud.any():
        return block
    room = CEILING - KNEE
    return np.sign(block) * (np.minimum(np.abs(block), KNEE) + room * np.tanh(loud / room))
