"""The microphone: blocks of sound from the computer's usual input, through PortAudio."""

import queue
from typing import Any

import numpy as np

from cubeling.app.sound.loudspeaker import NoSoundError, load_portaudio
from cubeling.characters.speech import Samples

MICROPHONE_HZ = 16_000
"""Sample rate [Hz]."""

BLOCK = MICROPHONE_HZ // 100
"""Samples that come at once."""

MAX_BLOCKS = 200
"""Blocks that wait at most, two seconds; older ones are forgotten."""

SILENT_S = 3.0
"""A microphone that sends nothing for so long is lost [s]."""


class Microphone:
    """Listens to the usual microphone. Whoever makes it closes it; a second `close` does nothing.

    Raises NoSoundError if there is none.
    """

    def __init__(self) -> None:
        self._blocks: queue.Queue[Samples] = queue.Queue(MAX_BLOCKS)
        sounddevice = load_portaudio()
        try:
            self._stream: Any = sounddevice.InputStream(
                samplerate=MICROPHONE_HZ,
                blocksize=BLOCK,
                channels=1,
                dtype="float32",
                latency="low",
                callback=self._take,
            )
            self._stream.start()
        except (sounddevice.PortAudioError, ValueError) as error:
            line = str(error).partition("\n")[0]
            raise NoSoundError(f"no microphone can be opened: {line}") from error

    def read(self) -> Samples:
        """Return what was heard since the last call, (n,), at `MICROPHONE_HZ`."""
        blocks = [np.zeros(0, np.float32)]
        while True:
            try:
                blocks.append(self._blocks.get_nowait())
            except queue.Empty:
                return np.concatenate(blocks)

    def close(self) -> None:
        """Stop listening; errors of the device are ignored, as it may be gone."""
        self._stream.close(ignore_errors=True)

    def _take(self, block: Any, _count: int, _time: Any, _status: Any) -> None:
        """Take a block of samples (count, 1); called by PortAudio on its own thread."""
        if self._blocks.full():
            self._blocks.get_nowait()
        self._blocks.put_nowait(block[:, 0].copy())
