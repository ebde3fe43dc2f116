"""A cube is found anywhere in an image: cheaply where possible, thoroughly where needed."""

from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.faces import FacePlanes
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.detection.markers import MarkerDetector, markers_of
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.blur_search import BlurSearch
from cubeling.tracking.refinement.camera_model import CameraModelEstimator
from cubeling.tracking.refinement.candidate import Candidate
from cubeling.tracking.refinement.cell_search import CellSearch
from cubeling.tracking.refinement.edge_search import EdgeSearch
from cubeling.tracking.synthetic import open_synthetic
from cubeling.tracking.tracker import global_search
from cubeling.tracking.tracker.frame_markers import FrameMarkers, Pass
from cubeling.tracking.tracker.global_search import GlobalDetector, Search, Trial
from cubeling.tracking.tracker.tracker import CubeTracker
from tests.tracking.drawn import CAMERA, WIDE, held, off, photograph, scene
from tests.tracking.showing import show_until_decided

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

CUBE = CubeModel.load("locomotion")
DETECTORS = {CUBE.dictionary: MarkerDetector(CUBE.dictionary)}
PASSES: tuple[Pass, ...] = ("half size", "first window", "other windows")
SKIN = (105, 135, 185)


class Counting(MarkerDetector):
    """Counts how often a picture is read, by its number of rows; with other windows apart."""

    def __init__(self, dictionary: str) -> None:
        super().__init__(dictionary)
        self.rows: list[int] = []
        self.others: list[int] = []

    def detect(self, grey: Picture):
        self.rows.append(len(grey))
        return super().detect(grey)

    def detect_others(self, grey: Picture):
        self.others.append(len(grey))
        return super().detect_others(grey)


def detect(
    cube: CubeModel,
    camera: Intrinsics,
    frame: Frame,
    detector: MarkerDetector,
    thorough: bool = True,
) -> list[Candidate]:
    """Poses that a cube without a past may have in a frame."""
    projection = Projection(camera)
    edges = EdgeSearch(cube, projection)
    blur = BlurSearch(cube, projection, edges)
    markers = FrameMarkers(frame, {cube.dictionary: detector})
    tone = CameraModelEstimator().model.tone
    finder = GlobalDetector(cube, projection, edges, CellSearch(cube, projection), blur)
    search = finder.search(markers, None, tone, thorough)
    while not search.decided:
        search = finder.search(markers, None, tone, thorough, search)
    return list(search.found)


def corners_of(cube: CubeModel, pose: Array, camera: Intrinsics) -> dict[str, Array]:
    """Where the markers that look at the camera have their corners, (4, 2) [px]."""
    projection = Projection(camera)
    faces = [cube.faces[number] for number in FacePlanes(cube).faces_towards(pose, 0.15)]
    return {
        face.name: projection.project(face.corners @ pose[:3, :3].T + pose[:3, 3]) for face in faces
    }


def patched(image: Picture, markers: dict[str, Array], seed: int, share: float = 0.23) -> Picture:
    """Lay a round patch over one corner of every marker, by default too large for OpenCV."""
    random = np.random.default_rng(seed)
    picture = image.copy()
    for corners in markers.values():
        x, y = corners[int(random.integers(4))]
        side = np.sqrt(cv2.contourArea(corners.astype(np.float32)))
        place = (round(16 * x), round(16 * y))
        cv2.circle(picture, place, round(16 * share * side), SKIN, -1, cv2.LINE_AA, 4)
    return picture


@pytest.fixture(scope="module")
def static() -> tuple[Frame, Array, CubeModel, Intrinsics]:
    """A cube at rest on a desk: the frame, its pose, the cube and the camera."""
    source = open_synthetic("static?frames=1")
    assert source.intrinsics is not None
    return source.frame(0), source.truth(0), source.cube, source.intrinsics


def test_corners_found_at_half_size_are_those_of_the_whole_picture(
    static: tuple[Frame, Array, CubeModel, Intrinsics],
) -> None:
    drawn = scene((CUBE, held(0.8, -0.5, 0.4, at=(0.1, 0.05, 0.45))), camera=WIDE)
    for frame in (static[0], Frame(photograph(drawn), 0.0, 0)):
        markers = FrameMarkers(frame, DETECTORS)
        large, small = (
            {each.face.name: each.corners for each in markers_of(CUBE, read)}
            for read in (
                markers.read(CUBE.dictionary, "other windows"),
                markers.read(CUBE.dictionary, "half size"),
            )
        )
        assert len(large) >= 2
        assert set(small) == set(large)
        for name, corners in large.items():
            apart = np.linalg.norm(small[name] - corners, axis=1)
            assert apart.max() < 1
            # They have no common offset, which pixel corners at whole numbers would cause.
            assert np.linalg.norm((small[name] - corners).mean(axis=0)) < 0.35


