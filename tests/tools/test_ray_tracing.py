import numpy as np
import pytest

from tests.bench.ambient_occlusion.scenes import box, floor, rectangle, seen_from, sphere
from tools.ray_tracing import (
    AreaLight,
    Pane,
    RayTracer,
    Triangles,
    ambient_occlusion,
    light_fraction,
    trace_camera,
    trace_depth_layers,
    wendland,
)
from tools.ray_tracing.mesh import Floats
from tools.ray_tracing.subsurface import flat_reflectance, walk

pytestmark = pytest.mark.full

MATRIX = np.array([[40.0, 0, 20], [0, 40.0, 15], [0, 0, 1]])


def units(count: int, seed: int) -> Floats:
    vectors = np.random.default_rng(seed).normal(size=(count, 3))
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True), np.float32)


def first_hits(mesh: Triangles, origins: Floats, directions: Floats) -> Floats:
    """Return distances by testing every triangle (Möller and Trumbore 1997), (rays,)."""
    a, b, c = np.moveaxis(mesh.positions[mesh.corners].astype(float), 1, 0)
    cross = np.cross(directions[:, None], c - a)
    inverse = 1.0 / np.einsum("tc,rtc->rt", b - a, cross)
    way = origins[:, None] - a
    u = inverse * np.einsum("rtc,rtc->rt", way, cross)
    other = np.cross(way, b - a)
    v = inverse * np.einsum("rc,rtc->rt", directions, other)
    t = inverse * np.einsum("tc,rtc->rt", c - a, other)
    hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
    return np.asarray(np.where(hit, t, np.inf).min(axis=1), np.float32)


def test_rays_hit_what_a_test_of_every_triangle_says():
    rng = np.random.default_rng(4)
    positions = rng.normal(size=(60, 3, 3)) * 0.3 + rng.normal(size=(60, 1, 3))
    normals = np.tile([0.0, 0.0, 1.0], (180, 1))
    mesh = Triangles.of(positions.reshape(-1, 3), normals, np.arange(180).reshape(-1, 3))
    origins, directions = np.float32(0.5) * units(500, 1), units(500, 2)
    expected = first_hits(mesh, origins, directions)
    tracer = RayTracer(mesh)
    assert 100 < np.isfinite(expected).sum() < 450
    np.testing.assert_allclose(tracer.distances(origins, directions), expected, rtol=1e-4)
    hits = tracer.hits(origins, directions)
    np.testing.assert_allclose(hits.distances, expected, rtol=1e-4)
    np.testing.assert_array_equal(hits.triangles >= 0, np.isfinite(expected))


def test_a_ray_ends_at_its_greatest_distance():
    tracer = RayTracer(floor(2.0))
    origin, down = np.array([[0.1, 1.0, 0.2]], np.float32), np.array([[0.0, -1.0, 0.0]], np.float32)
    assert tracer.distances(origin, down, 1.1) == pytest.approx(1.0)
    assert np.isinf(tracer.distances(origin, down, 0.9))


def test_a_camera_sees_positions_normals_and_objects_of_a_ball_on_a_floor():
    ball = sphere((0.0, 0.5, 0.0), 0.5)
    mesh = seen_from(Triangles.joined([floor(20.0), ball]), (0, 1.5, 3.0), (0, 0.4, 0))
    seen = trace_camera(RayTracer(mesh), MATRIX, (40, 30))
    center = seen_from(sphere((0.0, 0.5, 0.0), 1e-6), (0, 1.5, 3.0), (0, 0.4, 0)).positions[0]
    on_ball = seen.normal_id[..., 3] == 2
    assert on_ball.sum() > 50
    offset = seen.position[on_ball][:, :3] - center
    np.testing.assert_allclose(np.linalg.norm(offset, axis=1), 0.5, atol=0.003)
    np.testing.assert_allclose(seen.normal_id[on_ball][:, :3], offset / 0.5, atol=0.02)
    toward = np.einsum("hwc,hwc->hw", seen.flat_normal, seen.position[..., :3])[seen.seen]
    assert (toward < 0.0).all()
    ray = (np.array([7.5, 22.5, 1.0]) @ np.linalg.inv(MATRIX).T)[:2]
    np.testing.assert_allclose(seen.position[22, 7, :2] / seen.position[22, 7, 2], ray, atol=1e-5)


