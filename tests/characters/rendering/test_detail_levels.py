"""Levels of detail: fewer triangles, the same picture."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays

from cubeling.characters import Character
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.rendering import QUALITIES
from cubeling.characters.rendering.geometry.character_cache import PictureFineness
from cubeling.characters.rendering.geometry.detail_levels import (
    DetailLevel,
    chosen_level,
    shape_only,
    with_levels,
)
from cubeling.characters.rendering.geometry.edge_collapse import Tolerance, collapsed_levels
from cubeling.characters.rendering.geometry.places import CELL_SHARE, connect, places_of
from cubeling.characters.rendering.geometry.vertices import CharacterVertices
from cubeling.characters.rendering.toys import TOYS, toy
from tests.bench.detail import compared
from tests.examples import some

FINE_AND_COARSE = (Tolerance(0.01), Tolerance(0.05))


def ball(center=(0.0, 0.0, 0.0), radius=1.0, rows=32):
    """Return positions and triangles of a closed sphere whose poles are small holes' rims."""
    turn, rise = np.meshgrid(
        np.arange(2 * rows) * np.pi / rows, np.linspace(-1.5, 1.5, rows), indexing="xy"
    )
    points = np.stack([np.cos(rise) * np.cos(turn), np.sin(rise), np.cos(rise) * np.sin(turn)], -1)
    number = np.arange(rows * 2 * rows).reshape(rows, -1)
    a, b = number[:-1], np.roll(number, -1, axis=1)[:-1]
    c, d = number[1:], np.roll(number, -1, axis=1)[1:]
    triangles = np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, c, b), (b, c, d))])
    return (radius * points.reshape(-1, 3) + center).astype(np.float32), triangles


def open_edges(places, triangles):
    """Return the places of the edges of the surface that belong to one triangle only, (n, 2)."""
    edges = places[np.stack([triangles, np.roll(triangles, -1, axis=1)], -1).reshape(-1, 2)]
    edges = np.sort(edges[edges[:, 0] != edges[:, 1]], axis=1)
    edges, uses = np.unique(edges, axis=0, return_counts=True)
    return edges[uses == 1]


def left(triangles, stand):
    corners = stand[triangles]
    return corners[(corners != np.roll(corners, 1, axis=1)).all(axis=1)]


def test_a_coarser_ball_is_still_a_ball():
    positions, triangles = ball()
    levels = collapsed_levels(positions, np.zeros((len(positions), 0)), triangles, FINE_AND_COARSE)
    counts = [len(left(triangles, stand)) for stand in levels]
    assert len(triangles) > 2 * counts[0] > 2 * counts[1] > 0
    for stand, tolerance in zip(levels, FINE_AND_COARSE, strict=True):
        middles = positions[left(triangles, stand)].mean(axis=1)
        heights = np.abs(middles[:, 1]) < 0.9  # beside the holes
        assert np.abs(np.linalg.norm(middles, axis=1)[heights] - 1.0).mean() < tolerance.distance


def test_levels_are_nested():
    positions, triangles = ball()
    fine, coarse = collapsed_levels(
        positions, np.zeros((len(positions), 0)), triangles, FINE_AND_COARSE
    )
    assert set(coarse) < set(fine)
    assert (coarse[fine] == coarse).all()


def test_a_seam_of_two_colours_does_not_tear():
    positions, triangles = ball()
    low = positions[triangles].mean(axis=1)[:, 1] < 0.1
    # The lower half has vertices of its own, as at a border of two colours.
    both = np.concatenate([positions, positions])
    split = np.where(low[:, None], triangles + len(positions), triangles)
    colors = np.repeat([0.0, 0.1], len(positions))[:, None]
    (stand,) = collapsed_levels(both, colors, split, [Tolerance(0.03)])
    _, places = np.unique(both, axis=0, return_inverse=True)
    places = places.ravel()
    coarse = left(split, stand)
    assert len(coarse) < 0.6 * len(split)
    # There are the rims of the poles.
    assert len(open_edges(places, coarse)) <= len(open_edges(places, split))
    of_low = coarse[:, 0] >= len(positions)
    assert (coarse[of_low] >= len(positions)).all()
    assert (coarse[~of_low] < len(positions)).all()


