"""Key curves, and the springs that follow them."""

import numpy as np
import pytest

from tools.authoring.modelling.curves import delayed, keys, spring_follow, wave

pytestmark = pytest.mark.full


def test_keys_are_met_and_never_overshot() -> None:
    curve = keys(100, (0.1, 2.0), (0.4, -1.0), (0.7, 0.5))
    assert curve[[10, 40, 70]] == pytest.approx([2.0, -1.0, 0.5])
    assert curve.max() == pytest.approx(2.0)
    assert curve.min() == pytest.approx(-1.0)


def test_a_spring_follows_late_and_loops() -> None:
    curve = wave(240, 2)
    behind = spring_follow(curve, seconds=8.0, hertz=1.0, damping=0.5)
    assert int(np.argmax(behind[:120])) > int(np.argmax(curve[:120]))
    assert np.allclose(behind[:120], behind[120:])
    assert np.allclose(delayed(curve, 0.25), np.roll(curve, 60))