def test_depth_layers_are_both_sides_of_what_is_seen_and_of_the_next_thing_behind_it():
    near, second, third = (box((0.0, 0.0, z), (0.2, 0.2, 0.1)) for z in (1.0, 2.0, 3.0))
    sheet = rectangle((-0.2, 0.1, 1.5), (0.4, 0, 0), (0, 0.1, 0))  # looks away, below the middle
    wall = rectangle((0.4, -2.0, 4.0), (0, 4.0, 0), (2.0, 0, 0))  # looks to the camera, right
    mesh = Triangles.joined([near, second, third, sheet, wall])
    found = trace_depth_layers(RayTracer(mesh), MATRIX, (40, 30))
    np.testing.assert_allclose(found[14, 19], [1.1, 1.9, 2.1, 0.9], rtol=1e-4)
    np.testing.assert_allclose(found[18, 19], [1.1, 1.9, 1.5, 0.9], rtol=1e-4)
    np.testing.assert_allclose(found[14, 30], [1e3, 1e3, 1e3, 4.0], rtol=1e-4)
    np.testing.assert_array_equal(found[14, 5], np.full(4, 1e3))


def test_inside_a_ball_everything_is_as_occluded_as_its_radius_says():
    mesh = Triangles.joined(
        [sphere((0.0, 0.0, 0.5), 1.0), rectangle((-0.01, -0.01, 0.5), (0.02, 0, 0), (0, 0.02, 0))]
    )
    tracer = RayTracer(mesh)
    seen = trace_camera(
        tracer, np.diag([4000.0, 4000.0, 1.0]) + [[0, 0, 4], [0, 0, 4], [0] * 3], (8, 8)
    )
    found = ambient_occlusion(tracer, seen, 2.0)
    np.testing.assert_allclose(
        found, 1.0 - float(wendland(np.ones(1, np.float32), 2.0)[0]), atol=0.01
    )
    # A cosine over the hemisphere: what is beyond the radius does not count.
    assert (ambient_occlusion(tracer, seen, 0.9) == 1.0).all()


def test_the_share_of_an_area_light_is_that_of_its_visible_part():
    light = AreaLight(np.array([-0.5, 2.0, -0.5]), np.array([[1.0, 0, 0], [0, 0, 1.0]]))
    # Half way up, a wide board hides all of the light on the left of x = 0 from the origin.
    tracer = RayTracer(rectangle((-2.0, 1.0, -2.0), (2.0, 0, 0), (0, 0, 4.0)))
    points = np.array([[0.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.25, 0.0, 0.0]], np.float32)
    found = light_fraction(tracer, points, light)
    np.testing.assert_allclose(found, [[0.5] * 3, [0.0] * 3, [0.75] * 3], atol=0.01)


def test_light_takes_the_colours_of_all_panes_that_it_passes():
    light = AreaLight(np.array([-0.5, 2.0, -0.5]), np.array([[1.0, 0, 0], [0, 0, 1.0]]))
    tracer = RayTracer(floor(1.0, height=-1.0))
    red = Pane(np.array([-2.0, 1.0, -2.0]), np.array([[4.0, 0, 0], [0, 0, 4.0]]), (0.8, 0.2, 0.1))
    half = Pane(np.array([-2.0, 0.5, -2.0]), np.array([[2.0, 0, 0], [0, 0, 4.0]]), (0.5, 1.0, 1.0))
    found = light_fraction(tracer, np.zeros((1, 3), np.float32), light, [red, half])
    np.testing.assert_allclose(found[0], [0.8 * 0.75, 0.2, 0.1], atol=0.01)


def test_walks_in_a_thick_ball_come_out_as_from_flat_skin():
    mesh = sphere((0.0, 0.0, 0.0), 0.05)
    tracer = RayTracer(mesh)
    outward = tracer.flat_normals(np.arange(len(mesh.corners), dtype=np.int32))
    middles = mesh.positions[mesh.corners].mean(axis=1)
    outward *= np.sign(np.einsum("ij,ij->i", outward, middles))[:, None]
    real = np.linalg.norm(outward, axis=1) > 0.5  # not so at the poles
    middles, outward = middles[real], outward[real]
    rng = np.random.default_rng(3)
    exits = [walk(tracer, middles, -outward, 880.0, 170.0, rng) for _ in range(20)]
    share = sum(len(each.starts) for each in exits) / (20 * len(middles))
    assert share == pytest.approx(flat_reflectance(880.0, 170.0), rel=0.02)
    away = np.concatenate([np.linalg.norm(e.points - middles[e.starts], axis=1) for e in exits])
    assert np.sqrt((away**2).mean()) == pytest.approx(1.6e-3, rel=0.1)  # as on flat skin
