"""Levels of detail: fewer triangles for a character that is small in the picture."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.mesh import Material
from cubeling.characters.rendering.geometry.edge_collapse import Tolerance, collapsed_levels
from cubeling.characters.rendering.geometry.places import are_whole, places_of
from cubeling.characters.rendering.geometry.vertices import CharacterVertices
from cubeling.characters.rendering.projection import is_invertible

LEVEL_TOLERANCES = (
    *map(Tolerance, (1 / 850, 1 / 600, 1 / 500, 1 / 350, 1 / 240, 1 / 170)),
    Tolerance(1 / 120, thickness_share=0.3),
)
"""Those of the coarser levels, with distances as shares of the character's largest side. The small
parts of the coarsest one are hardly seen, and half of its triangles would be theirs."""

SHAPE_TOLERANCE = Tolerance(1 / 150, thickness_share=0.3)
"""The same for what casts a shadow; small parts are not looked at closely."""

SIZE_HYSTERESIS = 1.15
"""Factor by which the size in the picture changes back before the level does."""

GROUP_TRIANGLES = 256
"""Triangles that follow each other in the given order, and are sorted as one."""

MIN_TRIANGLES = 1500
"""Fewer triangles are drawn as they are: they cost little."""

NORMAL_SCALE, COLOR_SCALE = 0.008, 0.02
"""Distance that counts as much as an error of 1 in a unit normal, or in a linear colour, as shares
of the largest side."""

JOINT_SCALE = 0.15
"""Distance that counts as much as weights that move the mean of a vertex's joints by 1 m [m]."""

MORPH_SCALE = 0.5
"""Distance that counts as much as a displacement by morphs by 1 m [m]."""

MORPH_FEATURES, MORPH_SEED = 3, 1
"""Number of projections of the displacements, and seed of their directions."""


@dataclass(frozen=True)
class DetailLevel:
    """The triangles of a character at one level of detail."""

    tolerance: float
    """Root mean square distance from the finest triangles [m in the character frame]."""

    indices: NDArray[np.uint32]
    """Three for each triangle, sorted by material."""

    materials: tuple[tuple[Material, int], ...]
    """Each material with the number of its indices, in their order; those of dormant triangles
    again, after all others."""

    awake: int
    """How many of these runs are of triangles that are not dormant."""

    parts: tuple[tuple[int, int], ...]
    """First vertex and number of vertices in use: of those that morphs move, of those that nothing
    but joints move, and of the dormant ones."""


def with_levels(
    vertices: CharacterVertices,
    dormant: NDArray[np.bool_] | None = None,
    tolerances: Sequence[Tolerance] = LEVEL_TOLERANCES,
) -> tuple[CharacterVertices, tuple[DetailLevel, ...]]:
    """Return the vertices in an order that suits all levels, and the levels, the finest first.

    The vertices of a coarser level come before those that only finer ones use, in each part of the
    vertices, so that only they need to be skinned. `dormant` (rows,) are the rows of the palette
    whose vertices are seldom seen, as effects: those are a part of their own, the last one.
    `tolerances` are as in `LEVEL_TOLERANCES`; none leaves the finest level alone.
    """
    stands = [np.arange(len(vertices.positions))]
    bones = _moving_joints(vertices)
    sizes = np.ptp(vertices.positions, axis=0)
    side = float(sizes.max())
    if tolerances and len(vertices.indices) >= 3 * MIN_TRIANGLES and side > 0.0:
        stands += collapsed_levels(
            vertices.positions,
            _features(vertices, side, bones),
            vertices.indices.reshape(-1, 3).astype(np.intp),
            [each._replace(distance=side * each.distance) for each in tolerances],
        )
    part = np.where(np.arange(len(vertices.positions)) < vertices.moved, 0, 1)
    if dormant is not None:
        part[(part == 1) & dormant[vertices.owners]] = 2
    drawn = [_drawn_triangles(vertices, stand, bones, part == 2) for stand in stands]
    last = np.full(len(part), -1)
    for number, (indices, _, _) in enumerate(drawn):
        last[indices] = number
    order = np.lexsort((-last, part))
    new_index = np.empty(len(order), np.uint32)
    new_index[order] = np.arange(len(order))
    starts = np.searchsorted(part[order], range(3)).tolist()
    levels = []
    distances = (0.0, *(side * each.distance for each in tolerances))
    for number, ((indices, materials, awake), distance) in enumerate(
        zip(drawn, distances, strict=False)
    ):
        counts = np.bincount(part[last >= number], minlength=3).tolist()
        parts = tuple(zip(starts, counts, strict=True))
        levels.append(DetailLevel(distance, new_index[indices], materials, awake, parts))
    return vertices.reorder(order), tuple(levels)