def test_a_picture_is_read_once_for_all_cubes(
    static: tuple[Frame, Array, CubeModel, Intrinsics],
) -> None:
    detector = Counting(CUBE.dictionary)
    markers = FrameMarkers(static[0], {CUBE.dictionary: detector})
    for by in (*PASSES, *PASSES):
        markers.read(CUBE.dictionary, by)
    assert detector.rows == [360, 720]
    assert detector.others == [720]


def test_other_windows_add_to_the_first_and_no_marker_is_listed_twice(
    static: tuple[Frame, Array, CubeModel, Intrinsics],
) -> None:
    for seed in range(4):
        picture = patched(static[0].image, corners_of(CUBE, static[1], static[3]), seed, share=0.17)
        markers = FrameMarkers(Frame(picture, 0.0, 0), DETECTORS)
        first, both = (
            [each.marker_id for each in markers.read(CUBE.dictionary, by)] for by in PASSES[1:]
        )
        assert both[: len(first)] == first
        assert len(set(both)) == len(both)


def test_half_size_is_enough_where_the_cube_is_near(
    static: tuple[Frame, Array, CubeModel, Intrinsics],
) -> None:
    frame, truth, cube, camera = static
    detector = Counting(cube.dictionary)
    found = detect(cube, camera, frame, detector)
    assert detector.rows == [360]
    assert detector.others == []
    assert any(each.certain and off(each.camera_from_cube, truth)[0] < 0.2 for each in found)


def test_the_whole_picture_is_read_where_the_cube_is_far() -> None:
    """Its markers are 20 px wide, and 10 px at half size."""
    pose = held(0.3, 0.5, 0.2, at=(0.1, 0.05, 1.7))
    frame = Frame(photograph(scene((CUBE, pose), camera=WIDE), noise=0.5), 0.0, 0)
    detector = Counting(CUBE.dictionary)
    found = detect(CUBE, WIDE, frame, detector, thorough=False)
    assert detector.rows == [360, 720]
    assert min(off(each.camera_from_cube, pose)[0] for each in found) < 5


@pytest.mark.parametrize("seed", range(4))
def test_a_cube_with_a_covered_corner_on_every_marker_is_found(
    static: tuple[Frame, Array, CubeModel, Intrinsics], seed: int
) -> None:
    frame, truth, cube, camera = static
    picture = patched(frame.image, corners_of(cube, truth, camera), seed)
    covered = Frame(picture, 0.0, 0)
    markers = FrameMarkers(covered, DETECTORS)
    for by in PASSES:
        # Or the patches would prove nothing.
        assert markers_of(cube, markers.read(cube.dictionary, by)) == []
    state, _ = show_until_decided(CubeTracker(cube, camera), picture)
    assert state.visible
    millimetres, degrees = off(state.camera_from_cube, truth)
    assert millimetres < 0.5
    assert degrees < 0.2


def test_partly_hidden_markers_are_only_detected_on_request(
    static: tuple[Frame, Array, CubeModel, Intrinsics],
) -> None:
    frame, truth, cube, camera = static
    picture = patched(frame.image, corners_of(cube, truth, camera), 0)
    covered, detector = Frame(picture, 0.0, 0), DETECTORS[cube.dictionary]
    assert detect(cube, camera, covered, detector, thorough=False) == []
    assert any(each.certain for each in detect(cube, camera, covered, detector))


def test_a_picture_without_the_cube_proposes_nothing() -> None:
    other = CubeModel.load("companion")
    frame = Frame(photograph(scene((other, held()), camera=WIDE)), 0.0, 0)
    found = detect(CUBE, WIDE, frame, DETECTORS[CUBE.dictionary])
    assert not any(each.certain for each in found)


LONE = replace(CUBE, faces=tuple(face for face in CUBE.faces if face.name == "front"))
"""One face has to be compared with both of its leans, which takes several calls."""


