"""What is out of focus is blurred as a lens blurs it; what is in focus is not touched."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from cubeling.characters.model.mesh import Material
from cubeling.characters.rendering import QUALITIES, Effect, Focus, Stage
from tests.characters.rendering.shapes import Still, mesh

DEPTH = 0.45
"""Distance of the table's middle in `view` from the camera [m], about."""


@pytest.fixture
def lens(ctx):
    stage = Stage(ctx, (320, 180))
    effects = frozenset([Effect.DEPTH_OF_FIELD])
    stage.quality = replace(QUALITIES["rich"], effects=effects)
    yield stage
    stage.release()


def checkerboard(fields=24, side=0.2):
    """A black and white board, level on the table, of one field for each two triangles."""
    column, row = np.meshgrid(np.arange(fields), np.arange(fields))
    corner = np.stack([column, row], axis=-1).reshape(-1, 1, 2)
    flat = (corner + [[0, 0], [0, 1], [1, 1], [1, 0]]).reshape(-1, 2) * side / fields - side / 2
    positions = np.insert(flat, 1, 0.001, axis=1)
    first = 4 * np.arange(fields**2)[:, None]
    triangles = np.concatenate([first + [0, 1, 2], first + [0, 2, 3]])
    board = mesh(positions, np.tile([0.0, 1.0, 0.0], (len(flat), 1)), triangles, Material())
    white = np.repeat((column + row).ravel() % 2, 4).astype(np.float32)
    colors = np.ones((len(flat), 4), np.float32)
    colors[:, :3] = 0.05 + 0.8 * white[:, None]
    return Still((replace(board, colors=colors),)).posed()


def test_in_focus_nothing_changes(lens, view, pawn):
    sharp = lens.draw(view, [pawn.posed()])
    focused = lens.draw(replace(view, focus=Focus(0.1, 2.0, 0.05)), [pawn.posed()])
    assert np.array_equal(sharp, focused)


def test_a_pawn_in_focus_is_the_same_beside_one_that_is_not(lens, view, pawn):
    here, near = (
        pawn.posed(at=(-0.08, -0.05), height=0.06),
        pawn.posed(at=(0.08, 0.09), height=0.06),
    )
    sharp = lens.draw(view, [here, near])
    depths = (0.9 * DEPTH, 2.0)
    blurred = lens.draw(replace(view, focus=Focus(*depths, 0.06)), [here, near])
    red = (sharp[..., 2].astype(int) - sharp[..., 1]) > 60
    left = np.arange(320)[None, :] < 160
    assert np.array_equal(blurred[red & left], sharp[red & left])
    assert np.abs(blurred.astype(int) - sharp)[red & ~left].max() > 25


def test_contrast_falls_with_the_distance_from_the_focus(lens, view):
    variances = []
    for focus in (DEPTH, 0.9 * DEPTH, 0.8 * DEPTH, 0.7 * DEPTH):
        picture = lens.draw(replace(view, focus=Focus(focus, focus, 0.02)), [checkerboard()])
        variances.append(picture[90:110, 140:180].astype(float).var())
    assert variances == sorted(variances, reverse=True)
    assert variances[-1] < 0.3 * variances[0]


def test_a_blurred_pawn_keeps_its_light(lens, view, pawn):
    """It spreads over the table around it, and no light is lost or added."""
    black = replace(view, image=np.zeros_like(view.image))
    sharp = lens.draw(black, [pawn.posed()]).astype(float)
    blurred = lens.draw(replace(black, focus=Focus(0.9, 0.9, 0.02)), [pawn.posed()]).astype(float)
    assert (blurred.sum(axis=2) > 0).sum() > 1.1 * (sharp.sum(axis=2) > 0).sum()
    assert blurred.sum() == pytest.approx(sharp.sum(), rel=0.1)


@pytest.fixture
def room(view, cube):
    """Return a view of an open cube before a picture that is black, but for a lamp above."""
    opened, image = replace(cube, opening=1.0), np.zeros_like(view.image)
    image[:8] = 200
    return replace(view, image=image, occluders=(opened,))


def test_the_blur_of_what_is_behind_a_cube_does_not_cover_it(lens, room, pawn):
    empty = lens.draw(room, [])
    inner = cv2.erode(empty.max(axis=2), np.ones((3, 3))) > 20
    behind = pawn.posed(at=(-0.05, -0.03))
    blurred = lens.draw(replace(room, focus=Focus(0.3, 0.3, 0.02)), [behind])
    assert (blurred.max(axis=2) > 20).sum() > (empty.max(axis=2) > 20).sum() + 500
    assert np.abs(blurred.astype(int) - empty)[inner].max() <= 2  # the light changes a little


def test_behind_the_blurred_edge_of_who_is_inside_a_cube_is_the_room(lens, room, pawn):
    box = room.occluders[0]
    empty = lens.draw(room, [])
    inner = cv2.erode(empty.max(axis=2), np.ones((3, 3))) > 40
    stands = np.diag([0.04, 0.04, 0.04, 1.0])
    stands[1, 3] = -0.45 * box.edge
    place = np.linalg.inv(room.camera_from_table) @ box.camera_from_box @ stands
    posed = replace(pawn.posed().posed, table_from_character=place)
    actor = replace(pawn.posed(), posed=posed, inside=box)
    blurred = lens.draw(replace(room, focus=Focus(0.25, 0.25, 0.02)), [actor])
    changed = np.abs(blurred.astype(int) - empty).max(axis=2) > 10
    assert (changed & inner).sum() > 100
    assert blurred.max(axis=2)[inner].min() > 30  # the picture is black
