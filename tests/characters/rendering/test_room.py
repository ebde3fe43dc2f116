"""The room's light on characters: white in white, from the right side, and no pop."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters.model.mesh import Material
from cubeling.characters.rendering import QUALITIES
from cubeling.characters.rendering.camera_picture.light import LINEAR_FROM_SRGB, TO_LIGHT, Light
from cubeling.characters.rendering.environment import room as fading
from cubeling.characters.rendering.environment.cube_map import (
    directions,
    harmonics,
    irradiance,
    pyramid,
)
from cubeling.characters.rendering.environment.reflections import (
    HEIGHT,
    PARTS,
    ROUGHNESS_TILES,
    WIDTH,
    filter_at_once,
    octahedral_directions,
)
from tests.characters.rendering.room_maps import (
    UNIT,
    WHITE,
    even_light,
    light_of_ball,
    painted,
)

FULL, RICH = QUALITIES["full"], replace(QUALITIES["rich"], effects=frozenset())


def with_card(side, colour=(1.0, 0.0, 0.0), size=0.9):
    """Return a grey room with a card on one side."""
    light = np.full((len(UNIT), 3), 0.2)
    light[UNIT @ side > size] = colour
    return painted(light)


@pytest.fixture
def draw(ctx, view):
    """Draw a ball with no lamp: linear light, (height, width, 3), and where it is."""

    def draw_ball(material, room, quality=FULL):
        return light_of_ball(ctx, view, quality, material, room)

    with even_light():
        yield draw_ball


@pytest.mark.parametrize("quality", [FULL, RICH], ids=["forward", "deferred"])
@pytest.mark.parametrize("metallic", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("roughness", [0.0, 0.2, 0.5, 0.8, 1.0])
def test_the_white_furnace_loses_nothing(draw, metallic, roughness, quality):
    """All light that falls on something white leaves it, at every angle: it is not seen."""
    light, drawn = draw(Material(metallic=metallic, roughness=roughness), painted(WHITE), quality)
    assert drawn.sum() > 2000
    assert np.abs(light[drawn] - 1.0).max() < 0.005


@pytest.mark.parametrize("side", [(-1.0, 0.2, 0.3), (1.0, 0.2, 0.3), (0.0, 1.0, 0.2)])
def test_a_card_is_seen_in_metal_on_its_side(draw, view, side):
    side = np.array(side) / np.linalg.norm(side)
    light, drawn = draw(Material(metallic=1.0, roughness=0.2), with_card(side))
    red = np.maximum(light[..., 0] - light[..., 1], 0.0) * drawn
    rows, columns = np.nonzero(drawn)
    middle = np.array([columns.mean(), rows.mean()])
    seen = (
        np.array(
            [
                (red.sum(axis=0) @ np.arange(red.shape[1])),
                (red.sum(axis=1) @ np.arange(red.shape[0])),
            ]
        )
        / red.sum()
    )
    radius = np.sqrt(drawn.sum() / np.pi)
    # The normal half way between the card and the camera.
    camera = -view.camera_from_table[:3, :3].T @ view.camera_from_table[:3, 3] - (0, 0.08, 0)
    normal = side + camera / np.linalg.norm(camera)
    normal = view.camera_from_table[:3, :3] @ (normal / np.linalg.norm(normal))
    assert (seen - middle) / radius == pytest.approx(normal[:2], abs=0.12)


def test_both_ways_of_lighting_give_the_same_picture(draw):
    rng = np.random.default_rng(3)
    light = np.repeat(rng.random((6, 8, 8, 3)), 8, axis=1).repeat(8, axis=2).reshape(-1, 3)
    for material in (Material(metallic=1.0, roughness=0.2), Material(roughness=0.7)):
        forward, drawn = draw(material, painted(light))
        later, _ = draw(material, painted(light), RICH)
        assert np.abs(forward - later)[drawn].max() < 0.02


def test_scattered_light_is_as_much_as_without_a_map(draw):
    """The map tells where light comes from, not how much: energy is preserved."""
    uneven = np.where(UNIT[:, :1] > 0.0, [0.8, 0.4, 0.2], [0.1, 0.2, 0.4])
    sphere = directions(16)
    coefficients = irradiance(pyramid(painted(uneven).planes))
    lighting = fading.RoomLighting(coefficients, np.zeros(4), None)
    light = Light(np.zeros(3), np.array([0.5, 0.4, 0.3]), np.array([0.1, 0.2, 0.3]), TO_LIGHT)
    falling = harmonics(sphere) @ lighting.uniforms(light)["irradiance"]
    share = np.abs(sphere).max(axis=1) ** 3
    mean = share @ falling / share.sum()
    assert mean == pytest.approx(0.5 * (light.sky + light.ground), rel=1e-3)


def test_harmonics_give_the_cosine_mean_of_the_light():
    """Of smooth light exactly; within a few percent of any (Ramamoorthi and Hanrahan, 2001)."""
    smooth = 0.4 + 0.3 * UNIT @ np.array([0.5, 0.6, -0.62])
    found = irradiance(pyramid(painted(np.repeat(smooth[:, None], 3, axis=1)).planes))
    normals = np.array([[0.0, 1.0, 0.0], [0.6, 0.0, 0.8], [-1.0, 0.0, 0.0]])
    share = np.abs(UNIT).max(axis=1) ** 3
    for normal, light in zip(normals, harmonics(normals) @ found, strict=True):
        weight = share * np.maximum(UNIT @ normal, 0.0)
        assert light == pytest.approx(np.full(3, weight @ smooth / weight.sum()), rel=0.01)


def test_a_map_of_one_colour_is_that_at_every_roughness():
    texels = filter_at_once(pyramid(painted(np.full_like(WHITE, 0.5)).planes))
    value = LINEAR_FROM_SRGB[188]
    for tile in ROUGHNESS_TILES:
        square = texels[tile.box][..., :3]
        assert np.ptp(square) == 0
        assert (square[0, 0] / 255.0) ** 2 == pytest.approx(value, rel=0.005)


def test_squares_lie_apart_in_the_texture():
    taken = np.zeros((HEIGHT, WIDTH), int)
    for tile in ROUGHNESS_TILES:
        taken[tile.box] += 1
        assert taken[tile.box].size == (tile.side + 2) ** 2
    assert taken.max() == 1


def test_rough_surfaces_mirror_a_lobe_around_the_direction():
    lamp = np.array([0.3, 0.5, -0.81])
    texels = filter_at_once(pyramid(with_card(lamp, (1.0, 1.0, 1.0), 0.98).planes))
    brightest = []
    for tile in ROUGHNESS_TILES:
        square = texels[tile.box][1:-1, 1:-1, 0].ravel().astype(float)
        brightest.append(float(square.max()))
        if tile.side > 16:
            towards = octahedral_directions(tile.side)[square.argmax()]
            assert np.degrees(np.arccos(min(towards @ lamp, 1.0))) < 14.0
    assert brightest == sorted(brightest, reverse=True)


def test_a_rim_goes_on_where_the_octahedron_does():
    texels = filter_at_once(pyramid(painted(0.5 + 0.4 * UNIT).planes))
    square = texels[ROUGHNESS_TILES[1].box].astype(float)
    inner = square[1:-1, 1:-1]
    step = np.abs(np.diff(inner, axis=0)).max()
    for rim, edge in ((square[0, 1:-1], inner[0]), (square[1:-1, -1], inner[:, -1])):
        assert np.abs(rim - edge).max() < 1.5 * step


ANY = [(0.0, 1.0)]
"""Surfaces of any roughness that mirror the room."""


def shown_by(maps, room, now):
    lighting = maps.update(room, now, ANY)
    assert lighting is not None
    return lighting.irradiance[0, 0]


def mirrored_by(maps, room, now):
    lighting = maps.update(room, now, ANY)
    assert lighting is not None
    assert lighting.texture is not None
    return (np.frombuffer(lighting.texture.read(), np.uint8) / 255.0) ** 2


def test_a_new_map_fades_in_and_never_back(ctx):
    maps = fading.RoomMaps(ctx)
    dark, bright = painted(np.full_like(WHITE, 0.1)), painted(np.full_like(WHITE, 0.8))
    before = shown_by(maps, dark, 0.0)
    values = [shown_by(maps, bright, 0.04 * (number + 1)) for number in range(36)]
    steps = np.diff([before, *values])
    assert values[PARTS - 2] == before  # it is being filtered
    assert values[-1] == pytest.approx(0.8, abs=0.01)
    assert (steps >= 0.0).all()
    assert steps.max() < 1.2 * (values[-1] - before) * 0.04 / fading.FADE_S
    assert mirrored_by(maps, bright, 1.5).max() == pytest.approx(values[-1], abs=0.01)
    maps.release()


def test_a_map_that_comes_during_a_fade_goes_on_from_what_is_shown(ctx):
    maps = fading.RoomMaps(ctx)
    rooms = [painted(np.full_like(WHITE, level)) for level in (0.1, 0.9, 0.2)]
    shown_by(maps, rooms[0], 0.0)
    values = [shown_by(maps, rooms[1 + (number > 12)], 0.04 * number) for number in range(1, 60)]
    assert np.abs(np.diff(values)).max() < 0.12
    assert max(values) < 0.9
    assert values[-1] == pytest.approx(0.2, abs=0.01)
    maps.release()


def test_nothing_is_filtered_where_nothing_mirrors(ctx):
    maps = fading.RoomMaps(ctx)
    for number in range(30):
        room = painted(np.full_like(WHITE, 0.1 + 0.02 * number))
        lighting = maps.update(room, 0.1 * number, [])
        assert lighting is not None
        assert lighting.texture is None
    assert filter_at_once(pyramid(room.planes), slice(0, 0)).size == 0


def test_only_squares_that_a_surface_mirrors_in_are_filtered(ctx):
    maps, bright = fading.RoomMaps(ctx), painted(np.full_like(WHITE, 0.6))
    lighting = maps.update(bright, 0.0, [(0.25, 0.3)])
    assert lighting is not None
    assert lighting.texture is not None
    texels = np.frombuffer(lighting.texture.read(), np.uint8).reshape(HEIGHT, WIDTH, 4)
    written = [bool(texels[tile.box].any()) for tile in ROUGHNESS_TILES]
    assert written == [tile.roughness in (0.25, 0.375) for tile in ROUGHNESS_TILES]
    assert mirrored_by(maps, bright, 0.1).max() == pytest.approx(0.6, abs=0.01)
    maps.release()


def test_the_first_mirror_sees_the_newest_map_at_once(ctx):
    maps = fading.RoomMaps(ctx)
    maps.update(painted(np.full_like(WHITE, 0.3)), 0.0, [])
    newest = painted(np.full_like(WHITE, 0.6))
    assert mirrored_by(maps, newest, 0.1).max() == pytest.approx(0.6, abs=0.01)
    maps.release()


def test_after_a_step_in_time_nothing_fades(ctx):
    maps = fading.RoomMaps(ctx)
    dark, bright = painted(np.full_like(WHITE, 0.1)), painted(np.full_like(WHITE, 0.8))
    shown_by(maps, dark, 10.0)
    assert shown_by(maps, bright, 3.0) == pytest.approx(0.8, abs=0.01)
    maps.release()


def test_a_stage_without_a_map_draws_as_before(stage, view, pawn):
    plain = stage.draw(view, [pawn.posed()])
    stage.forget()
    stage.draw(replace(view, room=painted(np.full_like(WHITE, 0.3))), [pawn.posed()])
    stage.forget()
    assert np.array_equal(stage.draw(view, [pawn.posed()]), plain)