def test_a_seam_whose_sides_are_rounded_differently_does_not_tear():
    positions, triangles = ball()
    low = positions[triangles].mean(axis=1) @ [0.5, 0.7, 0.5] < 0.1
    split = np.where(low[:, None], triangles + len(positions), triangles)
    noise = np.random.default_rng(1).uniform(-1e-6, 1e-6, positions.shape)
    both = np.concatenate([positions, positions + noise]).astype(np.float32)
    (stand,) = collapsed_levels(both, np.zeros((len(both), 0)), split, [Tolerance(0.03)])
    places = np.tile(np.arange(len(positions)), 2)
    coarse = left(split, stand)
    assert len(coarse) < 0.6 * len(split)
    rims = open_edges(places, split)  # of the poles
    assert np.isin(open_edges(places, coarse), rims).all()


@given(
    arrays(np.float32, (20, 3), elements=st.floats(-1.0, 1.0, width=32)),
    arrays(float, (20, 3), elements=st.floats(-1.0, 1.0)),
)
def test_near_vertices_are_at_one_place_wherever_they_are(positions, steps):
    positions[:2] = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
    near = np.clip(positions + 0.2 * (2.0 * CELL_SHARE) * steps, -1.0, 1.0).astype(np.float32)
    place = places_of(np.concatenate([positions, near]))
    assert np.array_equal(place[:20], place[20:])


def test_the_ends_of_a_short_edge_are_two_places():
    positions = np.zeros((1000, 3), np.float32)
    positions[:-1, 1] = np.arange(999) * 1.5 * CELL_SHARE
    positions[-1] = 1.0
    assert places_of(positions).tolist() == np.argsort(np.argsort(positions[:, 1])).tolist()


def test_what_joints_or_morphs_move_apart_stays():
    positions, triangles = ball()
    steps = 0.2 * np.sin(40.0 * positions[:, :1])
    plain = collapsed_levels(
        positions, np.zeros((len(positions), 0)), triangles, [Tolerance(0.03)]
    )[0]
    moving = collapsed_levels(positions, steps, triangles, [Tolerance(0.03)])[0]
    assert len(left(triangles, moving)) > 2 * len(left(triangles, plain))


def test_a_spot_on_a_ball_stays_as_it_is():
    positions, triangles = ball()
    # A lens as thin as paper, with a rim.
    spot, spot_triangles = ball((0.0, 0.0, 1.0), 0.2, 8)
    spot[:, 2] = 1.0 + 0.01 * (spot[:, 2] - 1.0)
    both = np.concatenate([positions, spot])
    all_triangles = np.concatenate([triangles, spot_triangles + len(positions)])
    (stand,) = collapsed_levels(both, np.zeros((len(both), 0)), all_triangles, [Tolerance(0.05)])
    coarse = left(all_triangles, stand)
    of_spot = (coarse >= len(positions)).all(axis=1)
    outline = both[coarse[of_spot]].reshape(-1, 3)
    assert np.ptp(outline[:, :2], axis=0) == pytest.approx(np.ptp(spot[:, :2], axis=0), rel=0.02)
    assert np.ptp(outline[:, 2]) > 0.9 * np.ptp(spot[:, 2])
    assert (~of_spot).sum() < 0.5 * len(triangles)


def test_small_parts_give_way_where_a_level_lets_them():
    positions, triangles = ball(rows=12)
    counts = [
        len(left(triangles, stand))
        for share in (0.001, 0.1, 0.3)
        for stand in collapsed_levels(
            positions, np.zeros((len(positions), 0)), triangles, [Tolerance(1.0, share)]
        )
    ]
    assert len(triangles) == counts[0] > counts[1] > counts[2] > 0


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


