"""The campaign of two cubes draws the same again, and sees what it is to see."""

import numpy as np
import pytest

from cubeling.tracking import CubeState
from tests.campaigns.two_cubes.clips import FRAMES_PER_CLIP, KINDS, draw_clip
from tests.campaigns.two_cubes.watch import Watch, show
from tests.tracking.drawn import Array, held

HERE, THERE = held(at=(-0.08, 0.0, 0.4)), held(0.8, at=(0.08, 0.0, 0.45))


def stated(pose: Array) -> CubeState:
    """A trusted pose."""
    return CubeState(
        visible=True,
        camera_from_cube=pose,
        velocity=np.zeros(6),
        covariance=np.eye(6),
        source="markers",
        faces=("front",),
        reprojection_error=0.1,
        timestamp=0.0,
    )


@pytest.mark.parametrize("number", range(len(KINDS)))
def test_a_clip_is_the_same_again(number: int) -> None:
    (pair, moments), (again, same) = draw_clip(1, number), draw_clip(1, number)
    assert [cube.name for cube in pair] == [cube.name for cube in again]
    assert not pair[0].markers & pair[1].markers
    assert np.array_equal(next(moments).frame.image, next(same).frame.image)


def test_the_pose_of_the_other_cube_is_seen() -> None:
    said = Watch().judge(stated(THERE), HERE, THERE, 1.0)
    assert said == "the other cube"
    assert not Watch().judge(stated(HERE), HERE, THERE, 1.0)


def test_a_cube_that_is_trusted_in_the_third_hidden_frame_is_seen() -> None:
    watch = Watch()
    said = [watch.judge(stated(HERE), HERE, THERE, 0.0) for _ in range(4)]
    assert said == ["", "", "loss not said", "loss not said"]


def test_a_pose_that_stays_while_its_cube_moves_is_seen() -> None:
    watch, said = Watch(), []
    for step in range(4):
        moved = held(at=(-0.08 + 0.008 * step, 0.0, 0.4))
        said.append(watch.judge(stated(HERE), moved, THERE, 1.0))
    assert said == ["", "frozen", "frozen", "frozen"]


@pytest.mark.slow(reason="a clip is drawn")
def test_both_cubes_of_a_clip_are_hidden_and_found_again() -> None:
    told: list[str] = []
    count = show(1, 2, told.append)
    assert len(told) == FRAMES_PER_CLIP
    assert not count.wrong_clips
    assert " 0.00 unseen" in told[13]
    assert count.events["found"] > 0.8 * count.events["in view"]
