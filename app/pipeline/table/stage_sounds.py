"""Sounds that a scenario plays from files: they enter the pipeline as lines do."""

import math
from dataclasses import dataclass
from pathlib import Path

from cubeling.characters.speech import Samples


@dataclass(frozen=True)
class SoundSource:
    """Where a sound of a scenario comes from."""

    path: Path | None
    """Its file; None for one that Cubeling synthesises."""

    place: str
    """How messages name what asks for it, such as "my.show:12"."""


@dataclass(frozen=True, eq=False)
class SoundClip:
    """A sound of a scenario."""

    samples: Samples
    """The sound, (n,)."""

    rate: int
    """Sample rate of the sound [Hz]."""

    @property
    def duration(self) -> float:
        """How long it lasts [s]."""
        return len(self.samples) / self.rate


@dataclass(frozen=True)
class PlayedSound:
    """A sound that goes on in a frame."""

    key: str
    """Tells it from the others, and from the same one played again."""

    clip: SoundClip
    """Its samples, from its beginning."""

    start: float
    """When it began [s]."""

    volume: float = 1.0
    """Factor of its amplitude, 0…1."""

    silent_at: float = math.inf
    """When it has faded out that is cut off [s]; infinite for one that plays to its end."""