def shape_only(vertices: CharacterVertices) -> CharacterVertices:
    """Return fewer triangles of the same vertices, of which no more than a shadow is seen."""
    side = float(np.ptp(vertices.positions, axis=0).max())
    if len(vertices.indices) < 3 * MIN_TRIANGLES or not side > 0.0:
        return vertices
    # One vertex stands for those at one place with one joint: colours and normals have no seams.
    keys = places_of(vertices.positions) * (int(vertices.owners.max()) + 1) + vertices.owners
    _, first, number = np.unique(keys[vertices.indices], return_index=True, return_inverse=True)
    triangles = vertices.indices[first][number].reshape(-1, 3).astype(np.intp)
    bones = _moving_joints(vertices)
    tolerance = SHAPE_TOLERANCE._replace(distance=side * SHAPE_TOLERANCE.distance)
    [stand] = collapsed_levels(vertices.positions, JOINT_SCALE * bones, triangles, [tolerance])
    corners = stand[triangles]
    kept = are_whole(corners)
    ends = np.cumsum([0, *(count // 3 for _, count in vertices.materials)])
    return replace(
        vertices,
        indices=corners[kept].ravel().astype(np.uint32),
        materials=tuple(
            (material, 3 * int(np.count_nonzero(kept[start:end])))
            for (material, _), (start, end) in zip(vertices.materials, pairwise(ends), strict=True)
        ),
    )


def chosen_level(levels: Sequence[DetailLevel], last: int, max_error: float) -> int:
    """Return the number of the coarsest level with an error of at most `max_error` [m].

    It stays the last one while that is worse by `SIZE_HYSTERESIS` at most: they do not alternate.
    """
    allowed = [number for number, each in enumerate(levels) if each.tolerance <= max_error]
    fits = max(allowed, default=0)
    if fits > last and SIZE_HYSTERESIS * levels[fits].tolerance > max_error:
        fits -= 1
    stays = levels[last].tolerance <= SIZE_HYSTERESIS * max_error
    return last if last > fits and stays else fits


def _drawn_triangles(
    vertices: CharacterVertices,
    stand: NDArray[np.intp],
    bones: NDArray[np.float64],
    dormant: NDArray[np.bool_],
) -> tuple[NDArray[np.uint32], tuple[tuple[Material, int], ...], int]:
    """Return the indices of the triangles that are left, and those of `DetailLevel` for them.

    A triangle is dormant if all of its vertices are.
    """
    corners = stand[vertices.indices].reshape(-1, 3)
    kept = are_whole(corners)
    if (stand == np.arange(len(stand))).all():
        kept[:] = True  # the finest level is as it was given
    ends = np.cumsum([0, *(count // 3 for _, count in vertices.materials)])
    away = np.linalg.norm(vertices.positions - bones, axis=1)
    asleep = dormant[corners].all(axis=1)
    materials, runs = [], []
    for is_wanted in (~asleep, asleep):
        for (material, _), (start, end) in zip(vertices.materials, pairwise(ends), strict=True):
            run = _outer_first(corners[start:end][(kept & is_wanted)[start:end]], away)
            materials.append((material, run.size))
            runs.append(run)
    awake = len(vertices.materials)
    if not asleep.any():
        materials = materials[:awake]
    return np.concatenate(runs).ravel().astype(np.uint32), tuple(materials), awake


def _outer_first(triangles: NDArray[Any], away: NDArray[np.float64]) -> NDArray[Any]:
    """Return triangles (n, 3) in another order: groups far away from their joints come first.

    What they hide is then not shaded: clothes come before the body, the head before the mouth. A
    group keeps its order, so that a vertex is shaded for all its triangles at once. `away` is the
    distance of each vertex from its joints [m].
    """
    if not len(triangles):
        return triangles
    group = np.arange(len(triangles)) // GROUP_TRIANGLES
    mean = np.bincount(group, away[triangles].mean(axis=1)) / np.bincount(group)
    return np.asarray(triangles[np.argsort(-mean[group], kind="stable")])


def _moving_joints(vertices: CharacterVertices) -> NDArray[np.float64]:
    """Return the mean position of the joints that move each vertex, (vertices, 3) [m]."""
    binds = np.concatenate(vertices.binds)
    usable = [is_invertible(bind) for bind in binds]
    joints = np.linalg.inv(np.where(np.array(usable)[:, None, None], binds, np.eye(4)))[:, :3, 3]
    return np.asarray(np.einsum("vj,vjk->vk", vertices.weights, joints[vertices.joints]))


def _features(
    vertices: CharacterVertices, side: float, bones: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return what an edge collapse must keep besides the shape, (vertices, n) [m]."""
    columns = [
        NORMAL_SCALE * side * vertices.normals,
        COLOR_SCALE * side * vertices.colors[:, :3],
        JOINT_SCALE * bones,
    ]
    if vertices.morphs:
        columns.append(MORPH_SCALE * _morph_features(vertices))
    if vertices.uvs.any():
        columns.append(COLOR_SCALE * side * vertices.uvs)
    return np.hstack(columns).astype(float)


def _morph_features(vertices: CharacterVertices) -> NDArray[np.float64]:
    """Return a few numbers that differ where morphs do different things, (vertices, n) [m].

    They are random projections of the displacements by all morphs, which keep their distances on
    average (Johnson and Lindenstrauss, 1984).
    """
    signs = np.random.default_rng(MORPH_SEED).choice(
        [-1.0, 1.0], (len(vertices.morphs), 3, MORPH_FEATURES)
    )
    features = np.zeros((len(vertices.positions), MORPH_FEATURES))
    for morph, each in zip(vertices.morphs, signs, strict=True):
        features[morph.vertices] += np.einsum("vk,kf->vf", morph.displacements, each)
    return np.asarray(features / np.sqrt(MORPH_FEATURES))
