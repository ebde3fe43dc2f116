"""Small variations: stretches of recorded rests, and the published chain of extrema."""

import numpy as np
import pytest

from cubeling.characters.synthesis.idle.motion_texture import Stretches, StretchStream
from cubeling.characters.synthesis.idle.posture_space import PostureSpace
from cubeling.characters.synthesis.idle.variations import Variations, VariationStream, extrema

RATE = 25.0


def signal(seed: int, seconds: float) -> np.ndarray:
    rng = np.random.default_rng(seed)
    noise = rng.normal(size=(round(seconds * RATE), 3))
    kernel = np.hanning(30)
    return np.stack([np.convolve(each, kernel / kernel.sum(), "same") for each in noise.T], axis=1)


def extrema_stream(recorded: np.ndarray, seed: int) -> VariationStream:
    """Return the variations of a signal whose components are its own columns."""
    space = PostureSpace(np.zeros(3), np.eye(3), np.ones(3))
    return VariationStream(Variations.of([recorded], RATE), space, np.random.default_rng(seed))


def test_variations_are_as_large_and_as_fast_as_recorded() -> None:
    recorded = signal(1, 120.0)
    stream = extrema_stream(recorded, 2)
    made = np.stack([stream.at(number / RATE) for number in range(7500)])
    assert made.mean(0) == pytest.approx(0.0, abs=0.15 * recorded.std())
    assert made.std(0) / recorded.std(0) == pytest.approx(1.0, abs=0.2)
    error = 0.1 * recorded[:, 0].std()
    waits = [np.diff(extrema(each[:, 0], error)).mean() for each in (recorded, made)]
    assert waits[1] / waits[0] == pytest.approx(1.0, abs=0.25)


def test_variations_do_not_repeat() -> None:
    stream = extrema_stream(signal(3, 60.0), 4)
    made = np.array([stream.at(number / RATE)[0] for number in range(7500)])
    values = made[extrema(made, 1e-9)].round(9)
    runs = [tuple(values[start : start + 5]) for start in range(len(values) - 5)]
    assert len(set(runs)) == len(runs)


def test_stretches_move_as_the_recorded_signal_does() -> None:
    recorded = signal(5, 60.0)
    stream = StretchStream(Stretches.of([recorded], RATE), np.random.default_rng(6))
    made = np.stack([stream.at(number / RATE) for number in range(7500)])
    for order in range(4):
        spreads = [np.diff(each, order, axis=0).std() for each in (recorded, made)]
        assert spreads[1] / spreads[0] == pytest.approx(1.0, abs=0.2)
    correlations = [np.corrcoef(each.T) for each in (recorded, made)]
    assert correlations[1] == pytest.approx(correlations[0], abs=0.2)
    seconds = made[: 7500 // 25 * 25].reshape(-1, 25 * 3)
    apart = np.linalg.norm(seconds[:, None] - seconds, axis=-1) + 9.0 * np.eye(len(seconds))
    assert apart.min() > 1e-3 * np.linalg.norm(seconds, axis=1).mean()


@pytest.mark.parametrize("frames", [2, 20, 60])
def test_short_rests_have_stretches_too(frames: int) -> None:
    stream = StretchStream(Stretches.of([signal(7, 10.0)[:frames]], RATE), np.random.default_rng(8))
    made = np.stack([stream.at(number / RATE) for number in range(500)])
    assert np.isfinite(made).all()


def test_backward_stretches_are_the_rests_in_reverse() -> None:
    rests = [signal(9, 8.0), signal(10, 5.0)]
    forward = Stretches.of(rests, RATE)
    backward = forward.backward()
    expected = Stretches.of([rest[::-1] for rest in rests[::-1]], RATE)
    assert backward.offsets == pytest.approx(expected.offsets)
    assert backward.velocities == pytest.approx(expected.velocities)
    assert backward.last.tolist() == expected.last.tolist()
