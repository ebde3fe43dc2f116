import math
from dataclasses import replace

import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.pipeline.choices import LOOK_CHOICES
from cubeling.app.pipeline.table.attention import Attention
from cubeling.characters import CharacterCommand
from cubeling.tracking import CubeControls, CubeState
from tests.characters.commands import command

EDGE = 0.06
TABLE = np.eye(4)
TABLE[:3, :3] = np.array(
    [[1, 0, 0], [0, -0.8, -0.6], [0, 0.6, -0.8]]
)  # seen from above and in front
TABLE[:3, 3] = [0.0, 0.05, 0.5]
CAMERA = np.linalg.inv(TABLE)[:3, 3]


def state(place, speed=0.0):
    camera_from_cube = TABLE.copy()
    camera_from_cube[:3, 3] = (TABLE @ [*place, 1.0])[:3]
    velocity = np.array([speed, 0, 0, 0, 0, 0.0])
    return CubeState(True, camera_from_cube, velocity, np.eye(6), "markers", ("top",), 0.1, 0.0)


def controls(time, **fields):
    plain = CubeControls(True, "top", 0.0, 0.0, 0.0, True, False, False, np.zeros(2), time, TABLE)
    return replace(plain, **fields)


def look(attention, time, place=(0.1, 0.03, 0.0), speed=0.0, activity="idle", **fields):
    return attention.update(
        state(place, speed),
        controls(time, **fields),
        command(time, activity, 1.0),
    )


def test_it_looks_at_the_cube_where_the_cube_is():
    assert look(Attention("cube", EDGE), 0.0) == pytest.approx([0.1, 0.03, 0.0])


def test_it_looks_into_the_camera():
    assert look(Attention("camera", EDGE), 0.0) == pytest.approx(CAMERA)


def test_the_hand_is_on_the_persons_side_of_the_cube_and_above_it():
    cube, hand = np.array([0.1, 0.03, 0.0]), look(Attention("hand", EDGE), 0.0)
    assert np.linalg.norm(hand - cube) < EDGE
    assert hand[1] > cube[1]
    assert np.dot((hand - cube)[[0, 2]], (CAMERA - cube)[[0, 2]]) > 0


def test_by_itself_it_watches_what_moves_and_then_the_person():
    attention = Attention("auto", EDGE)
    assert look(attention, 0.0, speed=0.2) == pytest.approx([0.1, 0.03, 0.0])
    lifted = look(attention, 0.1, lifted=True, speed=0.2)
    assert lifted == pytest.approx(look(Attention("hand", EDGE), 0.1))
    assert look(attention, 0.5) == pytest.approx([0.1, 0.03, 0.0])
    assert look(attention, 2.0) == pytest.approx(CAMERA)


def test_quiet_it_glances_at_the_cube_and_mostly_at_the_person():
    attention = Attention("auto", EDGE)
    seen = [look(attention, number / 30)[2] > 0.2 for number in range(30 * 60)]
    assert 0.5 < np.mean(seen) < 0.9
    assert 15 < np.abs(np.diff(seen)).sum() < 60


@pytest.mark.parametrize(("activity", "speed"), [("move", 0.0), ("idle", 0.2)])
def test_busy_with_the_cube_it_shows_its_face_every_few_seconds(activity, speed):
    attention = Attention("auto", EDGE)
    heights = [look(attention, n / 30, speed=speed, activity=activity)[1] for n in range(30 * 60)]
    at_cube = np.isclose(heights, 0.03)
    assert at_cube[0]
    assert 0.55 < at_cube.mean() < 0.8
    changes = np.flatnonzero(np.diff(at_cube)) / 30
    assert np.diff(changes).max() < 3.1


def test_it_looks_at_nothing_before_the_table_is_known_or_when_told_so():
    attention = Attention("auto", EDGE)
    assert look(attention, 0.0, camera_from_table=None) is None
    assert look(Attention("none", EDGE), 0.0) is None


def test_a_look_that_is_none_is_refused():
    with pytest.raises(AppError, match=", ".join(LOOK_CHOICES)):
        Attention("sky", EDGE)


def test_an_unseen_cube_is_looked_at_where_it_was_last():
    attention = Attention("cube", EDGE)
    look(attention, 0.0)
    gone = replace(state((0, 0, 0)), camera_from_cube=None, velocity=np.full(6, math.nan))
    again = attention.update(gone, controls(1.0, visible=False), CharacterCommand(1.0))
    assert again == pytest.approx([0.1, 0.03, 0.0])
