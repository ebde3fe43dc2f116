"""`cubeling speak`: texts and recordings as videos, sounds and motions."""

import wave

import av
import numpy as np
import pytest

from cubeling.app.sound import write_wave
from cubeling.app.speaking import voices
from cubeling.characters import load_motion
from cubeling.characters.control.speech_profile import SpeechProfile
from cubeling.characters.speech.voices import VoiceError
from cubeling.characters.speech.voices.espeak import espeak_installed

needs_espeak = pytest.mark.skipif(not espeak_installed(), reason="eSpeak NG is not installed")


@needs_espeak
def test_a_text_becomes_a_video_with_its_sound(cubeling, tmp_path):
    path = tmp_path / "hello.mp4"
    cubeling("speak", "Hello!", "-o", str(path), "--size", "160x120", "--rate", "10", "--subtitles")
    with av.open(str(path)) as file:
        sound = np.concatenate([f.to_ndarray() for f in file.decode(audio=0)], axis=1)
    with av.open(str(path)) as file:
        pictures = [frame.to_ndarray(format="bgr24") for frame in file.decode(video=0)]
    assert pictures[0].shape == (120, 160, 3)
    assert len(pictures) >= 20
    start = np.flatnonzero(np.abs(sound).max(axis=0) > 0.02)[0] / 48_000
    assert 0.55 < start < 0.75  # the lead is 0.6 s


@needs_espeak
def test_a_text_becomes_a_sound_or_a_motion(cubeling, tmp_path):
    cubeling("speak", "Hello!", "-o", str(tmp_path / "a.wav"), "--lang", "es")
    with wave.open(str(tmp_path / "a.wav")) as file:
        assert file.getnframes() > 0.3 * file.getframerate()
    cubeling("speak", "Hello!", "-o", str(tmp_path / "a.bvh"), "--rate", "20")
    clip = load_motion(tmp_path / "a.bvh", scale=1.0).clip
    assert clip.rate == pytest.approx(20)
    assert clip.duration > 2.0


def test_a_recording_without_a_text_needs_no_voice(cubeling, tmp_path, monkeypatch):
    def gone():
        raise VoiceError("no voice")

    monkeypatch.setattr(voices, "espeak", gone)
    time = np.arange(24_000) / 48_000
    write_wave(tmp_path / "a.wav", 0.3 * np.sin(2 * np.pi * 150 * time))
    out = tmp_path / "a.bvh"
    cubeling("speak", "--audio", str(tmp_path / "a.wav"), "-o", str(out))
    assert out.exists()


@needs_espeak
def test_a_profile_is_saved_and_read_again(cubeling, tmp_path):
    profile = tmp_path / "my.toml"
    out = tmp_path / "a.bvh"
    cubeling(
        "speak", "Hi", "-o", str(out), "--set", "database=aggressive",
        "--set", "gesture_emphasis=0.5", "--save-profile", str(profile),
    )  # fmt: skip
    assert SpeechProfile.load(str(profile)) == SpeechProfile("aggressive", gesture_emphasis=0.5)
    cubeling("speak", "Hi", "-o", str(out), "--overwrite", "--profile", str(profile))


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        ((), "there is nothing to say"),
        (("  ",), "there is nothing to say"),
        (("Hi", "--emotion", "purple"), "no emotion is called 'purple'"),
        (("Hi", "--character", "nobody"), "no bundled character 'nobody'"),
        (("Hi", "-o", "a.txt"), ".wav"),
        (("Hi", "--set", "gesture_emphasis=3"), "gesture_emphasis must be from -1 to 1, not 3"),
        (("Hi", "--set", "database=loud"), "database must be one of aggressive, neutral, full"),
        (("Hi", "--set", "visemes=none"), "visemes must be one of oculus"),
        (("Hi", "--set", "volume=1"), "volume means nothing here; there are database, threshold"),
        (("Hi", "--set", "threshold=much"), "threshold must be a number, not 'much'"),
        (("Hi", "--set", "threshold"), "write threshold=VALUE"),
        (("Hi", "--profile", "loud"), "there is no profile 'loud': choose one of usual, lively"),
        (("Hi", "--file", "missing.txt"), "missing.txt"),
        (("--audio", "missing.wav"), "missing.wav"),
        (("<begin_gesture id='a' anim='fly'/>Hi<end_gesture id='a'/>",), "no gesture 'fly'"),
        (("<begin_gesture id='a' anim='nod'/>Hi",), "never ends"),
    ],
)
def test_bad_input_is_one_line(cubeling, tmp_path, arguments, problem):
    code, _, error = cubeling("speak", *arguments)
    assert code == 2
    assert problem in error
    assert error.count("\n") == 1
    assert not list(tmp_path.glob("*.mp4*"))


def test_without_a_voice_the_package_is_named(cubeling, monkeypatch):
    def gone():
        raise VoiceError("no voice is installed, such as eSpeak NG", "apt-get install -y espeak-ng")

    monkeypatch.setattr(voices, "espeak", gone)
    code, _, error = cubeling("speak", "Hi", "-o", "a.wav")
    assert code == 2
    assert "apt-get install -y espeak-ng" in error
