"""The CRC campaign agrees with the check as it is, and finds one that is weaker."""

import numpy as np
import pytest

from robot.protocol import wire
from robot.protocol.wire import encode_frame
from tests.campaigns.beyond import predicted
from tests.campaigns.crc import figures
from tests.campaigns.figure import BODIES, Figure
from tests.campaigns.within import bursts, damaged


def test_the_check_lets_pass_what_is_predicted_and_no_more():
    wrong = [one for one in figures(20_000, 60_000, seed=1) if not one.as_predicted]
    assert wrong == []


def test_a_check_with_less_bits_is_found(monkeypatch):
    true = wire.check_bytes
    weak = lambda encoded: true(encoded)[:2] + b"\x80"  # noqa: E731 # the last six bits are gone
    monkeypatch.setattr(wire, "check_bytes", weak)
    frames = [encode_frame(body) for body in BODIES]
    random = np.random.default_rng(1)
    assert not damaged("", frames, bursts(frames, random, 5000)).as_predicted


def test_a_share_that_is_too_large_or_too_small_is_found():
    assert Figure("", 10**7, 153, 2**-16).as_predicted
    assert not Figure("", 10**7, 230, 2**-16).as_predicted
    assert not Figure("", 10**7, 90, 2**-16).as_predicted


def test_the_prediction_is_exact_where_it_can_be_counted():
    # With one bit in two wrong, every pattern is as likely as every other.
    assert predicted(13, 0.5) == pytest.approx(2**-24, rel=1e-3)
    # And for seldom wrong bits, one pattern in many of four bits passes, and none of fewer.
    assert 0 < predicted(13, 1e-3) < (120 * 1e-3) ** 4 / 24
