"""The map of the room: what the picture shows from where it is, and never black elsewhere."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from cubeling.tracking import Intrinsics
from cubeling.tracking.appearance import ENVIRONMENT_PX, EnvironmentMap, MeasuredLight, RoomMeter
from cubeling.tracking.appearance.colour_space import LINEAR_FROM_SRGB
from cubeling.tracking.appearance.room.cube_map import (
    directions,
    enlarged,
    filled,
    solid_angles,
    texels_at,
)
from cubeling.tracking.appearance.room.room_meter import (
    CENTRE_M,
    HASTY_INTERVAL_S,
    LOOK_INTERVAL_S,
    MIN_LIGHT,
    RENEWAL_INTERVAL_S,
    TWO_MAPS_S,
)
from cubeling.tracking.geometry.projection import Projection

SIZE = 640, 360
LENS = Intrinsics.guess(SIZE)
UNIT = directions(ENVIRONMENT_PX)


def table_from(yaw=0.0, pitch=0.55, distance=0.6):
    """Return the pose of a table in the middle of the picture, seen from above its front."""
    down = np.array(
        [[1, 0, 0], [0, -np.cos(pitch), np.sin(pitch)], [0, -np.sin(pitch), -np.cos(pitch)]]
    )
    turn = np.array([[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]])
    pose = np.eye(4)
    pose[:3, :3] = down @ turn
    pose[2, 3] = distance
    return pose


TABLE = table_from()


def grey(value):
    return np.full((SIZE[1], SIZE[0], 3), value, np.uint8)


def light_of(found: EnvironmentMap | None):
    """Return the linear light of all texels, (texels, 3) RGB."""
    assert found is not None
    return LINEAR_FROM_SRGB[found.planes].reshape(3, -1).T


def with_spot(place, colour=(0, 0, 255)):
    """Return a dark picture with a spot of two centimetres at a place of the table frame."""
    image = grey(20)
    at = TABLE[:3, :3] @ place + TABLE[:3, 3]
    column, row = Projection(LENS).project(at[None])[0].round().astype(int)
    radius = round(0.01 * LENS.matrix[0, 0] / at[2])
    image[row - radius : row + radius + 1, column - radius : column + radius + 1] = colour
    return image


@pytest.mark.parametrize("x", [-0.12, 0.1])
@pytest.mark.parametrize("z", [-0.1, 0.06])
def test_what_lies_on_the_table_is_where_it_is_seen_from_the_centre(x, z):
    found = RoomMeter(LENS).update(with_spot(np.array([x, 0.0, z])), TABLE, None, 0.0)
    light = light_of(found)
    red = np.maximum(light[:, 0] - light[:, 1] - 0.1, 0.0)
    seen = (red * solid_angles(ENVIRONMENT_PX)) @ UNIT
    wanted = np.array([x, 0.0, z]) - CENTRE_M
    cosine = seen @ wanted / np.linalg.norm(seen) / np.linalg.norm(wanted)
    assert np.degrees(np.arccos(cosine)) < 2.0


def with_card(image, x, z):
    """Return a picture with a card of 10 × 12 cm that stands at a place, turned to the camera."""
    corners = np.array(
        [(x - 0.05, 0, z), (x + 0.05, 0, z), (x + 0.05, 0.12, z), (x - 0.05, 0.12, z)]
    )
    at = corners @ TABLE[:3, :3].T + TABLE[:3, 3]
    pixels = np.rint(Projection(LENS).project(at)).astype(np.int32)
    cv2.fillConvexPoly(image, pixels, (0, 0, 255))
    return image


@pytest.mark.parametrize(("x", "z"), [(-0.16, 0.0), (0.16, -0.05)])
def test_a_card_that_comes_stands_on_the_table(x, z):
    meter = RoomMeter(LENS)
    meter.update(grey(70), TABLE, None, 0.0)
    light = light_of(meter.update(with_card(grey(70), x, z), TABLE, None, 1.0))
    red = np.maximum(light[:, 0] - light[:, 1] - 0.1, 0.0) * solid_angles(ENVIRONMENT_PX)
    wanted = np.array([x, 0.06, z]) - CENTRE_M
    seen = red @ UNIT
    cosine = seen @ wanted / np.linalg.norm(seen) / np.linalg.norm(wanted)
    assert np.degrees(np.arccos(cosine)) < 8.0
    high = UNIT[red > 0][:, 1].max()  # as high as the card is, as seen from the centre
    assert high == pytest.approx(0.04 / np.hypot(0.04, np.hypot(x, z)), abs=0.12)


def test_a_card_that_was_there_lies_on_the_table_and_one_that_goes_leaves_nothing():
    meter = RoomMeter(LENS)
    first = meter.update(grey(70), TABLE, None, 0.0)
    meter.update(with_card(grey(70), -0.16, 0.0), TABLE, None, 1.0)
    again = meter.update(grey(70), TABLE, None, 2.0)
    assert np.abs(light_of(first) - light_of(again)).max() < 0.01


def test_what_stands_in_the_centre_hides_nothing():
    meter = RoomMeter(LENS)
    first = light_of(meter.update(grey(70), TABLE, None, 0.0))
    there = light_of(meter.update(with_card(grey(70), 0.0, 0.02), TABLE, None, 1.0))
    assert np.abs(first - there).max() < 0.01


def test_light_that_is_switched_on_is_nothing_that_stands():
    meter = RoomMeter(LENS)
    meter.update(grey(70), TABLE, None, 0.0)
    alone = RoomMeter(LENS).update(grey(160), TABLE, None, 1.0)
    found = meter.update(grey(160), TABLE, None, 1.0)
    assert np.array_equal(light_of(found), light_of(alone))


def test_what_is_far_is_on_the_side_of_the_picture_that_it_is_in():
    image = grey(60)
    image[:40, :120] = 255, 0, 0  # the upper left corner, above the horizon of this camera
    level = table_from(pitch=0.1)
    light = light_of(RoomMeter(LENS).update(image, level, None, 0.0))
    blue = np.maximum(light[:, 2] - light[:, 0] - 0.1, 0.0) * (UNIT[:, 1] > 0)
    x, y, z = blue @ UNIT / blue.sum()
    assert x < -0.2
    assert y > 0.05
    assert z < -0.2


def test_a_room_of_one_colour_is_that_everywhere():
    found = RoomMeter(LENS).update(grey(140), TABLE, None, 0.0)
    assert found is not None
    assert np.ptp(found.planes) <= 1
    assert abs(int(found.planes[0, 0]) - 140) <= 1


@pytest.mark.parametrize("value", [0, 3])
def test_no_direction_that_was_never_seen_is_black(value):
    light = light_of(RoomMeter(LENS).update(grey(value), TABLE, None, 0.0))
    above = UNIT[:, 1] > 0.5  # which this camera does not see
    assert light[above].min() > 0.9 * MIN_LIGHT


def test_a_sheet_on_the_table_gets_the_light_that_was_measured():
    ambient = np.array([0.5, 0.4, 0.3])
    measured = MeasuredLight(np.array([0.0, -1.0, 0.0]), np.full(3, 0.4), ambient, 0.9)
    found = RoomMeter(LENS).update(grey(120), TABLE, measured, 0.0)
    share = solid_angles(ENVIRONMENT_PX) * np.maximum(UNIT[:, 1], 0.0)
    assert share @ light_of(found) / share.sum() == pytest.approx(ambient, rel=0.03)


def test_what_the_camera_saw_from_elsewhere_is_remembered():
    meter, opposite = RoomMeter(LENS), table_from(yaw=np.pi, pitch=0.2)
    meter.update(grey(180), table_from(pitch=0.2), None, 0.0)
    found = light_of(meter.update(grey(60), opposite, None, 1.0))
    alone = light_of(RoomMeter(LENS).update(grey(60), opposite, None, 1.0))
    first, second = texels_at(np.array([[0.0, 0.02, -1.0], [0.0, 0.02, 1.0]]), ENVIRONMENT_PX)
    assert found[first] == pytest.approx(LINEAR_FROM_SRGB[180], rel=0.05)
    assert found[second] == pytest.approx(LINEAR_FROM_SRGB[60], rel=0.05)
    assert alone[first] == pytest.approx(LINEAR_FROM_SRGB[60], rel=0.05)


def test_a_picture_that_stays_makes_no_new_map_and_noise_neither():
    meter, rng = RoomMeter(LENS), np.random.default_rng(1)
    first = meter.update(grey(100), TABLE, None, 0.0)
    for number in range(1, 30):
        noisy = np.clip(rng.normal(100, 4, (*SIZE[::-1], 3)), 0, 255).astype(np.uint8)
        assert meter.update(noisy, TABLE, None, number / 30) is first


def test_maps_are_at_most_two_a_second_and_evenly_spaced_while_all_changes():
    meter, times = RoomMeter(LENS), []
    for number in range(120):
        found = meter.update(grey(10 + 2 * number), TABLE, None, number / 30)
        assert found is not None
        if found.timestamp not in times:
            times.append(found.timestamp)
    assert len(times) > 4
    assert np.subtract(times[2:], times[:-2]).min() >= TWO_MAPS_S - 1e-5
    assert np.diff(times)[2:].max() < RENEWAL_INTERVAL_S + 0.1


def test_what_changes_much_just_after_another_change_is_in_a_map_soon():
    meter = RoomMeter(LENS)
    times, picture = set(), grey(60)
    for number in range(90):
        if number == 60:
            picture = with_spot((0.1, 0.0, 0.0))
        if number == 62:
            picture = grey(200)
        found = meter.update(picture, TABLE, None, number / 30)
        assert found is not None
        times.add(round(30 * found.timestamp))
    assert len(times) == 3
    assert 62 <= sorted(times)[-1] <= 62 + 30 * (HASTY_INTERVAL_S + LOOK_INTERVAL_S)


def test_there_is_none_without_a_table_and_one_at_once_with_it():
    meter = RoomMeter(LENS)
    assert meter.update(grey(90), None, None, 0.0) is None
    assert meter.update(grey(90), TABLE, None, 0.01) is not None


def test_a_recording_that_is_wound_back_goes_on():
    meter = RoomMeter(LENS)
    meter.update(grey(90), TABLE, None, 50.0)
    found = meter.update(grey(200), TABLE, None, 1.0)
    assert found is not None
    assert found.timestamp == 1.0


def test_a_camera_that_does_not_see_the_table_knows_nothing():
    away = TABLE.copy()
    away[:3, :3] = away[:3, :3] @ np.diag([-1.0, 1.0, -1.0])
    away[2, 3] = -5.0
    assert RoomMeter(LENS).update(grey(90), away, None, 0.0) is None


def test_guesses_are_between_what_is_known_and_next_to_it_the_same():
    rng = np.random.default_rng(2)
    light = rng.random((384, 3)).astype(np.float32)
    known = (rng.random((384, 1)) < 0.2).astype(np.float32)
    guess = filled(light, known)
    seen = light[known[:, 0] > 0]
    low, high = seen.min(axis=0), seen.max(axis=0)
    assert (guess >= low - 1e-5).all()
    assert (guess <= high + 1e-5).all()
    alone = np.zeros_like(known)
    alone[300] = 1.0
    assert np.allclose(filled(light, alone), light[300])


def test_enlarged_faces_have_no_seams():
    coarse = directions(8).astype(np.float32)
    fine = enlarged(coarse, 64).reshape(-1, 3)
    assert np.abs(fine - UNIT).max() < 0.05


def test_planes_of_another_shape_are_refused():
    found = RoomMeter(LENS).update(grey(90), TABLE, None, 0.0)
    assert found is not None
    with pytest.raises(ValueError, match="texels"):
        replace(found, planes=found.planes[1:])
