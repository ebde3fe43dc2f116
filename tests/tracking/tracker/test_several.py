"""Several cubes in one picture are followed as each would be alone."""

import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.tracker.several import CubesTracker
from cubeling.tracking.tracker.tracker import CubeTracker
from tests.examples import some
from tests.tracking.drawn import CAMERA, held, off, photograph, scene

Array = NDArray[np.float64]

LEFT, RIGHT = CubeModel.load("locomotion"), CubeModel.load("companion")
RATE = 30.0


def pose_of(cube: CubeModel, number: int) -> Array:
    """The one comes nearer and turns, the other goes to the left."""
    time = number / RATE
    if cube is LEFT:
        start = held(at=(-0.09, 0.02, 0.4))
        return se3.apply_delta(start, time * np.array([0.05, 0, -0.1, 0, 0.8, 0]))
    return se3.apply_delta(held(0.8, -0.5, 0.4, at=(0.09, -0.01, 0.42)), time * -0.1 * np.eye(6)[0])


def frame(number: int, *cubes: CubeModel) -> Frame:
    picture = photograph(scene(*[(cube, pose_of(cube, number)) for cube in cubes]), seed=number)
    return Frame(picture, number / RATE, number)


@pytest.mark.parametrize(
    "cubes", some([((LEFT, RIGHT),), ((RIGHT, LEFT),)]), ids=lambda c: c[0].name
)
def test_two_cubes_are_followed_in_the_order_given(cubes: tuple[CubeModel, ...]) -> None:
    tracker = CubesTracker(cubes, CAMERA)
    assert tuple(each.cube for each in tracker.trackers) == cubes
    for number in range(5):
        states = tracker.update(frame(number, LEFT, RIGHT))
        assert len(states) == 2
        for cube, state in zip(cubes, states, strict=True):
            millimetres, degrees = off(state.camera_from_cube, pose_of(cube, number))
            assert state.visible
            assert millimetres < 0.5
            assert degrees < 0.2


def test_each_state_is_that_of_a_tracker_of_its_own() -> None:
    """To the last bit, before a camera that is known: nothing else is shared but markers."""
    cubes = (LEFT, RIGHT)
    together, alone = CubesTracker(cubes, CAMERA), [CubeTracker(cube, CAMERA) for cube in cubes]
    shown = [cubes, cubes, (LEFT,), (LEFT,), cubes, (), (RIGHT,), cubes]
    for number, there in enumerate(shown):
        seen = frame(number, *there)
        states = together.update(seen)
        assert [repr(state) for state in states] == [repr(each.update(seen)) for each in alone]
        foretold = together.predict(seen.timestamp + 0.02)
        single = [each.predict(seen.timestamp + 0.02) for each in alone]
        assert [repr(state) for state in foretold] == [repr(state) for state in single]


@pytest.mark.slow(reason="a focal length is known after a second of play")
def test_what_one_cube_tells_of_the_lens_serves_both() -> None:
    """One lies still, the other is turned: both are seen through the same, right lens."""
    tracker = CubesTracker((LEFT, RIGHT), CAMERA.lengthen(1.5, 0.35))
    still = held(0.8, -0.5, 0.4, at=(0.09, -0.01, 0.42))
    for number in range(30):
        t = number / 30
        turned = held(0.5 + 0.3 * np.sin(7 * t), 0.3 + 0.9 * t, 0.8 * t, at=(-0.08, 0, 0.4))
        picture = photograph(scene((LEFT, turned), (RIGHT, still)), seed=number)
        left, right = tracker.update(Frame(picture, number / RATE, number))
        assert left.focal_scale == right.focal_scale
    assert right.camera_from_cube is not None
    assert left.focal_scale == pytest.approx(1 / 1.5, rel=0.03)
    assert right.camera_from_cube[2, 3] == pytest.approx(still[2, 3], rel=0.03)
    one, other = (each.measured_intrinsics for each in tracker.trackers)
    assert np.array_equal(one.matrix, other.matrix)


def test_a_lost_one_is_found_again_while_the_other_is_followed() -> None:
    tracker = CubesTracker((LEFT, RIGHT), CAMERA)
    for number in range(2):
        tracker.update(frame(number, LEFT, RIGHT))
    for number in range(2, 12):
        left, right = tracker.update(frame(number, LEFT))
        assert left.visible
        assert not right.visible
    # Longer than it is foretold.
    assert right.camera_from_cube is None
    left, right = tracker.update(frame(12, LEFT, RIGHT))
    assert left.visible
    assert right.visible
    assert off(left.camera_from_cube, pose_of(LEFT, 12))[0] < 0.5
    assert off(right.camera_from_cube, pose_of(RIGHT, 12))[0] < 0.5


def test_no_cube_is_taken_for_the_other() -> None:
    for shown, there in ((LEFT, 0), (RIGHT, 1)):
        states = CubesTracker((LEFT, RIGHT), CAMERA).update(frame(0, shown))
        assert [state.visible for state in states] == [number == there for number in (0, 1)]


def twin(dictionary: str) -> CubeModel:
    """A cube with one marker of the locomotion cube on one of its faces."""
    document = {
        "dictionary": dictionary,
        "edge_mm": 50,
        "marker_mm": 35,
        "face": [{"name": "front", "marker_id": 40}, {"name": "top", "marker_id": 12}],
    }
    return CubeModel.from_document(document, "twin.toml", "twin")


def test_cubes_that_share_a_marker_are_refused_in_one_line() -> None:
    with pytest.raises(TrackingError) as caught:
        CubesTracker((LEFT, RIGHT, twin("DICT_4X4_50")), CAMERA)
    message = str(caught.value)
    assert "\n" not in message
    for told in (
        "'locomotion'",
        "'twin'",
        "marker 12",
        "DICT_4X4_50",
        "cubeling cube locomotion-2",
    ):
        assert told in message
    with pytest.raises(TrackingError, match="both have marker"):
        CubesTracker((LEFT, LEFT), CAMERA)


def test_the_same_number_of_another_dictionary_is_another_marker() -> None:
    tracker = CubesTracker((LEFT, twin("DICT_5X5_50")), CAMERA)
    left, other = tracker.update(frame(0, LEFT, RIGHT))
    assert left.visible
    assert not other.visible


def test_no_cube_at_all_is_refused_in_one_line() -> None:
    with pytest.raises(TrackingError, match=r"^there is no cube to track: .*$"):
        CubesTracker((), CAMERA)


def test_a_frame_of_another_size_is_refused() -> None:
    tracker = CubesTracker((LEFT, RIGHT), CAMERA)
    with pytest.raises(TrackingError, match="frame 7 is 320×240"):
        tracker.update(Frame(np.zeros((240, 320, 3), np.uint8), 0.0, 7))
