"""Open cubes: what is seen through the holes in their walls, and what is not."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from cubeling.characters.model.mesh import Material
from cubeling.characters.rendering import QUALITIES, SceneCharacter, Stage
from cubeling.characters.rendering.projection import project
from cubeling.characters.rendering.scene import RIM_SHARE, WALL_SHARE
from cubeling.tracking.appearance import HandMask
from tests.examples import some

EDGE = 0.06


def placed(view, turn_deg=20.0, at=(0.0, 0.03, 0.07), tilt_deg=0.0):
    """Return `camera_from_box` of a cube on the table, turned about up and tilted about its x."""
    yaw, tilt = np.deg2rad([turn_deg, tilt_deg])
    table_from_box = np.eye(4)
    turn = np.array([[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]])
    lean = np.array([[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]])
    table_from_box[:3, :3] = turn @ lean
    table_from_box[:3, 3] = at
    return view.camera_from_table @ table_from_box


@pytest.fixture
def opened(cube, view):
    """Return a function that makes an open cube."""

    def make(opening=1.0, **place):
        return replace(cube, camera_from_box=placed(view, **place), opening=opening)

    return make


def resident(pawn, view, box, at=(0.0, 0.0), height=0.03, foot=WALL_SHARE):
    """Return a pawn in a cube, which stands on the wall that is its floor; at in the box [m]."""
    table_from_box = np.linalg.inv(view.camera_from_table) @ box.camera_from_box
    stands = np.diag([height, height, height, 1.0])
    stands[:3, 3] = at[0], (foot - 0.5) * box.edge, at[1]
    posed = replace(pawn.posed().posed, table_from_character=table_from_box @ stands)
    return SceneCharacter(pawn, posed, inside=box)


def pixels(view, box, points):
    """Return the pixels (n, 2) of points (n, 3) of a cube whose edge is 1 long."""
    pose = box.camera_from_box
    return project(box.edge * np.asarray(points) @ pose[:3, :3].T + pose[:3, 3], view.matrix)


def filled(shape, polygon):
    """Return the pixels whose centres lie in a convex polygon, (n, 2)."""
    rows, columns = np.indices(shape)
    along = np.roll(polygon, -1, axis=0) - polygon
    offset = np.stack([columns, rows], axis=-1)[:, :, None] - polygon
    side = along[:, 0] * offset[..., 1] - along[:, 1] * offset[..., 0]
    return (side > 0).all(axis=-1) | (side < 0).all(axis=-1)


def near_faces(box):
    """Return the outward normals of the faces that look at the camera."""
    eye = -box.camera_from_box[:3, :3].T @ box.camera_from_box[:3, 3] / box.edge
    return [n for n in np.vstack([np.eye(3), -np.eye(3)]) if eye @ n > 0.5]


def square(normal, half):
    """Return the corners of a square on a face, in order."""
    axis = int(np.argmax(np.abs(normal)))
    first, second = np.roll(np.eye(3), -axis - 1, axis=0)[:2]
    signs = ((1, 1), (-1, 1), (-1, -1), (1, -1))
    return np.array([0.5 * normal + half * (a * first + b * second) for a, b in signs])


def eroded(mask, size=3):
    return cv2.erode(mask.astype(np.uint8), np.ones((size, size))).astype(bool)


def changed(picture, view):
    return (picture != view.image).any(axis=2)


@pytest.fixture
def hd_stage(ctx):
    stage = Stage(ctx, (1280, 720))
    yield stage
    stage.release()


def test_a_closed_cube_draws_bit_for_bit_what_it_did(stage, view, pawn, cube):
    actors = [pawn.posed(at=(-0.03, 0.0))]
    plain = stage.draw(replace(view, occluders=(cube,)), actors)
    stage.draw(replace(view, occluders=(replace(cube, opening=1.0),)), actors)
    again = stage.draw(replace(view, occluders=(replace(cube, opening=0.0),)), actors)
    assert np.array_equal(plain, again)


@pytest.mark.parametrize("turn_deg", some([20.0, 0.0, 45.0, 70.0]))
def test_holes_and_rims_are_where_a_pinhole_camera_sees_them(stage, view, opened, turn_deg):
    box = opened(turn_deg=turn_deg)
    picture = stage.draw(replace(view, occluders=(box,)), [])
    holes = np.zeros(picture.shape[:2], bool)
    full = np.zeros_like(holes)
    for normal in near_faces(box):
        holes |= filled(holes.shape, pixels(view, box, square(normal, 0.5 - RIM_SHARE)))
        full |= filled(holes.shape, pixels(view, box, square(normal, 0.5)))
    drawn = changed(picture, view)
    # The corners of holes are round: a cross in the middle of each face is surely open.
    crosses = np.zeros_like(holes)
    for normal in near_faces(box):
        crosses |= filled(holes.shape, pixels(view, box, square(normal, 0.5 - RIM_SHARE - 0.08)))
    assert drawn[eroded(crosses)].all()
    assert not drawn[~cv2.dilate(holes.astype(np.uint8), np.ones((3, 3))).astype(bool)].any()
    assert (full & ~holes).sum() > 200


def round_square(normal, half, radius):
    """Return points (n, 3) around a hole with round corners, in order."""
    corner = radius * np.exp(1j * np.linspace(0.0, np.pi / 2.0, 9)) + (half - radius) * (1 + 1j)
    outline = np.concatenate([corner * 1j**quarter for quarter in range(4)])
    axis = int(np.argmax(np.abs(normal)))
    first, second = np.roll(np.eye(3), -axis - 1, axis=0)[:2]
    return 0.5 * normal + outline.real[:, None] * first + outline.imag[:, None] * second


@pytest.mark.parametrize("opening", [0.4, 1.0])
@pytest.mark.parametrize("turn_deg", some([35.0, 0.0]))
def test_holes_have_the_size_and_the_round_corners_of_their_outlines(
    hd_stage, hd_view, cube, turn_deg, opening
):
    box = replace(cube, camera_from_box=placed(hd_view, turn_deg), opening=opening)
    drawn = changed(hd_stage.draw(replace(hd_view, occluders=(box,)), []), hd_view)
    holes = np.zeros(drawn.shape, np.uint8)
    half = (0.5 - RIM_SHARE) * opening
    for normal in near_faces(box):
        outline = pixels(hd_view, box, round_square(normal, half, min(0.08, half)))
        cv2.fillConvexPoly(holes, np.rint(16 * outline).astype(np.int32), 1, cv2.LINE_8, 4)
    shared, either = (drawn & (holes > 0)).sum(), (drawn | (holes > 0)).sum()
    assert shared / either > 0.955  # half a pixel around each hole


def test_a_half_open_cube_has_holes_of_half_the_size(stage, view, opened):
    box = opened(opening=0.5)
    drawn = changed(stage.draw(replace(view, occluders=(box,)), []), view)
    holes = np.zeros(drawn.shape, bool)
    for normal in near_faces(box):
        holes |= filled(holes.shape, pixels(view, box, square(normal, 0.5 * (0.5 - RIM_SHARE))))
    assert 0.85 < drawn.sum() / holes.sum() < 1.25
    assert not drawn[~cv2.dilate(holes.astype(np.uint8), np.ones((3, 3))).astype(bool)].any()


@pytest.mark.parametrize("turn_deg", some([30.0, -15.0, 0.0]))
def test_a_point_inside_is_seen_where_a_pinhole_camera_sees_it(
    hd_stage, hd_view, cube, turn_deg, pawn
):
    """So its parallax against the rims is right: both are projected by the same camera."""
    box = replace(cube, camera_from_box=placed(hd_view, turn_deg), opening=1.0)
    green = Material(base_color=(0.0, 0.0, 0.0, 1.0), emissive=(0.0, 1.0, 0.0))
    lamp = replace(pawn, meshes=(replace(pawn.meshes[0], material=green),))
    for x, z, height in ((0.008, -0.01, 0.012), (-0.008, 0.006, 0.012), (0.0, 0.0, 0.012)):
        actor = replace(resident(pawn, hd_view, box, (x, z), height), character=lamp)
        seen = hd_stage.draw(replace(hd_view, occluders=(box,)), [actor]).astype(int)
        places = np.argwhere(seen[..., 1] - seen[..., [0, 2]].max(axis=2) > 40)[:, ::-1]
        points = pawn.meshes[0].positions * height + [x, (WALL_SHARE - 0.5) * EDGE, z]
        expected = pixels(hd_view, box, points / EDGE)
        assert np.abs(places.min(axis=0) - expected.min(axis=0)).max() < 1.3
        assert np.abs(places.max(axis=0) - expected.max(axis=0)).max() < 1.3


@pytest.mark.slow(reason="three pictures of 1280 by 720 pixels are drawn")
def test_in_a_hole_a_character_has_the_pixels_that_it_has_without_a_cube(
    hd_stage, hd_view, cube, pawn
):
    box = replace(cube, camera_from_box=placed(hd_view, 10.0), opening=1.0)
    actor = resident(pawn, hd_view, box, height=0.03)
    inside = hd_stage.draw(replace(hd_view, occluders=(box,)), [actor]).astype(int)
    empty = hd_stage.draw(replace(hd_view, occluders=(box,)), []).astype(int)
    free = hd_stage.draw(hd_view, [replace(actor, inside=None)]).astype(int)
    body = free[..., 2] - free[..., 1] > 60
    holes = np.zeros(body.shape, bool)
    for normal in near_faces(box):
        holes |= filled(body.shape, pixels(hd_view, box, square(normal, 0.5 - RIM_SHARE - 0.05)))
    seen = eroded(holes & body)
    assert seen.sum() > 500
    assert np.abs(inside - free)[seen].mean() < 6.0  # the light is estimated again
    assert np.abs(inside - empty)[seen].sum(axis=1).mean() > 60.0


@pytest.mark.parametrize("quality", QUALITIES.values(), ids=list(QUALITIES))
def test_a_character_inside_is_drawn_at_no_pixel_outside_of_the_cube(
    stage, view, opened, pawn, quality
):
    """Not even one that is far too large for it and sticks out on all sides."""
    stage.quality = quality
    for tilt in (0.0, 25.0):
        box = opened(tilt_deg=tilt)
        giant = resident(pawn, view, box, height=0.2, foot=-0.6)
        picture = stage.draw(replace(view, occluders=(box,)), [giant])
        assert (picture[..., 2].astype(int) - picture[..., 1] > 60).sum() > 100
        outline = np.zeros(picture.shape[:2], bool)
        for normal in near_faces(box):
            outline |= filled(outline.shape, pixels(view, box, square(normal, 0.5)))
        grown = cv2.morphologyEx(outline.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((3, 3)))
        allowed = cv2.dilate(grown, np.ones((3, 3))).astype(bool)
        assert not (changed(picture, view) & ~allowed).any()


def test_walls_and_rims_hide_what_is_inside_behind_them(stage, view, opened, pawn):
    box = opened(turn_deg=0.0)
    inside = stage.draw(replace(view, occluders=(box,)), [resident(pawn, view, box)])
    rim = np.zeros(inside.shape[:2], bool)
    for normal in near_faces(box):
        rim |= filled(rim.shape, pixels(view, box, square(normal, 0.5)))
    for normal in near_faces(box):
        hole = filled(rim.shape, pixels(view, box, square(normal, 0.5 - RIM_SHARE)))
        rim &= ~cv2.dilate(hole.astype(np.uint8), np.ones((3, 3))).astype(bool)
    assert rim.sum() > 100
    assert np.array_equal(inside[rim], view.image[rim])


def test_a_character_inside_has_a_shadow_on_its_floor_and_none_on_the_table(
    stage, view, opened, pawn
):
    box = opened(turn_deg=0.0)
    empty = stage.draw(replace(view, occluders=(box,)), []).astype(int)
    lived_in = stage.draw(replace(view, occluders=(box,)), [resident(pawn, view, box)]).astype(int)
    outline = np.zeros(empty.shape[:2], bool)
    for normal in near_faces(box):
        outline |= filled(outline.shape, pixels(view, box, square(normal, 0.52)))
    assert np.array_equal(lived_in[~outline], view.image[~outline])
    near_feet = np.rint(pixels(view, box, [[0.20, WALL_SHARE - 0.5, 0.0]])[0]).astype(int)[::-1]
    assert empty[tuple(near_feet)].sum() - lived_in[tuple(near_feet)].sum() > 8


def test_a_character_behind_an_open_cube_is_not_seen_through_it(stage, view, opened, pawn):
    box = opened(at=(0.0, 0.03, 0.09))
    behind = pawn.posed(at=(0.0, -0.04))
    alone = stage.draw(replace(view, occluders=(box,)), []).astype(int)
    both = stage.draw(replace(view, occluders=(box,)), [behind]).astype(int)
    outline = np.zeros(alone.shape[:2], bool)
    for normal in near_faces(box):
        outline |= filled(outline.shape, pixels(view, box, square(normal, 0.5)))
    assert np.abs(both - alone)[eroded(outline)].max() <= 1  # its shadow ends at the outline
    free = stage.draw(view, [behind]).astype(int)
    assert (free[..., 2] - free[..., 1] > 60)[outline].sum() > 40


def test_a_nearer_closed_cube_hides_an_open_one(stage, view, opened, pawn):
    box = opened(at=(0.0, 0.03, 0.0))
    nearer = opened(opening=0.0, at=(0.0, 0.03, 0.11))
    seen = stage.draw(replace(view, occluders=(box, nearer)), [resident(pawn, view, box)])
    hidden = np.zeros(seen.shape[:2], bool)
    for normal in near_faces(nearer):
        hidden |= filled(hidden.shape, pixels(view, nearer, square(normal, 0.5)))
    assert changed(seen, view).sum() > 100
    assert np.array_equal(seen[eroded(hidden)], view.image[eroded(hidden)])


def test_a_hand_in_front_hides_room_and_character(stage, view, opened, pawn):
    box = opened()
    column = round(float(pixels(view, box, [[0.0, 0.0, 0.0]])[0, 0]))
    behind = 0.85 * box.camera_from_box[:3, 3]
    hand = HandMask(column - 15, 0, np.full((180, 30), 255, np.uint8), behind)
    shown = replace(view, occluders=(box,), hand=hand)
    picture = stage.draw(shown, [resident(pawn, view, box)])
    inside = np.s_[:, column - 14 : column + 14]
    assert np.array_equal(picture[inside], view.image[inside])
    assert changed(picture, view).sum() > 100


def test_light_changes_smoothly_while_a_wall_turns_to_the_camera(stage, view, opened):
    """A hole opens where a wall begins to face the camera: nothing may flash by that."""
    low = WALL_SHARE - 0.5
    places = [[0.2, -0.1, low], [0.3, low, -0.3], [-0.3, low, -0.3]]  # a wall, and two corners
    seen = []
    for turn in np.arange(-12.0, 12.1, 0.5):
        box = opened(turn_deg=turn)
        picture = stage.draw(replace(view, occluders=(box,)), [])
        columns, rows = np.rint(pixels(view, box, places)).astype(int).T
        seen.append(picture[rows, columns].mean(axis=1))
    assert np.abs(np.diff(seen, axis=0)).max() < 4.0


@pytest.mark.parametrize("quality", some([*QUALITIES.values()][::-1], 2))
def test_every_quality_draws_an_empty_room_and_a_character_beside_it(
    stage, view, opened, pawn, quality
):
    stage.quality = quality
    box = opened(at=(-0.06, 0.03, 0.05))
    beside = pawn.posed(at=(0.07, 0.03))
    shown = replace(view, occluders=(box,))
    empty = stage.draw(shown, [])
    assert changed(empty, view)[:, :160].sum() > 500
    both = stage.draw(shown, [beside])
    outline = np.zeros(both.shape[:2], bool)
    for normal in near_faces(box):
        outline |= filled(outline.shape, pixels(view, box, square(normal, 0.5)))
    inner = eroded(outline)
    assert np.abs(both.astype(int) - empty)[inner].max() <= 2
    assert changed(both, view)[:, 160:].sum() > 500


def test_an_empty_room_and_a_second_open_cube_can_be_drawn(stage, view, opened, pawn):
    first, second = opened(at=(-0.06, 0.03, 0.05)), opened(at=(0.07, 0.03, 0.05))
    shown = replace(view, occluders=(first, second))
    picture = stage.draw(shown, [resident(pawn, view, second)])
    left, right = changed(picture, view)[:, :160].sum(), changed(picture, view)[:, 160:].sum()
    assert 0.5 < left / right < 2.0


def test_an_open_cube_at_the_lens_or_behind_the_camera_breaks_nothing(stage, view, opened):
    for depth in (0.03, -0.3):
        pose = np.eye(4)
        pose[2, 3] = depth
        stage.draw(replace(view, occluders=(replace(opened(), camera_from_box=pose),)), [])


@pytest.mark.parametrize("change", [{"edge": 0.0}, {"camera_from_box": np.diag([0.0, 0, 0, 1])}])
def test_nobody_is_drawn_inside_a_cube_that_has_no_size_or_pose(stage, view, pawn, opened, change):
    box = replace(opened(), **change)
    actor = replace(pawn.posed(), inside=box)
    picture = stage.draw(replace(view, occluders=(box,)), [actor])
    assert np.array_equal(picture, view.image)
