"""The benchmark on photographs: its reference, its variants, and how it scores."""

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cubeling.tracking.geometry import se3
from tests.bench.photographs import comparison, dodecahedron, hands, targets, variants
from tests.bench.photographs.boards import tilt_between
from tests.bench.photographs.body import BodyScore
from tests.bench.photographs.marker_corners import (
    cell_edges,
    line_corners,
    opencv_corners,
    opencv_detector,
)
from tests.bench.photographs.scoring import (
    StatedPose,
    are_right,
    are_wrong,
    chi_square,
    consensus,
    deltas_from_consensus,
)
from tests.bench.tracking.scoring import CHI2_95_PERCENT
from tests.bench.tracking.table import OURS

pytestmark = pytest.mark.full

needs_photographs = pytest.mark.skipif(
    not dodecahedron.paths(), reason="the photographs are not on this machine"
)
SOME = (0, 24, 48)
"""Photographs that the variants are tried on."""


def seen(view):
    found = opencv_corners(opencv_detector(dodecahedron.DICTIONARY), view.picture)
    return {each: square for each, square in found.items() if each in dodecahedron.MARKERS}


def area(square):
    return cv2.contourArea(square.astype(np.float32))


def drawn_square(corners):
    """Draw a black square on white, anti-aliased, (120, 160)."""
    factor = 16
    large = np.full((120 * factor, 160 * factor), 230, np.uint8)
    outline = np.rint((corners + 0.5) * factor - 0.5).astype(np.int32)
    cv2.fillPoly(large, [outline], 20)
    return cv2.GaussianBlur(
        cv2.resize(large, (160, 120), interpolation=cv2.INTER_AREA), (0, 0), 0.8
    )


@needs_photographs
def test_the_reference_is_a_dodecahedron():
    normals = dodecahedron.reference().body_from_marker[:, :3, 2]
    angles = np.rad2deg(np.arccos(np.clip(normals @ normals.T, -1, 1)))
    upper = angles[np.triu_indices(len(angles), 1)]
    neighbours = upper[upper < 90]
    assert len(neighbours) == 25  # 30 edges, without the five of the face with the pen
    assert neighbours == pytest.approx(63.435, abs=2)
    cube = dodecahedron.body_model()[0]
    heights = [face.corners.mean(axis=0) @ face.normal for face in cube.faces]
    assert heights == pytest.approx([cube.edge / 2] * 11, abs=3e-4)


@needs_photographs
def test_the_reference_fits_every_photograph():
    reference = dodecahedron.reference()
    assert len(reference.camera_from_body) == 72
    assert reference.error < 0.2
    assert 0.1 < reference.bloom < 0.4


def test_lines_along_the_sides_find_corners_to_a_tenth_of_a_pixel():
    corners = np.array([(60.3, 40.2), (88.1, 43.7), (84.6, 71.5), (56.8, 68.0)])
    rough = corners + [(0.8, -0.6), (-0.7, 0.5), (0.4, 0.9), (-0.5, -0.8)]
    found = line_corners(drawn_square(corners), rough)
    assert found == pytest.approx(corners, abs=0.1)
    rough[0] -= 5
    assert line_corners(drawn_square(corners), rough) is None


def test_edges_between_cells_show_how_far_white_grows():
    cells = np.zeros((8, 8))
    cells[2:6, 3:5] = 1
    grown = 0.3
    large = np.zeros((120 * 16, 160 * 16), np.uint8)
    # Four pixels a cell, from (50, 50): the white cells and what they grow.
    (left, top), (right, bottom) = (
        (50 + 12 - grown, 50 + 8 - grown),
        (50 + 20 + grown, 50 + 24 + grown),
    )
    large[round(top * 16) : round(bottom * 16), round(left * 16) : round(right * 16)] = 230
    grey = cv2.resize(large, (160, 120), interpolation=cv2.INTER_AREA)
    corners = np.array([(50, 50), (82, 50), (82, 82), (50, 82)]) - 0.5
    soft = np.asarray(cv2.GaussianBlur(grey, (0, 0), 0.8), np.uint8)
    edges = cell_edges(soft, corners, cells)
    assert len(edges) == 4 * 2 + 2 * 2
    for _, sign, shift in edges:
        assert -sign * shift == pytest.approx(grown, abs=0.05)


