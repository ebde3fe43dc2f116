"""A microphone: mouth and hands move at once, and stay quiet in silence."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest

from cubeling.app.sound import NoSoundError
from cubeling.app.speaking.live import LiveRealizer
from cubeling.app.speaking.microphone import BLOCK, MAX_BLOCKS, MICROPHONE_HZ, Microphone
from cubeling.characters import Character
from cubeling.characters.face.visemes.mouth_morphs import MouthMorphs

FRAME = 1 / 30


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


def voice(seconds, loudness=0.3):
    """Return an open vowel: harmonics of 120 Hz with much between 600 and 1100 Hz."""
    time = np.arange(round(seconds * MICROPHONE_HZ)) / MICROPHONE_HZ
    parts = [
        (number * 120.0, 1.0 if 500 < number * 120 < 1150 else 0.25) for number in range(1, 20)
    ]
    wave = sum(size * np.sin(2 * np.pi * hertz * time) for hertz, size in parts)
    return np.asarray(loudness * wave / np.abs(wave).max(), np.float32)


def performed(character, sound):
    """Return the time and the pose of each frame."""
    realizer, frames = LiveRealizer(character), []
    for number in range(int(len(sound) / MICROPHONE_HZ / FRAME)):
        now = (number + 1) * FRAME
        part = sound[round(number * FRAME * MICROPHONE_HZ) : round(now * MICROPHONE_HZ)]
        frames.append((now, realizer.update(part, now).pose))
    return frames


def opening(character, pose):
    mouth = MouthMorphs.of(character.morphs)
    return 0.0 if pose.morphs is None else float(pose.morphs[mouth.numbers].max())


def test_the_mouth_opens_within_sixty_milliseconds_and_closes_again(human):
    onset, length = 0.7, 0.4
    silence = np.zeros(round(onset * MICROPHONE_HZ), np.float32)
    frames = performed(human, np.concatenate([silence, voice(length), silence]))
    opened = [now for now, pose in frames if opening(human, pose) > 0.3]
    # A frame shows the sound up to its own time, so a frame of waiting is not the mouth's lag.
    assert onset < opened[0] <= onset + 0.06 + FRAME
    assert opened[-1] <= onset + length + 0.1 + FRAME


def test_hands_begin_to_beat_with_a_stressed_syllable(human):
    quiet, loud = voice(1.6, 0.05), voice(0.4, 0.6)
    frames = performed(human, np.concatenate([quiet, loud, quiet]))
    plain = performed(human, np.zeros(round(3.6 * MICROPHONE_HZ), np.float32))
    arms = [human.anatomy.joint(f"{side}UpperArm") for side in ("left", "right")]
    apart = [
        np.abs(one.rotations[arms] - other.rotations[arms]).max()
        for (_, one), (_, other) in zip(frames, plain, strict=True)
    ]
    late = [number * FRAME for number, each in enumerate(apart) if each > 0.1]
    assert any(1.6 < now < 2.4 for now in late)


def test_in_silence_nothing_moves(human):
    frames = performed(human, np.zeros(2 * MICROPHONE_HZ, np.float32))
    assert max(opening(human, pose) for _, pose in frames) == 0.0


class PortAudioError(Exception):
    pass


def fake(monkeypatch, open_stream):
    sound = SimpleNamespace(PortAudioError=PortAudioError, InputStream=open_stream)
    monkeypatch.setitem(sys.modules, "sounddevice", sound)


def test_a_microphone_gives_what_was_heard_and_forgets_what_is_too_old(monkeypatch):
    streams: list[SimpleNamespace] = []

    def opened(callback, **_settings):
        stream = SimpleNamespace(
            take=callback, start=lambda: None, close=lambda ignore_errors: streams.clear()
        )
        streams.append(stream)
        return stream

    fake(monkeypatch, opened)
    microphone = Microphone()
    for number in range(MAX_BLOCKS + 3):
        streams[0].take(np.full((BLOCK, 1), number, np.float32), BLOCK, None, None)
    heard = microphone.read()
    assert (heard[0], heard[-1], len(heard)) == (3, MAX_BLOCKS + 2, MAX_BLOCKS * BLOCK)
    assert len(microphone.read()) == 0
    microphone.close()
    assert not streams


def test_without_a_microphone_there_is_one_line(monkeypatch):
    def refused(**_settings):
        raise PortAudioError("Invalid device\nwith more lines")

    fake(monkeypatch, refused)
    with pytest.raises(NoSoundError, match=r"no microphone can be opened: Invalid device$"):
        Microphone()
