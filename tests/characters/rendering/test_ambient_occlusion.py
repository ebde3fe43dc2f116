from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import moderngl
import numpy as np
import pytest

from cubeling.app.workshop.reproduction.bodies.occlusion_buffer import GBuffer
from cubeling.characters.errors import CharacterError
from cubeling.characters.rendering.deferred.ambient_occlusion import (
    ESTIMATORS,
    NOTHING_M,
    AmbientOcclusion,
    AmbientOcclusionSettings,
    Estimator,
)
from cubeling.characters.rendering.deferred.cells import cell_count
from cubeling.characters.rendering.deferred.sample_patterns import PATTERNS, sample_pattern
from cubeling.characters.rendering.passes.deferred.occlusion import cells_from_texels
from cubeling.characters.rendering.programs import ShaderPrograms
from tests.bench.ambient_occlusion.product import product_quality
from tests.bench.ambient_occlusion.quality import matched_score
from tests.bench.ambient_occlusion.scenes import load
from tests.bench.ambient_occlusion.scoring import THESIS, TracedScene, buffer_of, drawn, score
from tests.examples import some
from tools.ray_tracing import VisibleSurfaces

SIZE = (192, 144)
ROWS, COLUMNS = 48, 64
PITCH = 2.0**-12
"""Distance between pixels of the orthographic surfaces [m]: sums of it are exact in float32."""


@pytest.fixture(scope="module")
def programs(_context):
    programs = ShaderPrograms(_context)
    yield programs
    programs.release()


@pytest.fixture
def draw(ctx, programs) -> Iterator[Any]:
    buffers = []

    def draw(surfaces: VisibleSurfaces, focal_px: float, **settings):
        buffers.append(GBuffer(ctx, surfaces, focal_px))
        return drawn(ctx, programs, buffers[-1], AmbientOcclusionSettings(**settings))

    yield draw
    for buffer in buffers:
        buffer.release()


def surfaces(position, normal) -> VisibleSurfaces:
    """Return a G-buffer without background from arrays (height, width, 3)."""
    shape = (*position.shape[:2], 1)
    normal_id = np.concatenate([np.broadcast_to(normal, position.shape), np.ones(shape)], axis=2)
    with_one = np.concatenate([position, np.ones(shape)], axis=2)
    return VisibleSurfaces(
        normal_id.astype(np.float32), with_one.astype(np.float32), normal_id[..., :3]
    )


def orthographic(depth: np.ndarray, normal) -> VisibleSurfaces:
    """Return surfaces whose pixels are `PITCH` apart; the pinhole's rays do not matter here."""
    y, x = np.mgrid[: depth.shape[0], : depth.shape[1]] * PITCH
    return surfaces(np.stack([x, y, depth], axis=-1), normal)


def plane(normal) -> VisibleSurfaces:
    """Return a plane at 1 m seen by a pinhole camera of 64 px."""
    y, x = np.mgrid[:ROWS, :COLUMNS] + 0.5
    rays = np.stack([(x - COLUMNS / 2) / 64, (y - ROWS / 2) / 64, np.ones_like(x)], axis=-1)
    normal = np.asarray(normal) / np.linalg.norm(normal)
    return surfaces(rays * (normal[2] / (rays @ normal))[..., None], normal)


def wall_and_floor() -> VisibleSurfaces:
    """Return a wall above a floor, both seen at 45°; they meet between rows 23 and 24."""
    row = np.arange(ROWS)
    depth = 2.0 - np.abs(row - 23.5) * PITCH
    normal = np.sqrt(0.5) * np.where((row < 24)[:, None], [0.0, 1.0, -1.0], [0.0, -1.0, -1.0])
    return orthographic(
        np.repeat(depth[:, None], COLUMNS, axis=1), np.repeat(normal[:, None], COLUMNS, axis=1)
    )


@pytest.mark.parametrize("estimator", ESTIMATORS)
@pytest.mark.parametrize("normal", some([[0.5, -0.5, -0.7], [0, 0, -1], [0, -1, -0.7]]))
def test_a_plane_is_open(draw, estimator, normal):
    found = draw(plane(normal), 64.0, estimator=estimator, radius_m=0.15)
    assert found[16:-16, 16:-16].min() > 0.999


