"""Poses found anywhere in the image are trusted only where the image and the track allow it."""

from dataclasses import replace

import numpy as np

from cubeling.tracking.geometry import se3
from cubeling.tracking.refinement.candidate import Candidate
from cubeling.tracking.refinement.evidence import Evidence
from cubeling.tracking.tracker.prediction import Track, TrackedPose
from cubeling.tracking.tracker.verdict import Past, is_unambiguous, is_uncertain, judge_detected
from tests.tracking.drawn import held

HERE, THERE = held(), held(at=(0.3, 0.0, 0.5))
SURE = np.eye(6) * 1e-8
FOUND = Candidate(HERE, SURE, "markers", ("front", "top"), 0.1, 0.1, certain=True)
MOVED = replace(FOUND, camera_from_cube=THERE)


def tracked(timestamp: float) -> Past:
    """Past of a cube that was at rest."""
    return Past(Track((TrackedPose(HERE, np.zeros(6), SURE, timestamp),)))


def test_nothing_found_is_neither_trusted_nor_refused() -> None:
    verdict = judge_detected([], None, Past(), 0.0)
    assert (verdict.candidate, verdict.refused) == (None, "")


def test_an_unproved_pose_is_refused() -> None:
    for blurred, refused in ((False, "unproved"), (True, "blurred")):
        candidate = replace(FOUND, certain=False, blurred=blurred)
        assert judge_detected([candidate], None, Past(), 0.0).refused == refused


def test_a_pose_that_may_be_off_by_a_centimetre_is_uncertain() -> None:
    """By a standard deviation of more than 6 mm or 4.5° along its worst axis, whichever that is."""
    good = np.repeat([0.0059, np.deg2rad(4.4)], 3)
    assert not is_uncertain(np.diag(good**2))
    turn = se3.rotation(np.array([0.5, 0.6, 0.1]))
    for number, much in enumerate(np.repeat([0.0061, np.deg2rad(4.6)], 3)):
        spread = np.zeros(6)
        spread[number] = much
        for basis in (np.eye(3), turn):
            both = np.kron(np.eye(2), basis)
            assert is_uncertain(both @ np.diag(spread**2) @ both.T)


def test_the_evidence_of_the_cells_tells_two_poses_apart() -> None:
    """And only a clear lead of it does."""
    tilted = se3.apply_delta(HERE, np.array([0, 0, 0, np.deg2rad(40), 0, 0]))
    blocks = np.ones((1, 30))
    right = replace(FOUND, faces=("front",), evidence=Evidence(blocks))
    few, all_blocks = np.zeros((1, 30)), np.full((1, 30), 1 / 3)
    few[0, :2] = 5.0
    for lead, refused in ((few, "ambiguous"), (all_blocks, "")):
        wrong = replace(right, camera_from_cube=tilted, evidence=Evidence(blocks - lead))
        verdict = judge_detected([wrong, right], None, Past(), 0.0)
        assert verdict.refused == refused
        assert verdict.candidate == right
        assert is_unambiguous([right, wrong]) == (refused == "")
        assert not is_unambiguous([wrong, right])


def test_a_few_blocks_however_loud_do_not_tell_two_poses_apart() -> None:
    """A marker whose edge is cut off speaks loudly there, and for any lean; many do, if softly."""
    plain, cut = np.ones((1, 36)), np.ones((1, 36))
    cut[0, :2] += 10.0
    assert not Evidence(cut).clearly_exceeds(Evidence(plain))
    assert Evidence(plain + 20 / 36).clearly_exceeds(Evidence(plain))
    assert Evidence(plain + 0.5 / 36).clearly_exceeds(Evidence(plain))
    assert not Evidence(plain).clearly_exceeds(Evidence(plain))
    scattered = plain + 1 / 36 + np.resize([0.1, -0.1], plain.shape)
    assert not Evidence(scattered).clearly_exceeds(Evidence(plain))


def test_only_proved_poses_are_unambiguous() -> None:
    assert not is_unambiguous([])
    assert is_unambiguous([FOUND])
    assert not is_unambiguous([replace(FOUND, certain=False)])


def test_a_jump_is_refused_until_a_second_pose_confirms_it() -> None:
    past = tracked(0.0)
    first = judge_detected([MOVED], past.track.predict(0.03), past, 0.03)
    assert first.refused == "jump"
    assert first.past.track == past.track
    second = judge_detected([MOVED], past.track.predict(0.06), first.past, 0.06)
    assert second.refused == ""
    assert np.array_equal(second.past.track.poses[-1].camera_from_cube, THERE)


def test_after_a_second_out_of_sight_the_cube_may_be_anywhere() -> None:
    assert judge_detected([MOVED], None, tracked(0.0), 1.1).refused == ""


def test_of_two_equally_good_poses_the_predicted_one_is_chosen() -> None:
    tilted = se3.apply_delta(HERE, np.array([0, 0, 0, np.deg2rad(40), 0, 0]))
    both = [replace(FOUND, camera_from_cube=pose, faces=("front",)) for pose in (tilted, HERE)]
    assert judge_detected(both, None, Past(), 0.0).refused == "ambiguous"
    past = tracked(0.0)
    verdict = judge_detected(both, past.track.predict(0.03), past, 0.03)
    assert verdict.refused == ""
    assert verdict.candidate is not None
    assert np.array_equal(verdict.candidate.camera_from_cube, HERE)
