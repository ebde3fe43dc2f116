"""All faces in view say together how likely a pose is."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.faces import FacePlanes
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.cell_search import CellMatch, CellSearch
from tests.examples import some
from tests.tracking.drawn import held
from tests.tracking.refinement.seen_softly import CAMERA, Cover, corners_off, drawn, patch

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

CUBE, OTHER = CubeModel.load("locomotion"), CubeModel.load("companion")
TONE = np.arange(256, dtype=np.float32)
"""The pictures hold light."""


def picture(light: NDArray[np.float32]) -> Picture:
    return np.clip(np.rint(patch(light).grey), 0, 255).astype(np.uint8)


def with_faces(*names: str) -> CubeModel:
    return replace(CUBE, faces=tuple(CUBE.face(name) for name in names))


def search(
    seen: Picture, start: Array, read: tuple[str, ...] = ("front",), cube: CubeModel = CUBE
) -> CellMatch:
    match = CellSearch(cube, Projection(CAMERA)).search(seen, start, TONE, read)
    assert match is not None
    return match


def mirrored(pose: Array) -> Array:
    """The pose in which the front tilts the other way."""
    planes = FacePlanes(CUBE)
    return planes.mirror(pose, planes.names.index("front"))


TILTS = [(lean, distance) for distance in (2.2, 0.6, 1.5) for lean in (0.3, 0.5, 0.8)]
"""Lean [rad] and distance [m]."""


@pytest.mark.parametrize(("lean", "distance"), some(TILTS, 2))
def test_the_true_lean_has_more_evidence_than_the_mirrored_one(
    lean: float, distance: float
) -> None:
    pose = held(lean, 0.1, 0.2, at=(0.02, 0.01, distance))
    seen = picture(drawn(CUBE, pose))
    right, wrong = search(seen, pose), search(seen, mirrored(pose))
    assert right.proved
    assert right.evidence.clearly_exceeds(wrong.evidence)
    assert se3.angle_between(right.alignment.camera_from_cube, pose) < np.deg2rad(2)


def test_a_likeness_is_not_measured_with_more_samples() -> None:
    """A marker of another cube in the place of the front's takes no more than three steps."""
    pose = held(0.5, 0.1, 0.2, at=(0.02, 0.01, 0.6))
    front = replace(OTHER, faces=(OTHER.face("front"),))
    search, steps = CellSearch(with_faces("front"), Projection(CAMERA)), []
    run = search.begin(picture(drawn(front, pose)), pose, TONE, ("front",))
    while not run.done:
        steps.append(run.step)
        run = search.advance(run)
    assert not (run.match and run.match.proved)
    assert set(steps) <= {"align", "align coarsely", "weigh"}


def test_what_is_not_where_a_marker_was_read_is_given_up_at_once() -> None:
    """No coarse alignment follows, as corners that were read are not off by a cell."""
    noise = np.random.default_rng(1).normal(120, 30, (480, 640))
    grey, front = np.clip(noise, 0, 255).astype(np.uint8), ("front",)
    search = CellSearch(with_faces("front"), Projection(CAMERA))
    for exact, steps in ((True, 1), (False, 2)):
        run = search.begin(grey, held(at=(0.0, 0.0, 0.6)), TONE, front, exact=exact)
        for _ in range(steps):
            assert not run.done
            run = search.advance(run)
        assert run.done == exact
        assert run.match is None


def test_a_first_look_tells_the_lean_that_shows_other_faces() -> None:
    """They are aligned at once, and two that are right prove that no other lean is."""
    pose = held(at=(0.0, 0.0, 0.6))
    search, seen = CellSearch(CUBE, Projection(CAMERA)), picture(drawn(CUBE, pose))
    right, wrong = (
        search.advance(search.begin(seen, each, TONE, ("front",)))
        for each in (pose, mirrored(pose))
    )
    assert (right.alone, wrong.alone) == (False, True)
    aligned = search.advance(right).aligned
    assert aligned is not None
    assert set(aligned.correlations) == {"front", "right", "top"}
    match = search.search(seen, pose, TONE, ("front",))
    assert match is not None
    assert match.candidate.agreed
    lone = search.search(picture(drawn(with_faces("front"), pose)), pose, TONE, ("front",))
    assert lone is not None
    assert lone.proved
    assert not lone.candidate.agreed


@pytest.mark.parametrize("lean", [0.5, 0.8])
def test_a_lone_face_near_by_tells_its_lean_by_perspective(lean: float) -> None:
    pose = held(lean, 0.1, 0.2, at=(0.02, 0.01, 0.6))
    seen = picture(drawn(with_faces("front"), pose))
    right, wrong = search(seen, pose), search(seen, mirrored(pose))
    assert right.evidence.clearly_exceeds(wrong.evidence)


@pytest.mark.parametrize("distance", some([0.9, 1.5, 2.2]))
def test_the_mirrored_lean_of_a_lone_face_is_never_clearly_better(distance: float) -> None:
    for lean in (0.3, 0.5, 0.8):
        pose = held(lean, 0.1, 0.2, at=(0.02, 0.01, distance))
        seen = picture(drawn(with_faces("front"), pose))
        right, wrong = search(seen, pose), search(seen, mirrored(pose))
        assert not wrong.evidence.clearly_exceeds(right.evidence)