def lone_face(right: float = 0.0) -> tuple[Picture, Array]:
    pose = held(0.5, 0.3, 0.2, at=(right, 0.0, 0.3))
    return photograph(scene((LONE, pose))), pose


@pytest.fixture
def large(monkeypatch: pytest.MonkeyPatch) -> None:
    """Give small pictures the budget of large ones, whose search takes several calls."""
    monkeypatch.setattr(global_search, "SMALL_PICTURE_PX", 0)


@pytest.mark.usefixtures("large")
def test_a_search_goes_on_in_the_next_call_and_ends_as_in_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    picture, pose = lone_face()
    late, calls = show_until_decided(CubeTracker(LONE, CAMERA), picture)
    assert late.visible
    assert len(calls) > 2
    assert off(late.camera_from_cube, pose)[0] < 1
    monkeypatch.setattr(global_search, "BUDGET_PICTURES", 1e3)
    at_once = CubeTracker(LONE, CAMERA).update(Frame(picture, 0.0, 0))
    assert at_once.visible
    assert late.camera_from_cube is not None
    assert at_once.camera_from_cube is not None
    assert np.array_equal(late.camera_from_cube, at_once.camera_from_cube)


@pytest.mark.usefixtures("large")
def test_a_cube_that_moves_during_the_search_is_trusted_where_it_is_found_again() -> None:
    before, _ = lone_face()
    after, pose = lone_face(right=0.0015)
    count = len(show_until_decided(CubeTracker(LONE, CAMERA), before)[1])
    tracker = CubeTracker(LONE, CAMERA)
    pictures = [*[before] * (count - 1), after, after]
    states = [tracker.update(Frame(each, n / 30, n)) for n, each in enumerate(pictures)]
    # What an earlier picture shows is not told of a later one.
    assert [state.verdict for state in states] == ["searching"] * count + ["trusted"]
    assert off(states[-1].camera_from_cube, pose)[0] < 1
    assert not tracker.searching


@pytest.mark.usefixtures("large")
def test_a_new_picture_that_shows_the_cube_at_once_ends_the_search() -> None:
    lone, _ = lone_face()
    whole = held(0.8, -0.5, 0.4)
    tracker = CubeTracker(CUBE, CAMERA)
    assert tracker.update(Frame(lone, 0.0, 0)).verdict == "searching"
    assert tracker.searching
    state = tracker.update(Frame(photograph(scene((CUBE, whole))), 1 / 30, 1))
    assert state.visible
    assert off(state.camera_from_cube, whole)[0] < 0.5
    assert not tracker.searching


@pytest.mark.parametrize("camera", [CAMERA, WIDE], ids=["small", "large"])
def test_no_call_does_more_than_its_budget_and_one_trial(
    camera: Intrinsics, monkeypatch: pytest.MonkeyPatch
) -> None:
    pose = held(0.5, 0.3, 0.2, at=(0.0, 0.0, 0.3))
    picture = photograph(scene((LONE, pose), camera=camera))
    spent: list[float] = []

    def counted(cost: float, run: Callable[[Search], Search]) -> Trial:
        def run_counted(search: Search) -> Search:
            spent[-1] += cost
            return run(search)

        return Trial(cost, run_counted)

    monkeypatch.setattr(global_search, "Trial", counted)
    tracker, verdict = CubeTracker(LONE, camera), "searching"
    while verdict == "searching":
        spent.append(0.0)
        verdict = tracker.update(Frame(picture, len(spent) / 30, len(spent))).verdict
    assert verdict == "trusted"
    size = camera.size[0] * camera.size[1]
    small = size <= global_search.SMALL_PICTURE_PX
    budget = global_search.SMALL_BUDGET_PX if small else global_search.BUDGET_PICTURES * size
    # A lone face takes several calls, or the budget would say nothing.
    assert len(spent) > 2
    assert max(spent) <= max(budget, 3 * global_search.CELLS_COST_PX)


def test_a_cube_that_has_left_its_place_is_followed_by_its_marker() -> None:
    first, _ = lone_face()
    tracker = CubeTracker(LONE, CAMERA)
    state, calls = show_until_decided(tracker, first)
    assert state.visible
    # 18 px from frame to frame, more than edges and blur reach.
    moved, pose = lone_face(right=0.009)
    after = tracker.update(Frame(moved, len(calls) / 30, len(calls)))
    assert after.visible
    assert not tracker.searching
    assert off(after.camera_from_cube, pose)[0] < 1