def test_vertices_of_a_coarser_level_come_first(human):
    vertices, levels = with_levels(CharacterVertices.of(human.meshes))
    assert len(levels) > 1
    for level in levels:
        used = np.unique(level.indices)
        (_, moved), (start, fixed), (_, dormant) = level.parts
        assert start == vertices.moved
        assert dormant == 0
        assert used[used < start].max() < moved
        assert used[used >= start].max() < start + fixed
        assert sum(count for _, count in level.materials) == len(level.indices)
    assert levels[-1].parts[1][1] < 0.6 * levels[0].parts[1][1]
    for morph in vertices.morphs:
        assert (np.diff(morph.vertices.astype(int)) > 0).all()


def test_dormant_vertices_and_triangles_come_last(human):
    given = CharacterVertices.of(human.meshes)
    dormant = np.arange(sum(len(binds) for binds in given.binds)) % 2 == 0
    vertices, levels = with_levels(given, dormant)
    asleep = dormant[vertices.owners]
    asleep[: vertices.moved] = False  # a morph may show them
    for level in levels:
        awake = sum(count for _, count in level.materials[: level.awake])
        assert 0 < awake < len(level.indices)
        assert not asleep[level.indices[:awake].reshape(-1, 3)].all(axis=1).any()
        assert asleep[level.indices[awake:]].all()
        start, count = level.parts[2]
        assert asleep[start:].all()
        used = np.unique(level.indices)
        assert used[used >= start].max() < start + count


def test_the_finest_level_has_the_triangles_as_they_were_given(human):
    given = CharacterVertices.of(human.meshes)
    vertices, levels = with_levels(given)
    drawn = vertices.positions[levels[0].indices].reshape(-1, 9)
    expected = given.positions[given.indices].reshape(-1, 9)
    first = given.materials[0][1] // 3  # the triangles of the first material
    for part in (np.s_[:first], np.s_[first:]):
        assert np.array_equal(np.sort(drawn[part], axis=0), np.sort(expected[part], axis=0))