@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_a_corner_is_darkest_where_its_sides_meet_and_open_beyond_the_radius(draw, estimator):
    radius = 10 * PITCH
    found = draw(
        wall_and_floor(),
        2.0 / PITCH,
        estimator=estimator,
        samples=21,
        radius_m=radius,
        pattern_size=4,
        blur_size=4,
    )
    floor = found[24:, 32]
    assert floor[0] < 0.9
    # The last pixel of the floor beside the edge of the picture sees less: rows 24 to 40 count.
    assert (np.diff(floor[:16]) > -0.004).all()
    assert floor[15:18].min() > 0.995


@pytest.mark.parametrize(("share", "weight"), [(0.5, 0.1875), (1.0, 0.0), (1.5, 0.0), (1e-4, 1.0)])
def test_an_occluder_straight_above_counts_by_wendlands_weight_of_its_distance(draw, share, weight):
    depth = np.full((9, 9), 2.0)
    seen = orthographic(depth, (0.0, 0.0, -1.0))
    middle = seen.position[4, 4, :3].copy()
    seen.position[..., :3] = middle + (0.0, 0.0, -share)
    seen.position[4, 4, :3] = middle
    plain = Estimator(darkness=1.0, bias=0.0, crowding=0.0, reach=1.0)
    found = draw(
        seen,
        4.0,
        estimator="angular",
        radius_m=1.0,
        constants=plain,
        blur_size=0,
        samples=3,
        pattern="regular",
    )
    assert found[4, 4] == pytest.approx(1.0 - weight, abs=1e-4)


@pytest.mark.parametrize("samples", [5, 11, 21])
def test_the_separable_form_takes_2k_samples_and_the_full_form_k_squared(samples):
    assert AmbientOcclusionSettings(samples=samples).samples_per_pixel == 2 * samples
    assert AmbientOcclusionSettings(samples=samples, lines=None).samples_per_pixel == samples**2


def test_a_tile_leaves_no_noise_along_a_wall_and_random_lines_for_each_pixel_do(draw):
    def noise(pattern_size: int) -> float:
        found = draw(
            wall_and_floor(),
            2.0 / PITCH,
            estimator="angular",  # to the others, the eye's direction matters, which varies
            pattern="random",
            pattern_size=pattern_size,
            blur_size=4,
            radius_m=10 * PITCH,
        )
        return float(found[16:40, 16:-16].std(axis=1).mean())

    assert noise(4) < 1e-6
    assert noise(64) > 1e-3


@pytest.fixture(scope="module")
def balls():
    return TracedScene(load("balls"), SIZE, 16)


@pytest.mark.full
@pytest.mark.parametrize("estimator", some(ESTIMATORS, 2))
def test_two_lines_miss_less_of_the_full_form_than_one_with_as_many_samples(
    ctx, programs, balls, estimator
):
    def error(samples: int, lines: int) -> float:
        """Return the error against the full form with as many samples on each line."""
        radius = balls.scene.radius_m
        few = replace(THESIS, estimator=estimator, samples=samples, lines=lines, radius_m=radius)
        found, full = (
            drawn(ctx, programs, buffer, each) for each in (few, replace(few, lines=None))
        )
        return matched_score(found, full, balls.surfaces.seen).rmse

    buffer = buffer_of(ctx, balls)
    assert error(11, 2) <= 0.6 * error(22, 1)
    buffer.release()


@pytest.mark.full
@pytest.mark.parametrize("samples", some([11, 21]))
def test_two_lines_are_closer_to_a_dense_disc_than_one_with_as_many_samples(
    ctx, programs, balls, samples
):
    by_area = replace(ESTIMATORS["angular"], crowding=0.0, by_area=1.0)
    radius = balls.scene.radius_m
    two = replace(THESIS, estimator="angular", samples=samples, radius_m=radius, constants=by_area)
    buffer = buffer_of(ctx, balls)
    variants = two, replace(two, samples=2 * samples, lines=1), replace(two, samples=41, lines=16)
    found, one_line, dense = (drawn(ctx, programs, buffer, each) for each in variants)
    buffer.release()
    seen = balls.surfaces.seen
    error = matched_score(found, dense, seen).rmse
    assert error <= 0.6 * matched_score(one_line, dense, seen).rmse


@pytest.mark.parametrize("samples", some([11, 5, 21]))
@pytest.mark.parametrize("estimator", some(ESTIMATORS, 2))
def test_the_separable_form_is_close_to_the_full_form(ctx, programs, balls, estimator, samples):
    buffer = buffer_of(ctx, balls)
    radius = balls.scene.radius_m
    separable = replace(THESIS, estimator=estimator, samples=samples, radius_m=radius)
    found, full = (
        drawn(ctx, programs, buffer, each) for each in (separable, replace(separable, lines=None))
    )
    buffer.release()
    result = matched_score(found, full, balls.surfaces.seen)
    assert result.rmse <= 0.03
    assert result.correlation >= 0.98


