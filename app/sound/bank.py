"""The sounds of a session: synthesised when first needed, or read from a folder of WAV files."""

import re
import wave
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import Self

import numpy as np

from cubeling.app.errors import AppError
from cubeling.app.sound.sounds import SOUNDS, Sound
from cubeling.app.sound.synthesis import SAMPLE_RATE, Array, with_level
from cubeling.files import whole_file

VARIANT_COUNT = 4
"""Variants of each synthesised sound, which differ a little, so that repetition does not tire."""

MAX_FILE_S = 10.0
"""Longest sound that a file may hold [s]."""

_FILE_NAME = re.compile(r"(?P<name>.+?)(-\d+)?")


class SoundBank:
    """Sounds by name, each in one or more variants of samples (n,).

    Parameters
    ----------
    own
        Sounds that replace those of `SOUNDS`, or are added to them.
    """

    def __init__(self, own: dict[str, list[Array]] | None = None) -> None:
        self._variants = dict(own or {})

    @classmethod
    def load(cls, folder: Path | None, actions: Iterable[str] = ()) -> Self:
        """Return the sounds, with those of a folder instead of ours.

        The files are called NAME.wav, or NAME-1.wav, NAME-2.wav … for variants that take turns. A
        name is one of `SOUNDS`, or one of the `actions` of the character.

        Raises AppError if there is no folder, no WAV file in it, or one that cannot be used.
        """
        if folder is None:
            return cls()
        files = sorted(folder.glob("*.wav")) if folder.is_dir() else []
        if not files:
            raise AppError(f"there are no .wav files in a folder '{folder}'")
        known, own = {*SOUNDS, *actions}, dict[str, list[Array]]()
        for file in files:
            match = _FILE_NAME.fullmatch(file.stem)
            name = match["name"] if match and match["name"] in known else file.stem
            if name not in known:
                names = ", ".join(sorted(known))
                raise AppError(f"no sound is called '{name}' ({file}): choose one of {names}")
            own.setdefault(name, []).append(read_sound(file))
        return cls(own)

    def variants(self, name: str) -> list[Array]:
        """Return the variants of a sound; none for an unknown name."""
        if name not in self._variants:
            self._variants[name] = synthesise(SOUNDS[name], name) if name in SOUNDS else []
        return self._variants[name]

    def prepare(self) -> None:
        """Synthesise all sounds now; it takes about half a second."""
        for name in SOUNDS:
            self.variants(name)


def synthesise(sound: Sound, name: str, count: int = VARIANT_COUNT) -> list[Array]:
    """Return variants of a sound, such as one of `SOUNDS`, with its name: always the same."""
    seed = zlib.crc32(name.encode())
    return [
        with_level(sound.make(np.random.default_rng([seed, variant])), sound.level)
        for variant in range(count)
    ]


def read_sound(path: Path) -> Array:
    """Return the samples of a sound file, mixed to one channel at `SAMPLE_RATE`.

    Raises AppError if it cannot be read, or is longer than `MAX_FILE_S`.
    """
    from cubeling.characters import CharacterError  # few sessions have sounds of their own
    from cubeling.characters.speech import read_speech

    try:
        sound = read_speech(path, MAX_FILE_S)
    except CharacterError as error:
        raise AppError(str(error)) from error
    wanted = np.arange(0.0, len(sound.samples) - 0.5, sound.rate / SAMPLE_RATE)
    return np.asarray(np.interp(wanted, np.arange(len(sound.samples)), sound.samples))


def write_wave(path: Path, samples: Array) -> None:
    """Write samples (n,) to a WAV file of 16 bits."""
    with whole_file(path, AppError) as partial, wave.open(str(partial), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(SAMPLE_RATE)
        file.writeframes(np.round(samples * 32767.0).astype("<i2").tobytes())
