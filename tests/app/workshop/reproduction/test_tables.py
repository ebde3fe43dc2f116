"""Figures of the tables on small or known input: their shape, and what must hold of any."""

from pathlib import Path

import numpy as np
import pytest

from cubeling.app.workshop.reproduction import studies
from cubeling.app.workshop.reproduction.bodies import ambient_occlusion, expressivity
from cubeling.app.workshop.reproduction.bodies.occlusion_timing import THESIS_MS, fit_line
from cubeling.app.workshop.reproduction.gesturing import accent_strength, spoken, visemes
from cubeling.app.workshop.reproduction.motion_graphs.transitions import duration
from cubeling.app.workshop.reproduction.plots import inline_svg
from cubeling.app.workshop.reproduction.registry import TABLES
from cubeling.app.workshop.reproduction.result import Reproduction, ReproductionRequest
from cubeling.app.workshop.reproduction.standing.posture_distance import neighbour_curves
from cubeling.app.workshop.study.bundled import gesture_and_speech
from cubeling.characters import Character
from cubeling.characters.behaviour import GestureExpressivity
from cubeling.characters.motion import PartMove
from cubeling.characters.speech import Accent, AccentMeasures

DATA = Path(__file__).parents[5] / "shared" / "data"


def check_shape(found: Reproduction) -> None:
    """Every row has a cell for each column, and every plot can be drawn, alike each time."""
    assert found.tables
    for table in found.tables:
        assert table.rows
        assert {len(row) for row in table.rows} == {len(table.columns)}
    for plot in found.plots:
        assert inline_svg(plot) == inline_svg(plot)


def test_the_classes_of_visemes_are_kept_in_our_set() -> None:
    found = visemes.reproduce(ReproductionRequest())
    check_shape(found)
    assert len(found.tables[0].rows) == 15
    ours = [set(row[1].split()) for row in found.tables[0].rows[1:]]
    assert {"p", "b", "m"} in ours


@pytest.mark.slow(reason="a whole study is simulated")
@pytest.mark.parametrize(
    ("make", "people"),
    [
        (studies.gesture_votes, "EVALUATORS"),
        (studies.vleo_and_pleo, "CHILDREN"),
        (studies.facial_actions, "RATERS"),
    ],
)
def test_a_study_is_simulated_the_same_each_time(monkeypatch, make, people) -> None:
    monkeypatch.setattr(studies, people, 4)
    monkeypatch.setattr(studies, "SIMULATED_HANDS", 3)
    first, second = (make(ReproductionRequest()) for _ in range(2))
    check_shape(first)
    assert first.tables == second.tables


def test_printed_shares_of_votes_follow_from_the_counts() -> None:
    votes = gesture_and_speech.COUNTS["intensity", "time"]
    assert votes.total == 2 * studies.EVALUATORS
    assert round(100 * votes.better_share, 1) == 67.7
    assert round(votes.mean, 2) == 0.63


def test_all_components_find_every_neighbour() -> None:
    rng = np.random.default_rng(3)
    sets = [rng.normal(size=(40, 12)) / np.arange(1, 13) for _ in range(2)]
    curves = neighbour_curves(sets)
    assert curves.success[-1] == 1.0
    assert curves.mean_error[-1] == curves.max_error[-1]
    assert (curves.max_error >= curves.mean_error).all()
    assert curves.success[0] < curves.success[5] <= 1.0
    # The error is how far what was found is from the nearest posture, by all components.
    first = sets[0]
    apart = np.linalg.norm(first[:, None] - first, axis=-1) + np.diag([np.inf] * len(first))
    by_two = np.linalg.norm(first[:, None, :2] - first[:, :2], axis=-1) + np.diag(
        [np.inf] * len(first)
    )
    alone = neighbour_curves(sets[:1])
    found, best = by_two.argmin(1), apart.argmin(1)
    assert alone.success[1] == pytest.approx((found == best).mean())
    between = np.linalg.norm(first[best] - first[found], axis=-1)
    assert alone.mean_error[1] == pytest.approx(between.mean())


def test_the_duration_is_that_of_all_parts_once_they_are_scaled() -> None:
    """Equation 3.3 (M3 e)."""
    legs = PartMove(2, 12, np.arange(11), 0.0)
    arm = PartMove(4, 15, np.arange(10), 0.0)
    last = max(legs.arrival, arm.arrival)
    assert {duration(move, last, scaled=True) for move in (legs, arm)} == {15}
    assert duration(arm, last, scaled=False) == 13


