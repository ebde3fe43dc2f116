"""Pitch, intensity and pauses of sounds that are known exactly."""

import numpy as np
import parselmouth
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters.speech.prosody.contours import measure_prosody
from cubeling.characters.speech.prosody.pitch import PitchSettings, track_pitch
from tests.examples import examples


def harmonics(pitch, rate):
    """Return a buzzing sound of a pitch [Hz] for each sample."""
    phase = 2 * np.pi * np.cumsum(pitch) / rate
    tone = sum(np.sin(k * phase) / k for k in range(1, 8))
    return (0.2 * tone).astype(np.float32)


@settings(max_examples=examples(25))
@given(st.floats(85, 450), st.sampled_from([8000, 16_000, 44_100, 96_000]))
def test_a_steady_voice_has_its_pitch(pitch, rate):
    track = track_pitch(harmonics(np.full(rate // 2, pitch), rate), rate)
    inside = (track.times > 0.05) & (track.times < 0.45)
    assert np.abs(np.log2(track.f0[inside] / pitch)).max() < 0.005


def test_a_glide_is_followed():
    rate = 16_000
    t = np.arange(rate) / rate
    track = track_pitch(harmonics(100 * 2**t, rate), rate)
    inside = (track.times > 0.05) & (track.times < 0.95)
    assert np.abs(np.log2(track.f0[inside] / (100 * 2 ** track.times[inside]))).max() < 0.01


@pytest.mark.parametrize("count", [0, 1, 10, 700, 8000])
def test_silence_of_any_length_has_no_voice(count):
    prosody = measure_prosody(np.zeros(count, np.float32), 16_000)
    assert not prosody.f0.any()
    assert len(prosody.voiced) == 0
    assert len(prosody.pauses) == (count >= 4000)


def test_noise_is_not_voiced():
    noise = np.random.default_rng(1).normal(0, 0.1, 32_000).astype(np.float32)
    assert np.mean(track_pitch(noise, 16_000).f0 > 0) < 0.05


def test_loudness_does_not_change_pitch(buzz):
    sound = buzz(1.5, [(0.3, 0, 3), (0.8, -6, 5), (1.2, -3, 0)])
    assert np.allclose(
        track_pitch(sound, 16_000).f0, track_pitch(0.01 * sound, 16_000).f0, rtol=1e-3
    )


def test_intensity_is_in_decibels_of_full_scale():
    tone = np.sin(2 * np.pi * 200 * np.arange(16_000) / 16_000).astype(np.float32)
    intensity = measure_prosody(tone, 16_000).intensity
    assert np.abs(intensity[5:-5] - 10 * np.log10(0.5)).max() < 0.1


def test_pauses_and_voiced_regions_are_where_they_are(buzz):
    sound = np.concatenate(
        [np.zeros(8000), harmonics(np.full(8000, 150.0), 16_000), np.zeros(3200)]
        + [harmonics(np.full(4800, 180.0), 16_000)]
    ).astype(np.float32)
    prosody = measure_prosody(sound, 16_000)
    assert np.abs(prosody.voiced - [[0.5, 1.0], [1.2, 1.5]]).max() < 0.03
    assert np.abs(prosody.pauses - [[0.0, 0.5]]).max() < 0.03  # 0.2 s are no pause


@pytest.mark.parametrize("seed", range(3))
def test_pitch_is_that_of_praat(seed, buzz):
    random = np.random.default_rng(seed)
    peaks = [(t, random.uniform(-15, 0), random.uniform(-3, 9)) for t in np.arange(0.3, 3, 0.21)]
    sound = buzz(3.2, peaks, pitch=random.uniform(90, 250))
    sound += random.normal(0, 0.003, len(sound)).astype(np.float32)
    praat = parselmouth.Sound(sound.astype(float), 16_000).to_pitch_ac(
        time_step=0.01, pitch_floor=75, pitch_ceiling=500, max_number_of_candidates=15
    )
    theirs = praat.selected_array["frequency"]
    track = track_pitch(sound, 16_000, PitchSettings())
    ours = track.f0[np.abs(track.times[:, None] - praat.xs()).argmin(0)]
    both = (ours > 0) & (theirs > 0)
    assert both.sum() > 100
    assert np.mean((ours > 0) != (theirs > 0)) < 0.02
    assert np.mean(np.abs(ours[both] / theirs[both] - 1) > 0.2) <= 0.01
