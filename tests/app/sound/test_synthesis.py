"""The sounds themselves: gentle, as loud as they should be, and like what they stand for."""

import numpy as np
import pytest

from cubeling.app.sound import SAMPLE_RATE, SOUNDS
from cubeling.app.sound.bank import VARIANT_COUNT, SoundBank, synthesise
from cubeling.app.sound.synthesis import MAX_AMPLITUDE, loudness


@pytest.fixture(scope="module")
def bank():
    made = SoundBank()
    made.prepare()
    return made


def centroid(sound):
    """Return the centre of the spectrum [Hz]."""
    power = np.abs(np.fft.rfft(sound)) ** 2
    return float((power * np.fft.rfftfreq(len(sound), 1 / SAMPLE_RATE)).sum() / power.sum())


def pitch(sound, start, end):
    """Return the pitch between two times [Hz], by autocorrelation."""
    part = sound[round(start * SAMPLE_RATE) : round(end * SAMPLE_RATE)]
    spectrum = np.abs(np.fft.rfft(part * np.hanning(len(part)), 4 * len(part))) ** 2
    alike = np.fft.irfft(spectrum)
    low, high = round(SAMPLE_RATE / 1500), round(SAMPLE_RATE / 80)
    return SAMPLE_RATE / (low + int(np.argmax(alike[low:high])))


@pytest.mark.parametrize("name", SOUNDS)
def test_every_variant_is_gentle_and_as_loud_as_its_table_says(bank, name):
    for sound in bank.variants(name):
        assert np.isfinite(sound).all()
        assert np.abs(sound).max() <= MAX_AMPLITUDE
        assert loudness(sound) == pytest.approx(SOUNDS[name].level, abs=0.5)
        assert abs(sound.mean()) < 3e-3
        # It begins and ends in silence, and nothing in it clicks harder than a soft tap.
        assert np.abs(sound[[0, -1]]).max() < 1e-9
        assert 0.05 < len(sound) / SAMPLE_RATE < 1.5


@pytest.mark.parametrize("name", SOUNDS)
def test_variants_differ_and_are_the_same_every_time(bank, name):
    variants = bank.variants(name)
    assert len(variants) == VARIANT_COUNT
    assert len({variant.tobytes() for variant in variants}) == VARIANT_COUNT
    if name in ("step", "happy"):
        for made, again in zip(variants, synthesise(SOUNDS[name], name), strict=True):
            np.testing.assert_array_equal(made, again)


@pytest.mark.parametrize(
    ("lower", "higher"),
    [
        ("land", "step"),  # a heavy thump, a light tap
        ("step", "running_step"),
        ("angry", "happy"),  # a grumble, a chirp
        ("neutral", "afraid"),  # a coo, a squeak
        ("placed", "pencil"),
    ],
)
def test_sounds_lie_where_such_sounds_lie(bank, lower, higher):
    low, high = ([centroid(v) for v in bank.variants(name)] for name in (lower, higher))
    assert max(low) < min(high)


def test_a_kiss_rises_and_smacks_when_the_lips_part(bank):
    for sound in bank.variants("kiss"):
        assert pitch(sound, 0.34, 0.44) > 1.25 * pitch(sound, 0.02, 0.10)
        # The smack is the only part with much above 2 kHz.
        spectrum = np.fft.rfft(sound)
        spectrum[np.fft.rfftfreq(len(sound), 1 / SAMPLE_RATE) < 3000] = 0
        smack = np.argmax(np.abs(np.fft.irfft(spectrum, len(sound)))) / SAMPLE_RATE
        assert smack == pytest.approx(0.12, abs=0.02)


def test_a_shout_vibrates_eight_times_a_second(bank):
    for sound in bank.variants("shout"):
        block = SAMPLE_RATE // 100
        whole = sound[: len(sound) // block * block].reshape(-1, block)
        envelope = np.sqrt((whole**2).mean(axis=1))[15:75]
        spectrum = np.abs(np.fft.rfft((envelope - envelope.mean()) * np.hanning(60), 1000))
        rates = np.fft.rfftfreq(1000, 0.01)
        assert rates[5 * 10 + np.argmax(spectrum[50:200])] == pytest.approx(8.0, abs=1.0)


@pytest.mark.parametrize(("name", "up"), [("surprised", True), ("sad", False), ("angry", False)])
def test_moods_go_up_or_down(bank, name, up):
    for sound in bank.variants(name):
        seconds = len(sound) / SAMPLE_RATE
        first, last = (
            pitch(sound, a * seconds, b * seconds) for a, b in ((0.15, 0.3), (0.75, 0.92))
        )
        assert (last > 1.1 * first) if up else (last < 0.95 * first)
