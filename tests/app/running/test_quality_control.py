"""The quality of the pictures follows the time that frames take, on a time that is given."""

from itertools import pairwise

import pytest
from hypothesis import given, strategies as st

from cubeling.app.errors import AppError
from cubeling.app.running.quality_control import MAX_TRIAL_S, QualityControl, checked_quality
from cubeling.characters.rendering import QUALITIES

RATE = 30.0


def played(control, seconds, cost):
    """Qualities and their times [s], of frames that take as long as `cost` says of a quality."""
    now, found = 0.0, []
    while now < seconds:
        took = cost(control.quality.name)
        control.update(took)
        now += max(took, 1 / RATE)
        found.append((now, control.quality.name))
    return found


def changes(found):
    return [(now, name) for (_, last), (now, name) in pairwise(found) if name != last]


def test_frames_without_time_to_spare_stay_in_full_quality():
    assert changes(played(QualityControl(RATE), 60, lambda name: 0.02)) == []


def test_fast_frames_become_rich():
    ((when, name),) = changes(played(QualityControl(RATE), 60, lambda name: 0.004))
    assert name == "rich"
    assert 10.0 < when < 11.0


def test_software_does_not_try_deferred_shading():
    assert changes(played(QualityControl(RATE, software=True), 60, lambda name: 0.004)) == []


def test_slow_frames_lower_the_quality_after_a_moment():
    cost = {"full": 0.05, "reduced": 0.02}
    ((when, name),) = changes(played(QualityControl(RATE), 30, cost.__getitem__))
    assert name == "reduced"
    assert 1.5 < when < 3.0


def test_one_slow_frame_changes_nothing():
    control = QualityControl(RATE)
    for number in range(300):
        control.update(0.4 if number % 60 == 50 else 0.02)
    assert control.quality.name == "full"


def test_the_quality_rises_when_there_is_time_again():
    control = QualityControl(RATE)
    played(control, 10, {"full": 0.05, "reduced": 0.025}.__getitem__)
    found = changes(played(control, 60, {"full": 0.02, "reduced": 0.01}.__getitem__))
    assert [name for _, name in found] == ["full"]


def test_trials_that_fail_become_rare():
    """Where only the reduced quality is fast enough, the better one is tried again and again."""
    cost = {"full": 0.045, "reduced": 0.012}
    found = changes(played(QualityControl(RATE), 3000, cost.__getitem__))
    trials = [now for now, name in found if name == "full"]
    gaps = [round(b - a) for a, b in pairwise(trials)]
    assert len(trials) < 18
    assert gaps == sorted(gaps)
    assert gaps[-1] == pytest.approx(MAX_TRIAL_S, rel=0.05)


@given(st.lists(st.floats(0.0, 2.0), max_size=300))
def test_any_times_give_a_quality(times):
    control = QualityControl(RATE)
    for seconds in times:
        assert control.update(seconds).name in QUALITIES


def test_a_quality_that_does_not_exist_is_refused_in_one_line():
    assert checked_quality("auto") == "auto"
    with pytest.raises(
        AppError, match="no quality 'best': choose one of auto, rich, full, reduced"
    ):
        checked_quality("best")
