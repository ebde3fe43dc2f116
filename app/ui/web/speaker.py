"""The sound of a session on the pages."""

import threading
import time

import numpy as np

from cubeling.app.sound import SAMPLE_RATE, Mixer
from cubeling.app.ui.web.messages import SOUND, pack
from cubeling.app.ui.web.server import WebServer

BLOCK_S = 0.02
"""Length of a block of samples [s]."""


class PageSpeaker:
    """Lets all pages hear a mixer, as a `SoundOutput`; silence is not sent."""

    def __init__(self, mixer: Mixer, server: WebServer) -> None:
        self.playing = True
        """Whether cues are heard now."""
        self.problem = ""
        """Nothing is wrong: a page that is not heard says so itself."""
        self._mixer, self._server = mixer, server
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="page speaker", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Fall silent; a second call does nothing."""
        self.playing = False
        self._closing.set()
        self._thread.join(1.0)

    def _run(self) -> None:
        self._mixer.bank.prepare()
        began, number = time.monotonic(), 0
        while not self._closing.wait(max(began + number * BLOCK_S - time.monotonic(), 0.0)):
            samples = self._mixer.render(round(BLOCK_S * SAMPLE_RATE))
            if samples.any():
                data = np.round(32767 * samples).astype("<i2").tobytes()
                self._server.sound(pack(SOUND, number, number * BLOCK_S, data))
            number += 1
            if time.monotonic() - began - number * BLOCK_S > 10 * BLOCK_S:
                began, number = time.monotonic(), 0  # the computer slept, or was too slow
