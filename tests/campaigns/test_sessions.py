"""The campaigns that kill sessions, spoil their cameras and play for hours, in short."""

import pytest

from tests.campaigns.camera_faults import play_by_driver
from tests.campaigns.faulty_camera import FAULTS
from tests.campaigns.kills import MAX_LOSS_S, kills
from tests.campaigns.long_play import RATE, play_virtually

pytestmark = pytest.mark.full


@pytest.mark.parametrize("fault", FAULTS)
def test_a_session_survives_a_fault_of_its_camera(fault):
    played = play_by_driver(fault)
    assert (played.wrong, played.early) == ([], False)
    assert bool(played.missing) or fault == "reopen"


def test_a_session_that_is_killed_opens():
    (kill,) = kills(1, seed=3, jobs=1)
    assert (kill.problem, kill.lost <= MAX_LOSS_S) == ("", True)


def test_some_minutes_are_played_with_voice_robot_and_recording(tmp_path):
    played = play_virtually(0.02, tmp_path)
    assert (played.frames, played.lines > 0) == (round(0.02 * 3600 * RATE), True)