def test_what_is_further_from_its_bones_is_drawn_first(human):
    vertices, levels = with_levels(CharacterVertices.of(human.meshes))
    joints = np.concatenate([np.linalg.inv(bind)[:, :3, 3] for bind in vertices.binds])
    bones = np.einsum("vj,vjk->vk", vertices.weights, joints[vertices.joints])
    away = np.linalg.norm(vertices.positions - bones, axis=1)
    run = away[levels[0].indices[: levels[0].materials[0][1]]]
    assert run[: run.size // 4].mean() > 1.5 * run[-run.size // 4 :].mean()


def test_a_joint_without_a_bind_pose_hinders_nothing(human):
    mesh = human.meshes[0]
    flat = replace(mesh, inverse_bind=0.0 * mesh.inverse_bind)
    _, levels = with_levels(CharacterVertices.of([flat]))
    assert len(levels[-1].indices) < len(levels[0].indices)


@pytest.mark.parametrize("name", some(["flower", *Character.bundled_names()]))
def test_a_part_that_is_closed_is_closed_in_all_levels(name):
    meshes = toy(name).meshes if name in TOYS else Character.load(name).meshes
    vertices, levels = with_levels(CharacterVertices.of(meshes))
    positions = np.round(vertices.positions / (1e-6 * np.ptp(vertices.positions)))
    _, places = np.unique(positions, axis=0, return_inverse=True)
    places = places.ravel()
    triangles = [level.indices.reshape(-1, 3) for level in levels]
    parts = connect(places[triangles[0]], len(places))
    of_open = np.unique(parts[open_edges(places, triangles[0])])
    assert len(levels) > 1
    assert len(of_open) < len(np.unique(parts[places]))
    for coarse in triangles[1:]:
        torn = parts[open_edges(places, coarse)]
        assert np.isin(torn, of_open).all()


def test_a_small_model_has_one_level(pawn):
    _, levels = with_levels(CharacterVertices.of(pawn.meshes))
    assert len(levels) == 1


def test_the_level_does_not_alternate():
    nothing = np.zeros(0, np.uint32)
    levels = [DetailLevel(tolerance, nothing, (), 0, ()) for tolerance in (0.0, 1.0, 2.0, 4.0)]
    assert [chosen_level(levels, 0, error) for error in (0.0, 0.9, 1.2, 2.1, 9.0)] == [
        0, 0, 1, 1, 3,
    ]  # fmt: skip
    number, seen = 0, []
    for error in (2.05, 1.95, 2.05, 2.35, 1.95, 1.8, 1.7, 1.9, 0.0):
        number = chosen_level(levels, number, error)
        seen.append(number)
    assert seen == [1, 1, 1, 2, 2, 2, 1, 1, 0]


MAX_RMS, MAX_MUCH = 4.0, 0.01
"""Largest difference of the pictures, and largest share of pixels that differ by more than 25 of
255: see `tests.bench.detail`."""


@pytest.mark.parametrize("name", some(["human", "vleo", "robot"]))
def test_the_coarser_character_looks_the_same(ctx, name):
    character = Character.load(name)
    for each in compared(ctx, character, 240, QUALITIES["full"]):
        assert each.triangles < sum(len(mesh.triangles) for mesh in character.meshes)
        assert (each.coarse != each.fine).any()
        assert each.rms < MAX_RMS
        assert each.much < MAX_MUCH


def test_the_error_is_that_of_the_nearest_part(ctx, human):
    fineness = PictureFineness(np.diag([1.0, -1.0, -1.0, 1.0]), 900.0, 0.4)
    fineness.camera_from_table[2, 3] = 0.3
    error = fineness.error(np.diag([0.1, 0.1, 0.1, 1.0]), human.height)
    assert error == pytest.approx(0.4 * (0.3 - 0.2 * 0.1 * human.height) / (900.0 * 0.1))
    behind = PictureFineness(np.eye(4), 900.0, 0.4)
    assert behind.error(np.eye(4), human.height) == 0.0


@pytest.mark.parametrize(("max_error_px", "pixels"), [(0.0, 1.0), (0.85, 1.0), (3.0, 3.0)])
def test_nothing_finer_than_the_error_is_seen_of_a_surface(human, max_error_px, pixels):
    camera = np.diag([1.0, -1.0, -1.0, 1.0])
    camera[2, 3] = 3.0
    fineness = PictureFineness(camera, 900.0, max_error_px)
    pixel = fineness.pixel(np.eye(4), human.height)
    assert fineness.detail(np.eye(4), human.height) == pytest.approx(pixels * pixel)


def test_a_character_without_levels_keeps_its_triangles(human):
    given = CharacterVertices.of(human.meshes)
    vertices, (finest,) = with_levels(given, tolerances=())
    before, after = given.positions[given.indices], vertices.positions[finest.indices]
    assert np.array_equal(np.sort(before.ravel()), np.sort(after.ravel()))


@pytest.mark.parametrize("name", some(Character.bundled_names()))
def test_what_casts_a_shadow_is_as_large_in_all_directions(name):
    given = CharacterVertices.of(Character.load(name).meshes)
    shape = shape_only(given)
    assert len(shape.indices) < 0.6 * len(given.indices)
    assert sum(count for _, count in shape.materials) == len(shape.indices)
    directions = np.random.default_rng(1).normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    before, after = (
        (given.positions[each.indices] @ directions.T).max(axis=0) for each in (given, shape)
    )
    assert np.abs(after - before).max() < 0.01 * np.ptp(given.positions)


def test_what_moves_apart_is_not_joined_in_its_shadow():
    positions, triangles = ball()
    count = len(positions)
    meshes = [
        Mesh(
            name="ball",
            positions=positions,
            normals=positions,
            triangles=triangles.astype(np.uint32),
            joints=np.full((count, 4), joint, np.uint16),
            weights=np.tile(np.array([1, 0, 0, 0], np.float32), (count, 1)),
            inverse_bind=np.tile(np.eye(4), (2, 1, 1)),
        )
        for joint in (0, 1)
    ]
    shape = shape_only(CharacterVertices.of(meshes))
    owners = shape.owners[shape.indices].reshape(-1, 3)
    assert (owners == owners[:, :1]).all()
    assert np.bincount(owners[:, 0]).tolist() == [len(owners) // 2] * 2
