"""Soft and coloured shadows: the law of the penumbra, and the light behind glass."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from cubeling.characters.model.character import Character
from cubeling.characters.model.mesh import Material
from cubeling.characters.rendering import QUALITIES, Effect, Quality, Stage
from cubeling.characters.rendering.deferred.blocker_map import CLOSE_UP_SIDE, MAP_SIDE
from cubeling.characters.rendering.deferred.lamp import LAMP_DISTANCE_M, LAMP_WIDTH_M
from cubeling.characters.rendering.passes.deferred import visibility
from cubeling.characters.rendering.passes.deferred.soft_shadows import TABLE_SIDE, SoftShadowPass
from cubeling.tracking.appearance import MeasuredLight
from tests.bench.effects import close_up
from tests.bench.picture import SIZE, scene
from tests.characters.rendering.shapes import Still, ball, plate
from tests.characters.rendering.watch import WatchPass

SOFT = Effect.SOFT_SHADOWS
RED = (1.0, 0.0, 0.0)


def pane(height, color=(0.5, 0.5, 0.5), opacity=1.0, side=0.12):
    material = Material(
        base_color=(*color, opacity),
        alpha_cutoff=0.5,
        blended=True,
        double_sided=True,
        roughness=0.9 + 0.01 * height,  # panes are not merged to one surface
    )
    return plate(material, (0.0, height, 0.0), side)


@pytest.fixture
def left(ctx, view):
    """Return a function that gives the light below panes: the square's texels, and its side [m]."""
    stage = Stage(ctx, (320, 180))
    stage.quality = QUALITIES["rich"]
    (shadows,) = (each for each in stage.passes if isinstance(each, SoftShadowPass))
    overhead = view.camera_from_table[:3, :3] @ [0.0, 1.0, 0.0]
    lit = replace(view, light=MeasuredLight(overhead, np.full(3, 0.7), np.full(3, 0.3), 1.0))

    def below(*panes):
        for _ in range(120):  # the light changes to the measured one smoothly
            stage.draw(lit, [])
        stage.draw(lit, [Still(panes).posed()])
        tile = np.array([0.5, 1.0, 1.0, 1.0, 0.5]) / 4.0
        texels = np.frombuffer(shadows.left.read(), np.float16).reshape(TABLE_SIDE, TABLE_SIDE, 4)
        return cv2.sepFilter2D(texels[..., :3].astype(np.float32), -1, tile, tile), shadows.square[
            2
        ]

    yield below
    stage.release()