@needs_photographs
def test_half_size_scales_the_lens():
    picture = dodecahedron.photograph(0)
    whole, half = variants.as_it_is(picture, 0), variants.half_size(picture, 0)
    assert half.picture.shape == (360, 640, 3)
    assert half.lens.size == (640, 360)
    points = np.array([(0.05, -0.03, 0.4), (-0.1, 0.02, 0.3)])
    large, small = (
        cv2.projectPoints(points, np.zeros(3), np.zeros(3), lens.matrix, lens.distortion)[0]
        for lens in (whole.lens, half.lens)
    )
    assert (small + 0.5) * 2 == pytest.approx(large + 0.5)


@needs_photographs
def test_a_nominal_lens_claims_no_distortion():
    view = variants.nominal_lens(dodecahedron.photograph(0), 0)
    assert not view.lens.distortion.any()
    assert (view.lens.matrix == dodecahedron.camera().matrix).all()


def test_a_blurred_point_is_smeared_over_ten_pixels():
    picture = np.zeros((81, 81, 3), np.uint8)
    picture[40, 40] = 255
    if not dodecahedron.paths():
        pytest.skip("the lens is not on this machine")
    for number in range(4):
        light = variants.blurred(picture, number).picture[..., 0].astype(float) ** variants.GAMMA
        places = np.argwhere(light > 0) - 40
        weights = light[light > 0]
        # The deviation along a line of length L is L / √12.
        spread = np.sqrt(np.linalg.eigvalsh(np.cov(places.T, aweights=weights))[1])
        assert spread * np.sqrt(12) == pytest.approx(variants.BLUR_PX, abs=1.2)


@needs_photographs
def test_covered_corners_hide_the_markers_from_opencv():
    before = after = 0
    for number in SOME:
        picture = dodecahedron.photograph(number)
        before += len(seen(variants.as_it_is(picture, number)))
        after += len(seen(variants.corner_covered(picture, number)))
    assert before >= 6
    assert after <= 1


@needs_photographs
def test_one_marker_leaves_one_of_the_largest():
    for number in SOME:
        picture = dodecahedron.photograph(number)
        before, after = (
            seen(make(picture, number)) for make in (variants.as_it_is, variants.one_marker)
        )
        (left,) = after
        assert area(after[left]) > 0.95 * max(area(square) for square in before.values())


def drawn_poses(rng, count, covariance):
    """Draw poses about one, with errors of a covariance each."""
    truth = se3.pose(Rotation.random(rng=rng).as_matrix(), np.array([0.02, -0.01, 0.03]))
    errors = [rng.multivariate_normal(np.zeros(6), covariance(n)) for n in range(count)]
    return truth, [
        StatedPose(se3.apply_delta(truth, e), covariance(n)) for n, e in enumerate(errors)
    ]


def test_a_true_covariance_holds_95_percent_of_the_distances_from_the_consensus():
    rng, chi2, deltas = np.random.default_rng(3), [], []
    sizes = np.array([3e-4, 5e-4, 1e-3, 0.004, 0.006, 0.003])
    for _ in range(80):
        stated = drawn_poses(rng, 8, lambda n: np.diag((sizes * (1 + n / 4)) ** 2))[1]
        each, more = deltas_from_consensus(stated)
        deltas.append(each)
        chi2 += more
    assert len(chi2) == 80 * 8 == len(np.concatenate(deltas))
    assert np.mean(np.array(chi2) <= CHI2_95_PERCENT) == pytest.approx(0.95, abs=0.03)


def test_a_covariance_of_half_the_errors_holds_far_fewer():
    rng, chi2 = np.random.default_rng(4), []
    for _ in range(30):
        stated = drawn_poses(rng, 8, lambda n: 1e-6 * np.eye(6))[1]
        small = [StatedPose(each.pose, each.covariance / 4) for each in stated]
        chi2 += deltas_from_consensus(small)[1]
    assert np.mean(np.array(chi2) <= CHI2_95_PERCENT) < 0.6


def test_one_wrong_pose_does_not_move_the_consensus():
    truth, stated = drawn_poses(np.random.default_rng(5), 7, lambda n: 1e-7 * np.eye(6))
    wrong = se3.apply_delta(truth, np.array([0.05, 0, 0, 0, 1.5, 0]))
    mean, weights = consensus([*(each.pose for each in stated), wrong])
    assert np.abs(se3.delta(mean, truth)).max() < 5e-4
    assert weights[-1] < 0.01