def test_conditions_take_away_what_gestures_follow() -> None:
    accents = [Accent(0.5, 0.2), Accent(1.4, 0.9), Accent(2.8, 0.4)]
    both, time, neither = (
        spoken.accents_for(condition, accents, 4.0, np.random.default_rng(1))
        for condition in ("intensity", "time", "random")
    )
    assert both == accents
    assert [each.time for each in time] == [each.time for each in accents]
    assert {each.strength for each in time} <= {each.strength for each in accents}
    times = [each.time for each in neither]
    assert times != [each.time for each in accents]
    assert (np.diff(times) >= spoken.LEAST_GAP_S).all()
    assert 0.0 <= times[0] < times[-1] <= 4.0
    assert neither == spoken.accents_for("random", accents, 4.0, np.random.default_rng(1))
    assert spoken.accents_for("random", [], 4.0, np.random.default_rng(1)) == []


def test_strong_accents_that_are_longer_and_louder_are_told() -> None:
    strong = np.arange(40) % 2 == 0
    long = np.where(strong, 0.2, 0.1) + 1e-3 * np.arange(40)
    own = AccentMeasures(long, long**2, long * 20.0, 80.0 + long)
    scores, labels = accent_strength.scores_by_speaker({"a": [(own, True)], "b": [(own, False)]})
    assert {len(each) for each in scores.values()} == {80}
    assert labels.tolist() == [True] * 40 + [False] * 40
    for values in scores.values():
        assert accent_strength.best_matthews(values[:40], strong) == 1.0


def test_spheres_are_seen_where_they_are() -> None:
    seen = ambient_occlusion.SeenSpheres.of((64, 48))
    there = seen.normal_id[..., 3] > 0.5
    assert 0.3 < there.mean() < 1.0
    normals, places = seen.normal_id[there, :3], seen.position[there, :3]
    assert np.allclose(np.linalg.norm(normals, axis=-1), 1.0, atol=1e-5)
    assert ((normals * places).sum(-1) < 0.0).all()  # what is seen faces the camera
    floor = seen.normal_id[..., 3] == 1
    heights = seen.position[floor, :3] @ seen.normal_id[floor][0, :3]
    assert np.allclose(heights, heights[0], atol=1e-3)
    number = int(np.unique(seen.normal_id[..., 3])[-1])
    own = seen.normal_id[..., 3] == number
    near, way = seen.position[own, :3], seen.normal_id[own, :3]
    radius = np.linalg.norm(near[0] - near[-1]) / np.linalg.norm(way[0] - way[-1])
    assert np.allclose(near - radius * way, near[0] - radius * way[0], atol=1e-3)


def test_times_stand_beside_the_printed_ones() -> None:
    printed = {
        (name, k, separable): THESIS_MS[name][k][separable]
        for name in THESIS_MS
        for k in ambient_occlusion.SAMPLE_COUNTS
        for separable in (False, True)
    }
    for table in (ambient_occlusion._times(printed), ambient_occlusion._fits(printed)):
        for row in table.rows:
            assert row[1::2] == row[2::2]
    assert fit_line([1, 2, 3], [3.0, 5.0, 7.0]).slope_us == pytest.approx(2000.0)


@pytest.mark.slow(reason="a gesture is performed twice, with all layers of the body")
def test_a_larger_and_more_powerful_gesture_is_larger_and_faster() -> None:
    body = Character.load("human")
    small, large = (
        expressivity.play(body, GestureExpressivity(spatial=spatial, power=power), 15.0)
        for spatial, power in ((-0.6, 0.0), (0.6, 1.0))
    )
    assert all(more > less for more, less in zip(large.figures, small.figures, strict=True))


@pytest.mark.full
@pytest.mark.slow(reason="recordings are read and judged")
@pytest.mark.parametrize("name", ["gesture-timing", "transitions"])
def test_recordings_give_whole_tables(name) -> None:
    table = TABLES[name]
    if not all((DATA / each).is_dir() for each in table.needs):
        pytest.skip(f"no recordings in {DATA}")
    found = table.reproduce(ReproductionRequest(DATA))
    assert found.tables == table.reproduce(ReproductionRequest(DATA)).tables
    check_shape(found)