def penumbra(texels, side):
    """Width of the shadow's edge from 10 to 90 % of the light [m], by colour of white light."""
    row = texels[TABLE_SIDE // 2, :, 1]
    middle = int(np.argmin(row))
    edge = row[middle:]
    x = np.arange(len(edge)) * side / TABLE_SIDE
    return np.interp(0.9, edge, x) - np.interp(0.1, edge, x)


@pytest.mark.full
def test_the_penumbra_grows_as_the_law_says(left):
    """A lamp of width w gives 0.8 (dR - dB) w / dB between 10 and 90 %."""
    for height in (0.03, 0.06, 0.09):
        found = penumbra(*left(pane(height), pane(0.0, side=0.02)))
        # The lamp is LAMP_DISTANCE_M from the middle of what casts shadows.
        receiver = LAMP_DISTANCE_M + height / 2
        expected = 0.8 * height * LAMP_WIDTH_M / (receiver - height)
        assert found == pytest.approx(expected, rel=0.2)


def test_there_is_full_light_beside_and_none_in_the_umbra(left):
    texels, _ = left(pane(0.03))
    assert texels[TABLE_SIDE // 2, TABLE_SIDE // 2].max() == 0.0
    assert texels[2, 2].min() == pytest.approx(1.0, abs=0.01)


def test_a_shadow_is_sharp_where_its_caster_touches_the_table(left):
    texels, side = left(pane(0.002))
    assert penumbra(texels, side) < 0.003


def light_behind(left, *panes):
    texels, side = left(*panes)
    half = int(0.02 / side * TABLE_SIDE)
    middle = slice(TABLE_SIDE // 2 - half, TABLE_SIDE // 2 + half)
    return texels[middle, middle].mean(axis=(0, 1))


def test_light_behind_a_half_red_pane_is_half_red(left):
    assert light_behind(left, pane(0.03, RED, 0.5)) == pytest.approx([1.0, 0.5, 0.5], abs=0.05)


def test_an_opaque_pane_lets_no_light_through(left):
    assert light_behind(left, pane(0.03, RED, 1.0)).max() == 0.0


def test_two_panes_multiply_their_light(left):
    green = (0.0, 1.0, 0.0)
    for second, expected in ((RED, [1.0, 0.25, 0.25]), (green, [0.5, 0.5, 0.25])):
        found = light_behind(left, pane(0.03, RED, 0.5), pane(0.035, second, 0.5))
        assert found == pytest.approx(expected, abs=0.05)


def test_the_map_is_finer_close_up_alone(ctx, view, pawn):
    stage = Stage(ctx, (320, 180))
    stage.quality = QUALITIES["rich"]
    (shadows,) = (each for each in stage.passes if isinstance(each, SoftShadowPass))
    near = replace(view, matrix=view.matrix * np.array([[30.0], [30.0], [1.0]]))
    for seen, side in ((view, MAP_SIDE), (near, CLOSE_UP_SIDE), (view, MAP_SIDE)):
        stage.draw(seen, [pawn.posed()])
        assert shadows._blockers.texture.size == (side, side)
    stage.release()


def test_who_is_inside_a_cube_does_not_coarsen_the_shadow_on_the_table(ctx, view, pawn, cube):
    stage = Stage(ctx, (320, 180))
    stage.quality = QUALITIES["rich"]
    (shadows,) = (each for each in stage.passes if isinstance(each, SoftShadowPass))
    stage.draw(view, [pawn.posed()])
    alone = shadows.square
    inside = replace(pawn.posed(at=(0.6, 0.0)), inside=replace(cube, opening=1.0))
    stage.draw(view, [pawn.posed(), inside])
    assert shadows.square == alone
    stage.release()


@pytest.mark.full
@pytest.mark.slow(reason="a picture is lit from the whole lamp in each pixel")
def test_close_up_the_light_of_the_lamp_is_found_for_cells_nearly_as_for_each_pixel(
    ctx, monkeypatch
):
    view, actor_at = scene(Character.load("human"))
    near = close_up(view, actor_at(0))
    pictures = []
    for cell_m, effects in ((0.0, {SOFT}), (visibility.MIN_CELL_M, {SOFT}), (0.0, set())):
        monkeypatch.setattr(visibility, "MIN_CELL_M", cell_m)
        stage = Stage(ctx, SIZE)
        stage.quality = Quality("tested", 1, False, deferred=True, effects=frozenset(effects))
        pictures.append(stage.draw(near, [actor_at(0)]).astype(float))
        stage.release()
    by_pixel, by_cell, without = pictures
    shadow = np.abs(by_pixel - without).max(axis=2)
    error = np.abs(by_cell - by_pixel).max(axis=2)
    assert (shadow > 10).sum() > 2000
    assert 0.0 < error[shadow > 10].mean() < 0.1 * shadow[shadow > 10].mean()


@pytest.fixture
def lit_share(ctx, view):
    """Return a function that gives the share of the lamp's light in each texel of shapes.

    It is called with the direction to the lamp in the table frame, and meshes; it returns the
    share (n,) where there is light without shadows, and the places (n, 3) in the table frame [m].
    """
    stage, watch = Stage(ctx, (320, 180)), WatchPass()

    def share(to_light, *meshes):
        measured = view.camera_from_table[:3, :3] @ to_light / np.linalg.norm(to_light)
        lit = replace(view, light=MeasuredLight(measured, np.full(3, 0.7), np.full(3, 0.3), 1.0))
        light = []
        for effects in ({SOFT}, set()):
            stage.quality = replace(QUALITIES["rich"], name="tested", effects=frozenset(effects))
            stage.passes.append(watch)
            for _ in range(120):  # the light changes to the measured one smoothly
                stage.draw(lit, [])
            watch.forget()
            stage.draw(lit, [Still(meshes).posed()])
            light.append(watch.diffuse[..., :3].sum(axis=-1))
            place = watch.position[..., :3]
            stage.passes.remove(watch)
        seen = light[1] > 0.2
        table = np.linalg.inv(view.camera_from_table)
        return light[0][seen] / light[1][seen], place[seen] @ table[:3, :3].T + table[:3, 3]

    yield share
    stage.release()


def test_a_shadow_begins_where_what_casts_it_comes_out_of_a_surface(lit_share):
    """A ball is sunk into a board by more than half, as hair is into a head."""
    board = plate(Material(), (0.0, 0.01, 0.0), 0.2)
    ball_ = ball(Material(base_color=(0.2, 0.2, 0.2, 1.0)), (0.0, 0.0, 0.0), 0.03)
    share, place = lit_share(np.array([-1.0, 0.8, 0.0]), board, ball_)
    rim = np.sqrt(0.03**2 - 0.01**2)
    on_board = np.abs(place[:, 1] - 0.01) < 1e-4
    behind = on_board & (np.abs(place[:, 2]) < 0.004)
    behind &= (place[:, 0] > rim + 0.001) & (place[:, 0] < rim + 0.003)
    before = on_board & (place[:, 0] < -rim)
    assert behind.sum() > 10
    assert before.sum() > 100
    assert share[behind].max() < 0.3
    assert share[before].min() > 0.97


def test_no_surface_shadows_itself_where_it_bends(lit_share):
    """A ball, and two boards that meet in a hollow as wide open as the lamp is high."""
    to_light = np.array([0.3, 1.0, 0.2]) / np.linalg.norm([0.3, 1.0, 0.2])
    share, place = lit_share(to_light, ball(Material()))
    facing = (place - [0.0, 0.06, 0.0]) @ to_light > 0.06 * 0.2  # all of the lamp is above it
    assert facing.sum() > 500
    assert share[facing].min() > 0.96
    slope = np.deg2rad(20.0)
    boards = []
    for side in (-1.0, 1.0):
        flat = plate(Material(), side=0.08)
        turn = np.array(
            [
                [np.cos(side * slope), -np.sin(side * slope), 0.0],
                [np.sin(side * slope), np.cos(side * slope), 0.0],
                [0.0, 0.0, 1.0],
            ]
        )
        at = [0.04 * side * np.cos(slope), 0.04 * np.sin(slope) + 0.01, 0.0]
        boards.append(
            replace(
                flat,
                positions=(flat.positions @ turn.T + at).astype(np.float32),
                normals=(flat.normals @ turn.T).astype(np.float32),
            )
        )
    share, place = lit_share(np.array([0.1, 1.0, 0.1]), *boards)
    assert len(share) > 500
    assert share[np.abs(place[:, 0]) < 0.01].min() > 0.97