def test_the_covariance_of_a_relative_pose_is_that_of_drawn_errors():
    rng, sizes = np.random.default_rng(6), np.array([2e-4, 1e-4, 6e-4, 0.005, 0.008, 0.003])
    covariance = np.diag(sizes**2)
    cubes = [
        se3.pose(Rotation.random(rng=rng).as_matrix(), np.array([x, 0.01, 0.4]))
        for x in (-0.02, 0.03)
    ]
    marker = se3.pose(np.eye(3), np.array([0, 0, 0.015]))
    stated = [StatedPose(cube, covariance).at(marker) for cube in cubes]
    expected, chi2 = stated[0].relative(stated[1]), []
    assert expected.covariance is not None
    for _ in range(1000):
        one, other = (
            StatedPose(se3.apply_delta(cube, rng.normal(0, sizes))).at(marker) for cube in cubes
        )
        found = one.relative(other).pose
        chi2.append(chi_square(se3.delta(expected.pose, found), expected.covariance))
    assert np.mean(np.array(chi2) <= CHI2_95_PERCENT) == pytest.approx(0.95, abs=0.025)


def test_the_tilt_between_two_markers_has_two_degrees_of_freedom():
    rng, sizes = np.random.default_rng(7), np.array([1e-3, 1e-3, 1e-3, 0.02, 0.03, 0.5])
    pose = se3.pose(Rotation.from_euler("x", 2.6).as_matrix(), np.array([0, 0, 0.5]))
    turn = np.kron(np.eye(2), pose[:3, :3])
    covariance, inside = turn @ np.diag(sizes**2) @ turn.T, []
    for _ in range(1000):
        pair = [
            StatedPose(se3.apply_delta(pose, turn @ rng.normal(0, sizes)), covariance)
            for _ in range(2)
        ]
        inside.append(tilt_between(*pair)[1] <= 5.991)
    assert np.mean(inside) == pytest.approx(0.95, abs=0.03)


def test_right_and_wrong_leave_room_between_them():
    errors = np.array([(0.009, 0, 0, 0.08, 0, 0), (0.015, 0, 0, 0, 0, 0), (0, 0, 0, 0, 0.2, 0)])
    assert are_right(errors).tolist() == [True, False, False]
    assert are_wrong(errors).tolist() == [False, False, True]


def test_targets_say_by_how_much_they_are_missed():
    score = BodyScore(
        "as it is", OURS, 72, 0.95, 2, 0.97, 1e-3, 0.01, 0.9, 20.0, 1.3, 7.0, 1.2, 6.0
    )
    said = [str(each) for each in targets.body_verdicts([score])]
    assert [each.split(maxsplit=2)[2] for each in said[:1]] == [
        "3.0 points    right, as it is, ≥ 98 %: 95.0 %"
    ]
    assert said[1].endswith("body silently wrong 0: 2 (as it is 2)")
    assert said[2].startswith("holds")
    assert said[2].endswith("cold, as it is, ÷ cv2 ≤ 1.5: 1.30")
    assert said[3].startswith("misses by 17%")
    assert said[3].endswith("cold, as it is, ÷ cv2, 95 % ≤ 6.0: 7.00")


def test_without_the_photographs_one_line_says_so(monkeypatch, capsys):
    monkeypatch.setattr(dodecahedron, "paths", lambda: ())
    monkeypatch.setattr("sys.argv", ["photographs"])
    comparison.main()
    said = capsys.readouterr().out
    assert said.startswith("skipped: there are no photographs in ")
    assert said.count("\n") == 1


def test_covers_are_compared_where_they_are_scored():
    hand, scored = np.zeros((4, 10), bool), np.ones((4, 10), bool)
    hand[:, :4], scored[:, 8:] = True, False
    cover = np.zeros((4, 10), np.float32)
    cover[:, 2:6], cover[:, 8:] = 0.5, 1.0
    found = hands.score(cover, hand, scored)
    assert (found.iou, found.found, found.besides) == pytest.approx((0.2, 0.25, 0.25))


@needs_photographs
def test_the_edge_of_an_outlined_hand_is_found():
    hand, scored = hands.hand_on(62)
    assert 15_000 < np.count_nonzero(hand & scored) < 25_000
    assert hand[250, 700]  # a knuckle
    assert not hand[330, 560]  # the shadow below the wrist