@pytest.fixture(scope="module")
def corner():
    return TracedScene(load("corner"), (319, 241), 32)


@pytest.mark.full
@pytest.mark.parametrize("name", some(["corner", "human", "vleo"]))
def test_the_default_settings_are_close_to_ray_traced_pictures(ctx, programs, corner, name):
    traced = corner if name == "corner" else TracedScene(load(name), (320, 240), 32)
    buffer = buffer_of(ctx, traced)
    found = drawn(ctx, programs, buffer, AmbientOcclusionSettings(radius_m=traced.scene.radius_m))
    buffer.release()
    result = score(found, traced.truth, traced.surfaces.seen)
    nothing = score(np.ones_like(found), traced.truth, traced.surfaces.seen)
    assert result.rmse <= 0.03
    assert result.delta_e < 3.0
    assert result.rmse < 0.5 * nothing.rmse


def test_what_ends_soon_behind_its_front_hides_less_of_a_wall(ctx, programs):
    """A bar is before a wall, and the picture shows neither its back nor what is behind it."""
    focal, wall, bar = 64.0, 1.0, 0.9
    y, x = np.mgrid[:ROWS, :COLUMNS] + 0.5
    rays = np.stack([(x - COLUMNS / 2) / focal, (y - ROWS / 2) / focal, np.ones_like(x)], axis=-1)
    on_bar = np.abs(x - COLUMNS / 2) < 3
    seen = surfaces(rays * np.where(on_bar, bar, wall)[..., None], (0.0, 0.0, -1.0))
    settings = AmbientOcclusionSettings(lines=8, radius_m=0.3)

    def beside_bar(thickness: float | None) -> float:
        depths = None
        if thickness is not None:
            depths = np.full((ROWS, COLUMNS, 4), NOTHING_M, np.float32)
            depths[..., 3] = np.where(on_bar, bar, wall)
            depths[on_bar, :2] = bar + thickness, wall
        buffer = GBuffer(ctx, seen, focal, depths)
        found = drawn(ctx, programs, buffer, settings)
        buffer.release()
        return float(found[ROWS // 2, COLUMNS // 2 + 4])

    endless, deep, thin, thinner = (beside_bar(each) for each in (None, 0.099, 0.01, 0.005))
    assert endless == pytest.approx(deep, abs=0.01)  # it reaches to the wall
    assert deep + 0.05 < thin < thinner < 0.99, (deep, thin, thinner)


@pytest.mark.full
def test_the_programs_own_picture_of_a_character_is_close_to_rays(ctx):
    found = product_quality(ctx, "robot", 32)
    assert found.misplaced_mm < 1e-3
    assert found.drawn.rmse <= 0.035
    assert found.drawn.rmse < 0.25 * found.occluded


def test_normals_for_shading_bring_no_darkness_from_below_the_triangle(draw):
    """They lean away from the plane by 35°, as at the rim of a body of few triangles."""
    seen = plane((0.0, 0.0, -1.0))
    seen.normal_id[..., :3] = np.array([0.7, 0.0, -1.0]) / np.hypot(0.7, 1.0)
    assert draw(seen, 64.0, radius_m=0.15)[16:-16, 16:-16].min() > 0.999


@pytest.mark.parametrize("stride", some([3, 2]))
def test_cells_of_several_texels_are_close_to_ray_traced_pictures_too(
    ctx, programs, corner, stride
):
    depths = np.pad(corner.depths, ((0, 2), (0, 2), (0, 0)), mode="edge")
    cells = np.ascontiguousarray(depths[stride // 2 :: stride, stride // 2 :: stride])
    buffer = buffer_of(ctx, corner)
    buffer.depths.release()
    buffer.depths = ctx.texture(cells.shape[1::-1], 4, cells.tobytes(), dtype="f4")
    settings = AmbientOcclusionSettings(radius_m=corner.scene.radius_m)
    effect = AmbientOcclusion(ctx, programs, settings)
    found = buffer.draw(effect, stride=stride)
    buffer.release()
    effect.release()
    seen = corner.surfaces.seen
    assert (found[~seen] == 1.0).all()
    assert score(found, corner.truth, seen).rmse <= 0.03


@pytest.mark.parametrize("stride", [1, 2, 3, 6])
def test_the_middle_of_a_cell_is_that_of_the_texel_in_its_middle(stride):
    size = 37, 23
    cells = np.array(cell_count(size, stride))
    cell = cells - 2
    texel = stride * cell + stride // 2
    seen = np.array([*(2.0 * (texel + 0.5) / size - 1.0), 0.3, 1.0])
    moved = cells_from_texels(size, stride) @ seen
    np.testing.assert_allclose((moved[:2] + 1.0) / 2.0 * cells, cell + 0.5, atol=1e-9)
    np.testing.assert_array_equal(moved[2:], seen[2:])


def test_the_background_is_open(draw, balls):
    focal = float(balls.scene.matrix(SIZE)[0, 0])
    found = draw(balls.surfaces, focal, radius_m=balls.scene.radius_m)
    assert (found[~balls.surfaces.seen] == 1.0).all()


def test_only_the_first_texels_of_larger_textures_count(ctx, programs, balls):
    small, large = buffer_of(ctx, balls), buffer_of(ctx, balls)
    rng = np.random.default_rng(0)
    for name in ("normal_id", "position", "depths"):
        values = np.frombuffer(getattr(large, name).read(), np.float32).reshape(*SIZE[::-1], 4)
        padded = rng.normal(size=(SIZE[1] + 40, SIZE[0] + 30, 4)).astype(np.float32)
        padded[: SIZE[1], : SIZE[0]] = values
        getattr(large, name).release()
        setattr(large, name, ctx.texture(padded.shape[1::-1], 4, padded.tobytes(), dtype="f4"))
    settings = AmbientOcclusionSettings(radius_m=balls.scene.radius_m)
    expected, found = (drawn(ctx, programs, buffer, settings) for buffer in (small, large))
    np.testing.assert_array_equal(found, expected)
    small.release()
    large.release()


def test_the_ground_goes_on_outside_of_a_part_of_a_picture(ctx, programs):
    """A wall stands on a floor; the picture ends just above the floor."""
    focal, radius = 64.0, 0.4
    y, x = np.mgrid[:ROWS, :COLUMNS] + 0.5
    rays = np.stack([(x - COLUMNS / 2) / focal, (y - ROWS / 2) / focal, np.ones_like(x)], axis=-1)
    wall = GBuffer(ctx, surfaces(rays, (0.0, 0.0, -1.0)), focal)
    foot = np.array([0.0, 1.0 / (rays[-1, 0, 1] + 0.5 / focal), 0.0])
    effect = AmbientOcclusion(ctx, programs, AmbientOcclusionSettings(samples=21, radius_m=radius))

    def row_means(ground: np.ndarray | None) -> np.ndarray:
        return np.asarray(wall.draw(effect, ground).mean(axis=1))

    alone, on_floor = row_means(None), row_means(foot)
    assert alone.min() > 0.999
    assert on_floor[-1] < 0.8
    assert (np.diff(on_floor[ROWS // 2 :]) < 0.002).all()
    assert on_floor[: ROWS - 27].min() > 0.99
    effect.release()
    wall.release()


def test_a_smaller_picture_draws_in_the_same_texture_and_a_larger_one_in_a_new_one(ctx, programs):
    effect = AmbientOcclusion(ctx, programs)
    textures = [ctx.texture((200, 150), 4, dtype="f4") for _ in range(3)]

    def draw(size: tuple[int, int]) -> moderngl.Texture:
        return effect.draw(textures[0], textures[1], textures[2], size, 100.0)

    first = draw((100, 100))
    assert draw((64, 30)) is first
    larger = draw((200, 150))
    assert larger is not first
    assert larger.size == (256, 192)
    effect.release()
    effect.release()
    for texture in textures:
        texture.release()


@pytest.mark.parametrize("name", PATTERNS)
def test_a_pattern_turns_all_pixels_of_a_tile_differently(name):
    pattern = sample_pattern(name, 4)
    assert ((pattern >= 0.0) & (pattern < 1.0)).all()
    assert len(np.unique(pattern[..., 0])) == 16
    np.testing.assert_array_equal(pattern, sample_pattern(name, 4))


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"estimator": "magic"}, "unknown estimator of ambient occlusion 'magic'"),
        ({"pattern": "plaid"}, "choose one of random, regular"),
        ({"samples": 1}, "not 1 on 2"),
        ({"lines": 0}, "not 29 on 0"),
        ({"radius_m": float("nan")}, "a radius above 0 m"),
    ],
)
def test_settings_that_cannot_be_drawn_are_refused_in_one_line(settings, said):
    with pytest.raises(CharacterError, match=said) as refusal:
        AmbientOcclusionSettings(**settings)
    assert "\n" not in str(refusal.value)
