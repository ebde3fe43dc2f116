"""Playing a mixer on the computer's loudspeaker, through PortAudio, on threads of its own."""

import shutil
import threading
from typing import Any

from cubeling.app.errors import AppError
from cubeling.app.sound.mixer import Mixer
from cubeling.app.sound.synthesis import SAMPLE_RATE

LATENCY_S = 0.025
"""How long a sample waits in buffers before it is heard [s]: less than a frame, and long enough for
the interpreter's other threads. The system may choose another latency."""

SILENT_S = 3.0
"""A loudspeaker that asks for no samples for so long is lost [s]."""

CLOSE_TIMEOUT_S = 1.0
"""How long a session waits at its end for a loudspeaker that does not answer [s]."""

INSTALL = "pip install sounddevice"
"""Adds what the extra `[sound]` consists of, wherever Cubeling was installed from."""


class NoSoundError(AppError):
    """There is no sound on this computer; `remedy` says how to add it, or is ""."""

    def __init__(self, message: str, remedy: str = "") -> None:
        super().__init__(message)
        self.remedy = remedy

    @property
    def advice(self) -> str:
        """What is wrong and how to mend it, in one line."""
        return f"{self}: {self.remedy}" if self.remedy else str(self)


def load_portaudio() -> Any:
    """Return the module `sounddevice`; raise NoSoundError if it or its library is missing."""
    try:
        import sounddevice  # an extra; loading it takes a while and may print
    except ImportError as error:
        raise NoSoundError("the library sounddevice is not installed", INSTALL) from error
    except OSError as error:  # PortAudio is in the wheels for Windows and macOS only
        if shutil.which("apt-get"):
            remedy = "sudo apt-get install -y libportaudio2"
        else:
            remedy = "install the package portaudio of your system"
        raise NoSoundError("the library PortAudio is missing", remedy) from error
    return sounddevice


def open_stream(sounddevice: Any, callback: Any) -> Any:
    """Return an open, silent stream to the usual loudspeaker; NoSoundError if there is none."""
    settings = {
        "samplerate": SAMPLE_RATE,
        "channels": 2,
        "dtype": "float32",
        "latency": LATENCY_S,
        "callback": callback,
    }
    try:
        for api in sounddevice.query_hostapis():
            # The usual interface of Windows, MME, takes 90 ms. This one converts sample rates.
            if api["name"] == "Windows WASAPI" and api["default_output_device"] >= 0:
                settings["device"] = api["default_output_device"]
                settings["extra_settings"] = sounddevice.WasapiSettings(auto_convert=True)
        return sounddevice.OutputStream(**settings)
    except (sounddevice.PortAudioError, ValueError) as error:
        raise NoSoundError(f"no loudspeaker can be opened: {_first_line(error)}") from error


class Loudspeaker:
    """Plays what a mixer renders. No method waits for the device, except `close` for a moment.

    Whoever makes it closes it; a second `close` does nothing.
    """

    def __init__(self, mixer: Mixer) -> None:
        self.playing = False
        """Whether cues are heard now."""
        self.problem = ""
        """Why nothing is heard; "" while all is well or the device is being opened."""
        self.latency = 0.0
        """How long a sample waits until it is heard, as the system says [s]."""
        self.underflows = 0
        """How often the samples came too late."""
        self._mixer = mixer
        self._blocks = 0
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="loudspeaker", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Fall silent, within a bounded time."""
        self._closing.set()
        self._thread.join(CLOSE_TIMEOUT_S)

    def _run(self) -> None:
        try:
            sounddevice = load_portaudio()
            self._mixer.bank.prepare()
            stream = open_stream(sounddevice, self._fill)
        except NoSoundError as error:
            self.problem = error.advice
            return
        try:
            stream.start()
            self.latency = float(stream.latency)
            self.playing = True
            self._watch(stream)
        except sounddevice.PortAudioError as error:
            self.problem = f"the loudspeaker was lost: {_first_line(error)}"
        finally:
            self.playing = False
            stream.close(ignore_errors=True)

    def _watch(self, stream: Any) -> None:
        """Return at the end of the session, or when the device has fallen silent."""
        before = -1
        while not self._closing.wait(SILENT_S):
            if not stream.active or self._blocks == before:
                self.problem = "the loudspeaker was lost"
                return
            before = self._blocks

    def _fill(self, block: Any, count: int, _time: Any, status: Any) -> None:
        """Fill a block of samples (count, 2); called by PortAudio on its own thread."""
        self._blocks += 1
        self.underflows += bool(status.output_underflow)
        block[:] = self._mixer.render(count)


def _first_line(error: Exception) -> str:
    return str(error).partition("\n")[0]
