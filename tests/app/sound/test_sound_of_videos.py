"""The sound of a video: in time with its pictures, to the millisecond."""

from contextlib import ExitStack
from pathlib import Path

import av
import numpy as np
import pytest

from cubeling.app.commands.play import progress
from cubeling.app.running.screens import open_sound
from cubeling.app.session import SessionOptions
from cubeling.app.sound import Cue, Mixer, SessionSound, SoundBank, SoundCues
from cubeling.app.ui.video_file import VideoFile
from cubeling.characters import Animator, Character
from cubeling.characters.control.layers import FootLockLayer
from tests.characters.commands import command
from tests.examples import some

TICK = np.full(480, 0.8) * np.sin(np.arange(480) * 2 * np.pi / 24)
"""10 ms of 2 kHz."""


def decoded(path):
    """Return the samples of a video's first channel, and the time of the first one."""
    with av.open(str(path)) as file:
        frames = list(file.decode(audio=0))
        assert {frame.layout.name for frame in frames} == {"stereo"}
        return np.concatenate([f.to_ndarray()[0] for f in frames]), frames[0].time


def onsets(path, level=0.1):
    """Return when something is heard after silence [s]."""
    samples, start = decoded(path)
    loud = np.flatnonzero(np.abs(samples) > level)
    first = np.insert(np.diff(loud) > 2400, 0, True)
    return start + loud[first] / 48_000


def flashes(path):
    """Return the times of the bright pictures of a video [s]."""
    with av.open(str(path)) as file:
        return [f.time for f in file.decode(video=0) if f.to_ndarray(format="gray").mean() > 128]


@pytest.mark.parametrize("suffix", some([".mp4", ".webm", ".mkv"]))
@pytest.mark.parametrize("live", [False, True])
def test_a_sound_is_heard_with_its_picture(tmp_path, suffix, live):
    gaps = np.random.default_rng(5).choice([0.02, 0.033, 0.05, 0.3], 60) if live else [1 / 30] * 60
    path, mixer = tmp_path / f"out{suffix}", Mixer(SoundBank({"tick": [TICK]}))
    with VideoFile(path, (64, 48), 30, mixer.render) as video:
        for index, time in enumerate(1000.0 + np.cumsum(gaps)):
            seen = 255 if index % 15 == 7 else 0
            video.write(np.full((48, 64, 3), seen, np.uint8), float(time))
            if seen:
                mixer.start(Cue("tick"))
    assert len(flashes(path)) == 4
    assert onsets(path) == pytest.approx(flashes(path), abs=0.002)
    with av.open(str(path)) as file:
        assert file.streams.audio[0].codec.name == ("aac" if suffix == ".mp4" else "opus")
        assert file.streams.video[0].index == 0


@pytest.mark.full
def test_steps_are_heard_within_a_frame_of_the_contact(tmp_path):
    human, path = Character.load("human"), tmp_path / "walk.mp4"
    animator, cues = Animator(human), SoundCues(human)
    mixer, landed = Mixer(SoundBank()), []
    lock = next(each.lock for each in animator._layers if isinstance(each, FootLockLayer))
    assert lock is not None
    held = [True, True]
    with VideoFile(path, (64, 48), 30, mixer.render) as video:
        for frame in range(90):
            going = command(frame / 30, "move", 2.0, np.array([0.0, 9.0]), stop=False)
            posed = animator.update(going)
            before, held = held, [foot.held for foot in lock.feet]
            landed += [frame / 30 for a, b in zip(before, held, strict=True) if b and not a]
            video.write(np.zeros((48, 64, 3), np.uint8), frame / 30)
            for cue in cues._feet.update(posed):
                mixer.start(cue)
    heard = onsets(path, level=0.02)
    assert len(heard) >= 4
    for time in heard:
        assert min(abs(time - contact) for contact in landed) < 1.1 / 30


def test_a_gif_and_a_video_without_sound_have_none(tmp_path):
    mixer = Mixer(SoundBank({"tick": [TICK]}))
    mixer.start(Cue("tick"))
    for name, sound in (("a.gif", mixer.render), ("a.mp4", None)):
        with VideoFile(tmp_path / name, (64, 48), 30, sound) as video:
            video.write(np.zeros((48, 64, 3), np.uint8), 0.0)
        with av.open(str(tmp_path / name)) as file:
            assert not file.streams.audio
    assert mixer.render(1000).any()  # it was asked for nothing before


def test_the_end_of_a_video_fades_out(tmp_path):
    mixer = Mixer(SoundBank({"hum": [0.5 * np.sin(np.arange(96_000) / 30)]}))
    path = tmp_path / "a.mkv"
    mixer.start(Cue("hum"))
    with VideoFile(path, (64, 48), 10, mixer.render) as video:
        for index in range(5):
            video.write(np.zeros((48, 64, 3), np.uint8), index / 10)
    samples, _ = decoded(path)
    assert len(samples) / 48_000 == pytest.approx(0.5, abs=0.03)
    assert np.abs(samples[round(0.495 * 48_000) :]).max() < 0.05
    assert np.abs(samples[:12_000]).max() > 0.3


def test_a_rendered_session_is_heard(cubeling, short_session):
    assert cubeling("replay", short_session, "--end", "0.41", "-o", "short.mp4")[0] == 0
    assert onsets("short.mp4", level=0.02) == pytest.approx([0.3], abs=0.01)  # the cube is put down


@pytest.mark.parametrize(
    ("arguments", "muted", "volume"),
    [([], False, 0.5), (["--mute"], True, 0.5), (["--volume", "0.2"], False, 0.2)],
)
def test_the_command_line_and_the_environment_of_a_lab_mute(
    cubeling, short_session, monkeypatch, arguments, muted, volume
):
    played = []
    monkeypatch.setattr(progress, "play_session", lambda options, *_, **__: played.append(options))
    for mute in ("0", "1"):
        monkeypatch.setenv("CUBELING_MUTE", mute)
        assert cubeling("replay", short_session, *arguments)[0] == 0
    assert [(options.muted, options.volume) for options in played] == [
        (muted, volume),
        (True, volume),
    ]
    assert cubeling("replay", short_session, "--no-mute")[0] == 0  # stronger than the environment
    assert not played[-1].muted
    code, _, err = cubeling("replay", short_session, "--volume", "2")
    assert code == 2
    assert "--volume" in err


@pytest.mark.parametrize(
    ("changes", "heard"),
    [
        ({"output": "a.mp4"}, True),
        ({"output": "a.MKV"}, True),
        ({"output": "a.mp4", "muted": True}, False),
        ({"output": "a.gif"}, False),
        ({"output": "a.png"}, False),
        ({"pictures": False}, False),
    ],
)
def test_only_what_is_shown_is_heard(changes, heard):
    changes = {**changes, "output": Path(changes["output"]) if "output" in changes else None}
    options = SessionOptions(scenario="follow", source="x", **changes)
    with ExitStack() as closing:
        assert (open_sound(options, Character.load("human"), closing) is not None) == heard


def test_a_muted_session_starts_no_loudspeaker_until_it_is_to_be_heard(monkeypatch):
    started: list[Mixer] = []
    monkeypatch.setattr("cubeling.app.sound.session_sound.Loudspeaker", started.append)
    sound = SessionSound(Mixer(SoundBank()), live=True, muted=True)
    assert (started, sound.problem) == ([], "")
    sound.muted = False
    assert len(started) == 1