def bent(light: NDArray[np.float32], k1: float) -> NDArray[np.float32]:
    """The same light behind a lens with that distortion."""
    height, width = light.shape
    matrix = CAMERA.matrix
    v, u = np.mgrid[:height, :width].astype(np.float32)
    pixels = np.stack([u.ravel(), v.ravel()], axis=1)[:, None]
    straight = cv2.undistortPoints(pixels, matrix, np.array([k1, 0, 0, 0, 0]), P=matrix)
    x, y = straight.reshape(height, width, 2).astype(np.float32).transpose(2, 0, 1)
    return np.asarray(cv2.remap(light, x, y, cv2.INTER_CUBIC), np.float32)


def test_a_lens_that_claims_no_distortion_is_not_believed() -> None:
    """Three faces at the edge of the picture tell that it has some."""
    pose = held(at=(-0.055, 0.03, 0.42))
    for k1 in (0.0, 0.3):
        match = search(picture(bent(drawn(CUBE, pose), k1)), pose)
        assert len(match.found) == 3
        assert match.alignment.k1 == pytest.approx(k1, abs=0.12)


def test_a_measured_lens_is_believed() -> None:
    pose = held(at=(-0.055, 0.03, 0.42))
    lens = replace(CAMERA, distortion=np.array([0.3, 0.0, 0.0, 0.0, 0.0]))
    seen = picture(bent(drawn(CUBE, pose), 0.3))
    match = CellSearch(CUBE, Projection(lens)).search(seen, pose, TONE, ("front",))
    assert match is not None
    assert abs(match.alignment.k1) < 0.02
    assert corners_off(CUBE, match.alignment.camera_from_cube, pose, ("front", "top")) < 0.2


def test_every_face_that_is_found_is_evidence() -> None:
    pose = held(at=(0.0, 0.0, 0.9))
    seen = picture(drawn(CUBE, pose))
    evidence = [
        search(seen, pose, cube=with_faces(*names)).evidence.total
        for names in (("front",), ("front", "right"), ("front", "right", "top"))
    ]
    assert (np.diff(evidence) > 20).all()


def test_a_face_that_joins_in_makes_the_pose_more_precise() -> None:
    pose = held(at=(0.0, 0.0, 2.0))
    seen = picture(drawn(CUBE, pose))
    found = search(seen, pose).alignment
    alone = search(seen, pose, cube=with_faces("front")).alignment
    assert len(found.correlations) == 3
    assert len(alone.correlations) == 1
    assert np.trace(found.covariance[3:, 3:]) < np.trace(alone.covariance[3:, 3:]) / 2
    assert corners_off(CUBE, found.camera_from_cube, pose, ("front", "right", "top")) < 0.2


@pytest.mark.parametrize(
    "hidden",
    [
        "a desk",
        pytest.param(
            "white paper",
        ),
    ],
)
def test_a_missing_face_is_evidence_against_the_pose(hidden: str) -> None:
    """There is less of it than if the cube had no such face."""
    pose = held(at=(0.0, 0.0, 0.9))
    two = with_faces("front", "right")
    light = drawn(two if hidden == "a desk" else CUBE, pose, blank=("top",))
    whole, without = (search(picture(light), pose, cube=cube) for cube in (CUBE, two))
    assert "top" not in whole.found
    assert whole.proved
    assert whole.evidence.total < without.evidence.total - 1


def test_two_partly_covered_faces_prove_the_cube_and_one_does_not() -> None:
    """Skin nearly as bright as paper, so that neither marker would be found as a whole."""
    pose = held(at=(0.0, 0.0, 0.9))
    third: Cover = (-0.1, -0.1, 0.3, 1.1)
    for faces, proved in ((("front", "right"), True), (("front",), False)):
        cube = with_faces(*faces)
        light = drawn(cube, pose, covers=dict.fromkeys(faces, third), skin=0.7)
        match = search(picture(light), pose, faces, cube)
        assert match.found == faces
        assert max(match.alignment.correlations.values()) < 0.85
        assert match.proved == proved


def test_a_start_a_cell_away_is_found_coarsely_first() -> None:
    pose = held(at=(0.0, 0.0, 0.7))
    start = se3.apply_delta(pose, np.array([0.9 * CUBE.marker_size / 6, 0, 0, 0.05, 0.0, 0.0]))
    match = search(picture(drawn(CUBE, pose)), start)
    assert corners_off(CUBE, match.alignment.camera_from_cube, pose, ("front",)) < 0.2


def test_where_there_is_no_cube_nothing_is_proved() -> None:
    random = np.random.default_rng(1)
    noise = np.clip(random.normal(120, 30, (240, 320)), 0, 255).astype(np.uint8)
    match = CellSearch(CUBE, Projection(CAMERA)).search(noise, held(), TONE, ("front",))
    assert match is None or not match.proved


@pytest.mark.parametrize("distance", [0.5, 0.9, 1.5])
def test_another_cube_in_the_same_place_is_not_proved(distance: float) -> None:
    """The border is the same, and more than half of the bits; six and more differ."""
    pose = held(at=(0.0, 0.0, distance))
    assert search(picture(drawn(OTHER, pose)), pose, cube=OTHER).proved
    assert not search(picture(drawn(OTHER, pose)), pose).proved
