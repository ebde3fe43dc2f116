"""Sounds of one's own: read from WAV files, or refused in one line."""

import wave

import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.sound import SAMPLE_RATE, SoundBank, bank, write_wave
from cubeling.app.sound.bank import read_sound


def write(path, numbers, width=2, channels=1, rate=SAMPLE_RATE):
    with wave.open(str(path), "wb") as file:
        file.setnchannels(channels)
        file.setsampwidth(width)
        file.setframerate(rate)
        data = np.asarray(numbers, "<i4")
        if width == 1:
            data = data + 128
        file.writeframes(data.view(np.uint8).reshape(-1, 4)[:, :width].tobytes())


@pytest.mark.parametrize("width", [1, 2, 3, 4])
@pytest.mark.parametrize("channels", [1, 2])
def test_every_pcm_file_is_read(tmp_path, width, channels):
    top = 2 ** (8 * width - 1)
    sine = np.sin(np.arange(480) / 20)
    numbers = np.round(sine * 0.9 * (top - 1)).astype(np.int64)
    write(tmp_path / "a.wav", np.repeat(numbers, channels), width, channels)
    np.testing.assert_allclose(read_sound(tmp_path / "a.wav"), numbers / top, atol=1e-7)


def test_other_rates_are_converted(tmp_path):
    write(tmp_path / "a.wav", np.arange(441), rate=44_100)
    samples = read_sound(tmp_path / "a.wav")
    assert len(samples) == pytest.approx(480, abs=1)
    np.testing.assert_allclose(samples * 2**15, np.arange(len(samples)) * 44.1 / 48, atol=0.6)


def test_a_folder_replaces_some_sounds_and_keeps_the_others(tmp_path):
    for name in ("kiss-1", "kiss-2", "wave"):
        write_wave(tmp_path / f"{name}.wav", np.full(100, 0.25))
    mine = SoundBank.load(tmp_path, actions=["wave"])
    assert [len(mine.variants(name)) for name in ("kiss", "wave", "shout", "cheers")] == [
        2,
        1,
        4,
        0,
    ]
    np.testing.assert_allclose(mine.variants("wave")[0], 0.25, atol=1e-4)


def test_what_cannot_be_used_is_refused_in_one_line(tmp_path):
    with pytest.raises(AppError, match=r"no \.wav files"):
        SoundBank.load(tmp_path / "nowhere")
    path = tmp_path / "kis.wav"
    write_wave(path, np.zeros(10))
    with pytest.raises(AppError, match=r"no sound is called 'kis' .*: choose one of .*kiss"):
        SoundBank.load(tmp_path)
    path.rename(tmp_path / "kiss.wav").write_bytes(b"RIFF1234WAVEfmt ")
    with pytest.raises(AppError, match="is a broken WAV file"):
        SoundBank.load(tmp_path)
    write(tmp_path / "kiss.wav", np.zeros(11 * 8000), rate=8000)
    with pytest.raises(AppError, match="is longer than 10 s: cut it"):
        SoundBank.load(tmp_path)


def test_the_command_writes_sounds_that_can_be_played_again(cubeling, tmp_path, monkeypatch):
    monkeypatch.setattr(bank, "VARIANT_COUNT", 1)  # more take longer
    code, out, err = cubeling("sounds", "-o", "mine")
    assert (code, err) == (0, "")
    assert "the character kisses" in out
    mine, ours = SoundBank.load(tmp_path / "mine"), SoundBank()
    for name in ("step", "kiss"):
        for read, made in zip(mine.variants(name), ours.variants(name), strict=True):
            np.testing.assert_allclose(read, made, atol=5e-5)
    code, _, err = cubeling("sounds", "-o", "mine")
    assert code == 2
    assert "holds sounds already" in err
