"""The CRC campaign accepts the product's check, and detects a weaker one."""

import numpy as np
import pytest

from cubeling.robot.protocol import wire
from cubeling.robot.protocol.wire import encode_frame
from tests.campaigns.crc import error_rates
from tests.campaigns.detected_errors import bursts, damaged
from tests.campaigns.error_rate import BODIES, ErrorRate
from tests.campaigns.undetected_errors import predicted

pytestmark = pytest.mark.full


def test_errors_pass_the_check_at_the_predicted_rates():
    wrong = [one for one in error_rates(20_000, 60_000, seed=1) if not one.as_predicted]
    assert wrong == []


def test_a_weaker_check_is_detected(monkeypatch):
    true = wire.check_bytes
    weak = lambda encoded: true(encoded)[:2] + b"\x80"  # noqa: E731 # the last six bits are gone
    monkeypatch.setattr(wire, "check_bytes", weak)
    frames = [encode_frame(body) for body in BODIES]
    random = np.random.default_rng(1)
    assert not damaged("", frames, bursts(frames, random, 5000)).as_predicted


def test_a_rate_that_is_too_high_or_too_low_is_detected():
    assert ErrorRate("", 10**7, 153, 2**-16).as_predicted
    assert not ErrorRate("", 10**7, 230, 2**-16).as_predicted
    assert not ErrorRate("", 10**7, 90, 2**-16).as_predicted


def test_the_prediction_is_exact_where_it_can_be_computed():
    # With one bit in two wrong, every pattern is as likely as every other.
    assert predicted(13, 0.5) == pytest.approx(2**-24, rel=1e-3)
    # And for seldom wrong bits, one pattern in many of four bits passes, and none of fewer.
    assert 0 < predicted(13, 1e-3) < (120 * 1e-3) ** 4 / 24
