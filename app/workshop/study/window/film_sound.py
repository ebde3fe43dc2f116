"""The sound of films that are shown in the study's window."""

import time
from collections.abc import Callable, Sequence
from pathlib import Path

import av
import numpy as np

from cubeling.app.errors import AppError
from cubeling.app.sound import SAMPLE_RATE, Loudspeaker, Mixer, SoundBank, SoundOutput
from cubeling.app.sound.synthesis import Array
from cubeling.app.workshop.study.participants.stimulus_files import STIMULUS_FILE
from cubeling.characters import CharacterError
from cubeling.characters.speech import read_speech, resample
from cubeling.robot import Closeable

OPENING_S = 3.0
"""How long the first film waits for the loudspeaker [s], so that its sound is not late."""

PAIR_PAN = 0.6
"""Where the sound of a film is heard that is one of two, −1 left … 1 right."""


def sound_of(film: Path) -> Array:
    """Return the sound of a film, (n,) at `SAMPLE_RATE`, its channels averaged; none for silence.

    Raises AppError if it has sound that cannot be read.
    """
    STIMULUS_FILE.check(film)
    try:
        with av.open(f"file:{film}", metadata_errors="replace") as container:
            if not container.streams.audio:
                return np.zeros(0)
        sound = read_speech(film)
    except (CharacterError, av.FFmpegError) as error:
        raise AppError(f"the sound of '{film}' cannot be read: {error}") from error
    return np.asarray(resample(sound.samples, sound.rate, SAMPLE_RATE), float)


class FilmSounds(Closeable):
    """Plays the sound of films. Whoever makes it closes it; a second `close` does nothing.

    Parameters
    ----------
    say
        Called with a line if films stay silent, once.
    loudspeaker
        Opens what is heard; it is opened with the first film that has sound.
    """

    def __init__(
        self,
        say: Callable[[str], None],
        loudspeaker: Callable[[Mixer], SoundOutput] = Loudspeaker,
    ) -> None:
        self._say, self._loudspeaker = say, loudspeaker
        self._mixer = Mixer(SoundBank())
        self._output: SoundOutput | None = None

    def prepare(self, sounds: Sequence[Array]) -> None:
        """Open the loudspeaker if there is something to hear, and wait until it plays."""
        if self._output is not None or not any(map(len, sounds)):
            return
        self._output = self._loudspeaker(self._mixer)
        end = time.monotonic() + OPENING_S
        while not (self._output.playing or self._output.problem) and time.monotonic() < end:
            time.sleep(0.01)
        if not self._output.playing:
            self._say(f"films are shown without their sound: {self._output.problem or 'no answer'}")

    def play(self, place: int, count: int, sound: Array) -> None:
        """Let a film be heard from its beginning; it is one of so many, from left to right."""
        self._mixer.play(f"{place}", sound, PAIR_PAN * (2 * place - 1) if count == 2 else 0.0)

    def hush(self, count: int) -> None:
        """Let so many films fall silent."""
        for place in range(count):
            self._mixer.play(f"{place}", np.zeros(0))

    def close(self) -> None:
        """Let go of the loudspeaker."""
        if self._output is not None:
            self._output.close()
