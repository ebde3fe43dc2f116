"""Sound files of every kind become one channel at their own rate, or one line."""

import struct
import wave

import av
import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters.errors import CharacterError
from cubeling.characters.speech.audio import read_speech, resample


def tone(rate, seconds=0.5, frequency=440.0):
    return 0.5 * np.sin(2 * np.pi * frequency * np.arange(round(rate * seconds)) / rate)


def riff(kind, bits, channels, rate, data, size=None):
    """Return the bytes of a WAV file."""
    frame = channels * bits // 8
    form = struct.pack("<HHIIHH", kind, channels, rate, rate * frame, frame, bits)
    chunks = b"fmt " + struct.pack("<I", len(form)) + form + b"LIST\x03\x00\x00\x00abc\x00"
    chunks += b"data" + struct.pack("<I", len(data) if size is None else size) + data
    return b"RIFF" + struct.pack("<I", 4 + len(chunks)) + b"WAVE" + chunks


def encoded(values, kind, bits):
    if kind == 3:
        return values.astype(f"<f{bits // 8}").tobytes()
    if bits == 8:
        return np.rint(values * 127 + 128).astype(np.uint8).tobytes()
    whole = np.rint(values * (2.0 ** (bits - 1) - 1)).astype("<i4" if bits > 16 else "<i2")
    if bits == 24:
        return whole.view(np.uint8).reshape(-1, 4)[:, :3].tobytes()
    return whole.tobytes()


@pytest.mark.parametrize("rate", [8000, 44_100, 96_000])
@pytest.mark.parametrize(("kind", "bits"), [(1, 8), (1, 16), (1, 24), (1, 32), (3, 32), (3, 64)])
def test_every_kind_of_wav_has_the_same_samples(tmp_path, rate, kind, bits):
    path = tmp_path / "tone.wav"
    path.write_bytes(riff(kind, bits, 1, rate, encoded(tone(rate), kind, bits)))
    speech = read_speech(path)
    assert speech.rate == rate
    assert np.abs(speech.samples - tone(rate)).max() < (0.01 if bits == 8 else 1e-4)


def test_the_channels_of_stereo_are_averaged(tmp_path):
    path = tmp_path / "stereo.wav"
    both = np.stack([tone(16_000), np.zeros(8000)], 1)
    path.write_bytes(riff(1, 16, 2, 16_000, encoded(both, 1, 16)))
    assert np.abs(read_speech(path).samples - tone(16_000) / 2).max() < 1e-4


@pytest.mark.parametrize(("codec", "suffix"), [("flac", ".flac"), ("pcm_mulaw", ".wav")])
def test_other_codecs_are_decoded(tmp_path, codec, suffix):
    path = tmp_path / f"tone{suffix}"
    with av.open(str(path), "w") as container:
        stream = container.add_stream(codec, rate=16_000, layout="mono")
        samples = (tone(16_000) * 32767).astype(np.int16)[None]
        frame = av.AudioFrame.from_ndarray(samples, format="s16", layout="mono")
        frame.rate = 16_000
        for packet in [*stream.encode(frame), *stream.encode(None)]:
            container.mux(packet)
    speech = read_speech(path)
    assert np.abs(speech.samples - tone(16_000)).max() < 0.02


def test_a_truncated_wav_is_read_as_far_as_it_goes(tmp_path):
    path = tmp_path / "cut.wav"
    path.write_bytes(riff(1, 16, 1, 16_000, encoded(tone(16_000), 1, 16))[:-4001])
    assert 5990 < len(read_speech(path).samples) < 6010


@pytest.mark.parametrize("size", [0, 0xFFFFFFFF])
def test_a_wav_from_a_pipe_says_no_size(tmp_path, size):
    path = tmp_path / "pipe.wav"
    path.write_bytes(riff(1, 16, 1, 16_000, encoded(tone(16_000), 1, 16), size))
    assert len(read_speech(path).samples) == 8000


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "no sound file"),
        (b"hello, this is text", "no sound file"),
        (b"RIFF\x00\x00\x00\x00WAVEfmt ", "broken WAV"),
        (riff(1, 16, 1, 16_000, b""), "has no sound"),
        (riff(3, 32, 1, 16_000, np.full(9, np.nan, "<f4").tobytes()), "not numbers"),
        (riff(1, 16, 1, 7, b"\x00" * 40), "samples a second"),
    ],
)
def test_what_is_no_sound_is_one_line(tmp_path, content, said):
    path = tmp_path / "file.wav"
    path.write_bytes(content)
    with pytest.raises(CharacterError, match=said) as caught:
        read_speech(path)
    assert "\n" not in str(caught.value)


def test_a_picture_has_no_sound_and_a_missing_file_is_named(tmp_path):
    with pytest.raises(CharacterError, match="cannot read"):
        read_speech(tmp_path / "missing.wav")
    with pytest.raises(CharacterError, match="cannot read"):
        read_speech(tmp_path)


@given(st.binary(max_size=60))
def test_any_bytes_after_a_wav_header_are_read_or_refused(tmp_path_factory, data):
    path = tmp_path_factory.getbasetemp() / "fuzz.wav"
    path.write_bytes(b"RIFF\x00\x00\x00\x00WAVE" + data)
    with pytest.raises(CharacterError):
        read_speech(path)


@pytest.mark.parametrize("lost", [*range(1, 60), 4000])
def test_a_cut_wav_file_is_read_as_far_as_it_goes_or_refused(tmp_path, lost):
    path = tmp_path / "cut.wav"
    with wave.open(str(path), "wb") as file:
        file.setparams((1, 2, 22_050, 0, "NONE", ""))
        file.writeframes(encoded(tone(22_050)[:20], 1, 16))
    path.write_bytes(path.read_bytes()[:-lost])
    if lost < 39:
        assert len(read_speech(path).samples) == 20 - -(-lost // 2)
    else:
        with pytest.raises(CharacterError, match=r"cut\.wav"):
            read_speech(path)


@pytest.mark.parametrize("new_rate", [8000, 11_025, 22_050, 44_100, 96_000])
def test_a_tone_stays_a_tone_at_another_rate(new_rate):
    made = resample(tone(48_000).astype(np.float32), 48_000, new_rate)
    inside = slice(new_rate // 50, new_rate // 2 - new_rate // 50)
    assert len(made) == -(-new_rate // 2)
    assert np.abs(made[inside] - tone(new_rate)[inside]).max() < 1e-4


def test_what_a_lower_rate_cannot_carry_is_gone():
    made = resample(tone(48_000, frequency=9500).astype(np.float32), 48_000, 16_000)
    assert np.abs(made[400:-400]).max() < 1e-3


def test_an_empty_sound_stays_empty():
    assert len(resample(np.zeros(0, np.float32), 48_000, 16_000)) == 0


def test_wave_of_the_standard_library_agrees(tmp_path):
    path = tmp_path / "tone.wav"
    with wave.open(str(path), "wb") as file:
        file.setparams((1, 2, 22_050, 0, "NONE", ""))
        file.writeframes(encoded(tone(22_050), 1, 16))
    assert np.abs(read_speech(path).samples - tone(22_050)).max() < 1e-4
