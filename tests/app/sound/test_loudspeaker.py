"""The loudspeaker: without it, a session is silent, and says so once."""

import sys
import threading
from types import SimpleNamespace

import numpy as np
import pytest

from cubeling.app.sound import Cue, Loudspeaker, Mixer, SoundBank, loudspeaker


class PortAudioError(Exception):
    pass


class FakeStream:
    """Plays blocks when told to."""

    def __init__(self, sound, **settings):
        self.callback = settings["callback"]
        self.active, self.latency, self.closed = True, settings["latency"], False
        sound.streams.append(self)

    def start(self):
        pass

    def close(self, ignore_errors=True):
        self.closed = True

    def play(self, count=480):
        block = np.ones((count, 2), np.float32)
        self.callback(block, count, None, SimpleNamespace(output_underflow=False))
        return block


@pytest.fixture
def portaudio(monkeypatch):
    """A library with one loudspeaker."""
    sound = SimpleNamespace(streams=[], PortAudioError=PortAudioError)
    sound.query_hostapis = lambda: [{"name": "ALSA", "default_output_device": 0}]
    sound.OutputStream = lambda **settings: FakeStream(sound, **settings)
    monkeypatch.setitem(sys.modules, "sounddevice", sound)
    monkeypatch.setattr(SoundBank, "prepare", lambda bank: None)
    return sound


def until(condition):
    """Wait for another thread; it takes a moment only."""
    tick = threading.Event()
    for _ in range(2000):
        if condition():
            return True
        tick.wait(0.001)
    return False


def silent_mixer():
    return Mixer(SoundBank({"a": [np.full(100, 0.5)]}))


def test_cues_are_played(portaudio):
    mixer = silent_mixer()
    speaker = Loudspeaker(mixer)
    assert until(lambda: speaker.playing)
    stream = portaudio.streams[0]
    assert not stream.play().any()
    mixer.start(Cue("a"))
    assert stream.play()[50, 0] == pytest.approx(0.5 * np.sqrt(0.5))
    speaker.close()
    speaker.close()
    assert stream.closed
    assert (speaker.playing, speaker.problem) == (False, "")


def test_a_missing_library_and_a_missing_device_are_one_line(portaudio, monkeypatch):
    def no_device(**settings):
        raise PortAudioError("Error querying device -1\nmore")

    portaudio.OutputStream = no_device
    speaker = Loudspeaker(silent_mixer())
    assert until(lambda: speaker.problem)
    assert speaker.problem == "no loudspeaker can be opened: Error querying device -1"
    monkeypatch.setitem(sys.modules, "sounddevice", None)  # importing it fails
    speaker = Loudspeaker(silent_mixer())
    assert until(lambda: speaker.problem)
    assert speaker.problem.endswith("not installed: pip install sounddevice")


@pytest.mark.parametrize("how", ["inactive", "silent"])
def test_a_device_that_is_unplugged_ends_in_silence(portaudio, monkeypatch, how):
    monkeypatch.setattr(loudspeaker, "SILENT_S", 0.02)
    speaker = Loudspeaker(silent_mixer())
    assert until(lambda: portaudio.streams)
    portaudio.streams[0].play()
    portaudio.streams[0].active = how != "inactive"
    assert until(lambda: speaker.problem)
    assert speaker.problem == "the loudspeaker was lost"
    assert until(lambda: not speaker.playing)
    speaker.close()


def test_a_session_asks_windows_for_its_fast_interface(portaudio):
    asked = {}
    portaudio.query_hostapis = lambda: [
        {"name": "MME", "default_output_device": 3},
        {"name": "Windows WASAPI", "default_output_device": 7},
    ]
    portaudio.WasapiSettings = lambda auto_convert: f"convert {auto_convert}"
    portaudio.OutputStream = lambda **settings: asked.update(settings)
    loudspeaker.open_stream(portaudio, None)
    assert (asked["device"], asked["extra_settings"]) == (7, "convert True")
