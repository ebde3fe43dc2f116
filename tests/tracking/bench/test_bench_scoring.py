"""The benchmark's figures are computed as their names say."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.bench.tracking import readme, table, targets
from tests.bench.tracking.benchmark_run import BenchmarkRun
from tests.bench.tracking.scoring import Truth, errors, position_later, score

pytestmark = pytest.mark.full

RATE = 30.0


def poses(count=40, speed=0.0, seed=3):
    """Return poses of a cube that moves along x [m/s], every one turned another way."""
    made = np.tile(np.eye(4), (count, 1, 1))
    made[:, :3, :3] = Rotation.random(count, rng=seed).as_matrix()
    made[:, :3, 3] = (0, 0.05, 0.5)
    made[:, 0, 3] += speed * np.arange(count) / RATE
    return made


def truth(made, name="sweep-0.5", in_view=None, velocity=(0.0,) * 6, independent=False):
    count = len(made)
    seen = np.ones(count, bool) if in_view is None else np.array(in_view, bool)
    return Truth(name, RATE, independent, made, np.tile(velocity, (count, 1)), seen)


def answers(made, **notes):
    return [
        {"index": index, "pose": None if pose is None else pose.tolist(), "ms": 2.0} | notes
        for index, pose in enumerate(made)
    ]


def off(pose, shift=(0, 0, 0), turn_deg=(0, 0, 0)):
    moved = pose.copy()
    moved[:3, 3] += shift
    moved[:3, :3] = Rotation.from_rotvec(np.deg2rad(turn_deg)).as_matrix() @ pose[:3, :3]
    return moved


def test_errors_are_the_motion_to_the_truth_along_camera_axes():
    made = poses(1)
    found = errors(off(made[0], (0.001, -0.002, 0.003), (0, 0, 2))[None], made)
    assert found[0, :3] == pytest.approx([-0.001, 0.002, -0.003])
    assert np.rad2deg(found[0, 3:]) == pytest.approx([0, 0, -2], abs=1e-9)


def test_recall_and_silently_wrong_are_told_apart():
    made = poses(8)
    given = [
        off(made[0], (0.009, 0, 0)),  # right
        off(made[1], (0, 0, 0.011)),  # neither
        off(made[2], (0, 0, 0.021)),  # wrong by its place
        off(made[3], (0, 0, 0), (11, 0, 0)),  # wrong by its turn
        off(made[4], (0, 0, 0), (6, 0, 0)),  # neither
        None,  # nothing is not wrong
        off(made[6], (0, 0, 0), (0, 4.9, 0)),  # right
        off(made[7], (0, 0, 0.3)),  # wrong, though the cube is not wholly in view
    ]
    found = score("x", truth(made, in_view=[True] * 7 + [False]), answers(given))
    assert (found.frames, found.seen, found.given, found.wrong) == (8, 7, 6, 3)
    assert found.recall == pytest.approx(2 / 7)


def test_a_tracker_that_finds_nothing_has_no_error_and_no_recall():
    made = poses(4)
    found = score("x", truth(made), answers([None] * 4))
    assert (found.recall, found.wrong) == (0, 0)
    assert np.isnan(found.shift).all()
    assert np.isnan(found.jitter).all()


def test_spread_is_median_and_95th_percentile():
    made = poses(101)
    given = [off(pose, (0, 0, 1e-5 * index)) for index, pose in enumerate(made)]
    found = score("x", truth(made), answers(given))
    assert found.shift == pytest.approx((50e-5, 95e-5))


def test_jitter_is_that_of_the_worst_coordinate():
    made = np.tile(poses(1), (1000, 1, 1))
    rng = np.random.default_rng(1)
    noise = rng.normal(0, (1e-5, 2e-5, 5e-5), (1000, 3)) + (0.001, 0, 0)  # a bias is no jitter
    given = [off(pose, shift) for pose, shift in zip(made, noise, strict=True)]
    found = score("x", truth(made, "static"), answers(given))
    assert found.jitter[0] == pytest.approx(5e-5, rel=0.1)
    assert found.jitter[1] == pytest.approx(0, abs=1e-8)


@pytest.mark.parametrize(("overstated", "share"), [(1.0, 0.95), (0.25, 0.21), (4.0, 1.0)])
def test_a_true_covariance_holds_the_truth_in_95_percent(overstated, share):
    made = poses(3000)
    rng = np.random.default_rng(2)
    root = rng.normal(size=(6, 6)) * np.repeat((1e-4, 1e-3), 3)[:, None]
    drawn = rng.normal(size=(3000, 6)) @ root.T
    given = [
        off(pose, -error[:3], np.rad2deg(-error[3:]))
        for pose, error in zip(made, drawn, strict=True)
    ]
    stated = (overstated * root @ root.T).tolist()
    found = score("x", truth(made), answers(given, covariance=stated))
    assert found.inside == pytest.approx(share, abs=0.02)
    assert found.understated == pytest.approx(overstated**-0.5, rel=0.03)


def test_the_true_future_pose_is_interpolated_between_frames():
    time = np.arange(30) / RATE
    made = poses(30)
    made[:, 0, 3] = 0.05 * np.sin(2 * np.pi * 2 * time)
    found = position_later(made, 9, 1.5)
    assert found is not None
    assert found[0] == pytest.approx(0.05 * np.sin(2 * np.pi * 2 * 10.5 / RATE), abs=4e-5)
    assert position_later(made, 28, 1.5) is None


def test_predictions_are_compared_with_the_true_future_poses():
    made = poses(40, speed=0.6)
    ahead = made.copy()
    ahead[:, 0, 3] += 0.6 * 0.05 + 0.002
    given = [
        answer | {"expected": ahead[index].tolist()} for index, answer in enumerate(answers(made))
    ]
    found = score("x", truth(made), given)
    assert found.held == pytest.approx(0.030)
    assert found.extrapolated == pytest.approx(0, abs=1e-9)
    assert found.predicted == pytest.approx(0.002)


def test_nothing_is_predicted_where_every_frame_is_an_unrelated_pose():
    made = poses(40, speed=0.6)
    found = score("x", truth(made, independent=True), answers(made))
    assert np.isnan([found.held, found.extrapolated, found.predicted]).all()


def test_velocity_is_compared_with_the_true_one():
    made = poses(10)
    said = (0.5, 0.0, 0.03, 0.0, 0.2, 0.0)
    found = score("x", truth(made, velocity=(0.5, 0.04, 0, 0, 0, 0)), answers(made, velocity=said))
    assert found.speed == pytest.approx((0.05, 0.2))


def test_a_tracker_asked_for_every_fourth_frame_is_judged_by_those():
    made = poses(12)
    found = score("x", truth(made), answers(made)[::4])
    assert (found.frames, found.recall) == (3, 1)


def test_a_tracker_that_breaks_down_is_named():
    broken = [{"index": 0, "pose": None, "ms": 1.0, "failure": "ValueError: no"}]
    found = score("x", truth(poses(1)), broken)
    assert (found.failed, found.failures) == (1, ("ValueError: no",))


def scores_of(shift, milliseconds=2.0):
    """Score Cubeling, off by `shift` [m] in each of 40 frames, next to OpenCV."""
    made = poses(40)
    ours = [answer | {"ms": milliseconds} for answer in answers([off(p, shift) for p in made])]
    theirs = answers(made, detection_ms=4.0)
    return [
        score(title, truth(made, name), given)
        for name in ("poses", "static")
        for title, given in ((table.OURS, ours), (table.REFERENCE, theirs))
    ]


def verdict(scores, target):
    return next(each for each in targets.verdicts(scores) if each.target.startswith(target))


def test_the_bar_says_what_holds_and_what_misses():
    good, bad = scores_of((0.0001, 0, 0), 1.9), scores_of((0.03, 0, 0), 3.0)
    for target in ("recall ≥", "silently wrong", "sharp cube, median ≤ 0.2 mm", "time ÷"):
        assert verdict(good, target).miss == ""
        assert verdict(bad, target).miss
    assert str(verdict(bad, "silently wrong")).startswith("misses by 80 frames")
    assert "not measured" in str(verdict(good, "recall at 1 m/s"))


def test_the_readme_keeps_all_but_its_section(tmp_path):
    page = tmp_path / "README.md"
    page.write_text(
        f"before\n{readme.OPENING}\nof last year\n{readme.CLOSING}\nafter\n", encoding="utf-8"
    )
    run = BenchmarkRun(
        "make it", 40, 1, 2, "2026-01-01", "a machine", 0.0, tuple(scores_of((0.001, 0, 0)))
    )
    readme.write(page, run)
    readme.write(page, run)
    text = page.read_text(encoding="utf-8")
    assert text.startswith(f"before\n{readme.OPENING}\n`make it`")
    assert text.endswith(f"{readme.CLOSING}\nafter\n")
    assert "| static | 100 / 0 | 100 / 0 |" in text
    assert text.count(readme.OPENING) == 1
    assert "last year" not in text


def test_a_readme_without_the_marks_is_left_alone(tmp_path):
    page = tmp_path / "README.md"
    page.write_text("mine", encoding="utf-8")
    with pytest.raises(ValueError, match="no section"):
        readme.write(page, BenchmarkRun("make it", 40, 1, 2, "2026-01-01", "a machine", 0.0))
    assert page.read_text(encoding="utf-8") == "mine"
