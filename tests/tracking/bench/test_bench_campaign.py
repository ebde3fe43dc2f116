"""The search for silently wrong poses finds them, and resumes after an interruption."""

import json
import sys

import numpy as np
import pytest

from tests.bench.tracking import campaign
from tests.bench.tracking.sequences import Sequence, sequence

pytestmark = pytest.mark.full

FRAMES = 5


@pytest.fixture
def wrong_truth(monkeypatch):
    """Shift every true pose 30 mm away from the one in the picture."""
    right = Sequence.truth
    shift = np.array([[0, 0, 0, 0.03], *np.zeros((3, 4))])
    monkeypatch.setattr(Sequence, "truth", lambda drawn, index: right(drawn, index) + shift)


def test_every_seed_is_used_once_until_there_are_enough_frames():
    assert list(campaign.plan(("a", "b"), 250, 100, 7)) == [("a", 7), ("b", 7), ("a", 8)]


def test_a_good_pose_is_right_and_none_is_wrong():
    result = campaign.evaluate(sequence("cluttered", 3, FRAMES))
    assert json.loads(json.dumps(result)) == result
    assert (result["seen"], result["given"], result["right"]) == (FRAMES,) * 3
    assert result["wrong"] == []


def test_a_pose_away_from_the_truth_is_found_and_can_be_drawn_again(wrong_truth):
    result = campaign.evaluate(sequence("cluttered", 3, FRAMES))
    assert result["right"] == 0
    assert [wrong["index"] for wrong in result["wrong"]] == list(range(FRAMES))
    assert result["wrong"][0]["mm"] == pytest.approx(30, abs=1)
    assert (result["sequence"], result["seed"], result["frames"]) == ("cluttered", 3, FRAMES)


def test_what_was_finished_is_not_done_again(tmp_path, monkeypatch, capsys):
    log = tmp_path / "log.jsonl"
    done = {"sequence": "far", "seed": 7, "frames": 50, "seen": 50, "given": 49, "right": 48}
    done |= {"inside": 47, "wrong": []}
    log.write_text(json.dumps(done) + '\n{"sequence": "far", "se', encoding="utf-8")
    monkeypatch.setattr(
        sys, "argv",
        ["campaign", "--sequences", "far", "--frames", "50", "--length", "50", "--log", str(log)],
    )  # fmt: skip
    with pytest.raises(SystemExit) as ended:
        campaign.main()
    assert not ended.value.code
    assert "98.0" in capsys.readouterr().out


def test_two_processes_find_what_one_finds(tmp_path, monkeypatch):
    log = tmp_path / "log.jsonl"
    arguments = ["--sequences", "webcam", "--frames", "2", "--length", "1", "--log", str(log)]
    monkeypatch.setattr(sys, "argv", ["campaign", *arguments, "--processes", "2"])
    with pytest.raises(SystemExit):
        campaign.main()
    found = [json.loads(line) for line in log.read_text(encoding="utf-8").split("\n") if line]
    assert found == [campaign.evaluate(sequence("webcam", seed, 1)) for seed in (7, 8)]
