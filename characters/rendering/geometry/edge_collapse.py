"""Coarser triangles of the same vertices, by edge collapses.

A vertex always moves into a neighbour, so that vertices are only left out, never new. Collapses of
small error (see `quadrics`) that are no neighbours are done at the same time, in numpy.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.geometry.places import are_whole, connect, places_of
from cubeling.characters.rendering.geometry.quadrics import (
    Floats,
    Indices,
    error_terms,
    triangle_normals,
    vertex_quadrics,
)

MIN_COS_TURN = 0.3
"""Least cosine of the angle by which a collapse may turn a triangle."""

MIN_COLLAPSED_SHARE = 0.04
"""Share of the vertices from which on one more round is worth its time."""

MAX_ROUNDS = 8
"""Most rounds of collapses for one tolerance."""

PICKS_PER_ROUND = 3
"""How often a round picks collapses that do not touch those picked before."""


class Tolerance(NamedTuple):
    """How much a coarser level may differ from the given surface."""

    distance: float
    """Root mean square distance [m]."""

    thickness_share: float = 0.15
    """Largest distance as a share of how thick a part is: small parts stay, and stay above what
    they lie on."""


def collapsed_levels(
    positions: NDArray[np.float32],
    features: Floats,
    triangles: Indices,
    tolerances: Sequence[Tolerance],
) -> list[Indices]:
    """Return, for each tolerance, the vertex that stands for each vertex, (vertices,).

    Parameters
    ----------
    positions
        (vertices, 3) [m]. Vertices at one place, as along a seam of colours, move together.
    features
        What else must be kept, (vertices, features), scaled so that an error of it counts as much
        as a distance of the same length [m].
    triangles
        (triangles, 3).
    tolerances
        Of the levels, ascending. The levels are nested.
    """
    mesh = _Mesh(positions, features, triangles)
    levels = []
    for tolerance in tolerances:
        for _ in range(MAX_ROUNDS):
            before = mesh.vertex_count
            if mesh.collapse(tolerance) < MIN_COLLAPSED_SHARE * before:
                break
        levels.append(mesh.standing.copy())
    return levels


class _Mesh:
    """Triangles that become fewer; a place is a set of vertices, see `places_of`."""

    def __init__(
        self, positions: NDArray[np.float32], features: Floats, triangles: Indices
    ) -> None:
        self._positions = positions.astype(float) - positions.mean(axis=0, dtype=float)
        self._place = places_of(positions)
        self._terms = error_terms(self._positions, features)
        self.standing: Indices = np.arange(len(positions))
        """The vertex that stands for each vertex, (vertices,)."""
        self._triangles = self._without_degenerate(triangles.astype(np.intp))
        self._quadrics = vertex_quadrics(self._positions, features, self._triangles)
        corners = self._positions[self._triangles]
        self._thickness = _thickness(corners, self._place[self._triangles], len(positions))
        self._known = np.full(1, -1), np.full(1, np.nan)  # keys of two vertices, and their errors
        self._changed = np.zeros(len(positions), bool)  # vertices with a new quadric

    @property
    def vertex_count(self) -> int:
        """Number of vertices left in the triangles."""
        return int(np.count_nonzero(np.bincount(self._triangles.ravel())))

    def collapse(self, tolerance: Tolerance) -> int:
        """Do collapses of small error; return how many were done."""
        count = len(self._place)
        ends = self._triangles[:, [0, 0, 1, 1, 2, 2]], self._triangles[:, [1, 2, 0, 2, 0, 1]]
        keys, uses = np.unique(ends[0].ravel() * count + ends[1].ravel(), return_counts=True)
        sources, targets = np.divmod(keys, count)  # vertices
        key = self._place[sources] * count + self._place[targets]
        pairs, pair = np.unique(key, return_inverse=True)
        froms, tos = np.divmod(pairs, count)  # places
        error = self._errors(keys, pair, froms)
        limits = np.minimum(tolerance.distance, tolerance.thickness_share * self._thickness[froms])
        error[~(error <= limits**2)] = np.inf
        chosen = self._pick(froms, tos, error)
        chosen = chosen[self._keeps_topology(pairs, froms, tos, np.bincount(pair, uses), chosen)]
        is_chosen = np.zeros(len(pairs), bool)
        is_chosen[chosen] = True
        moving = is_chosen[pair]
        moving[moving] = ~self._flips_triangle(sources[moving], targets[moving])
        target = np.arange(count)
        target[sources[moving]] = targets[moving]
        np.add.at(self._quadrics, targets[moving], self._quadrics[sources[moving]])
        self._changed[targets[moving]] = True
        self.standing = target[self.standing]
        self._triangles = self._without_degenerate(target[self._triangles])
        return int(np.count_nonzero(moving))

    def _without_degenerate(self, triangles: Indices) -> Indices:
        return np.asarray(triangles[are_whole(self._place[triangles])])

    def _errors(self, keys: Indices, pair: Indices, froms: Indices) -> Floats:
        """Return the mean squared error of moving a place into another, infinite if it tears.

        Every vertex of the place must be joined by an edge to exactly one of the other: a vertex on
        a seam moves along the seam only.
        """
        count = len(self._place)
        sources, targets = np.divmod(keys, count)
        used = np.flatnonzero(np.bincount(self._triangles.ravel()))
        vertices = np.bincount(self._place[used], minlength=count)
        total = np.bincount(self._place[used], used, minlength=count)
        whole = np.bincount(pair) == vertices[froms]
        whole &= np.bincount(pair, sources) == total[froms]
        # Most errors are those of the last round.
        at = np.minimum(np.searchsorted(self._known[0], keys), len(self._known[0]) - 1)
        error = np.where(self._known[0][at] == keys, self._known[1][at], np.nan)
        error[self._changed[sources]] = np.nan
        new = whole[pair] & np.isnan(error)
        error[new] = np.einsum("ij,ij->i", self._quadrics[sources[new]], self._terms[targets[new]])
        self._known = keys, error
        self._changed[:] = False
        area = np.bincount(pair, self._quadrics[sources, -1])
        return np.where(whole, np.bincount(pair, error), np.inf) / np.maximum(area, 1e-30)

    def _pick(self, froms: Indices, tos: Indices, error: Floats) -> Indices:
        """Return pairs of small error of which no two are neighbours."""
        order = np.argsort(error, kind="stable")[: np.count_nonzero(np.isfinite(error))]
        _, first = np.unique(froms[order], return_index=True)  # the best target of each place
        best = order[np.sort(first)]
        rank = np.full(len(self._place), np.inf)
        rank[froms[best]] = np.arange(len(best))
        pair_of = np.zeros(len(self._place), np.intp)
        pair_of[froms[best]] = best
        picked = []
        for _ in range(PICKS_PER_ROUND):
            nearest = np.full(len(rank), np.inf)
            np.minimum.at(nearest, froms, rank[tos])
            places = np.flatnonzero(rank < nearest)
            picked.append(pair_of[places])
            done = np.zeros(len(rank), bool)
            done[places] = True
            rank[places] = np.inf
            rank[tos[done[froms]]] = np.inf
        return np.concatenate(picked)

    def _keeps_topology(
        self, pairs: Indices, froms: Indices, tos: Indices, uses: NDArray[Any], chosen: Indices
    ) -> NDArray[np.bool_]:
        """Return whether both ends of an edge share no neighbours but those of its triangles."""
        first = np.searchsorted(froms, froms[chosen])
        number = np.searchsorted(froms, froms[chosen], side="right") - first
        each = np.repeat(np.arange(len(chosen)), number)
        within = np.arange(len(each)) - np.repeat(np.cumsum(number) - number, number)
        neighbours = tos[first[each] + within]
        keys = tos[chosen][each] * len(self._place) + neighbours
        found = np.minimum(np.searchsorted(pairs, keys), len(pairs) - 1)
        shared = np.bincount(each, pairs[found] == keys, minlength=len(chosen))
        return np.asarray(shared == uses[chosen])

    def _flips_triangle(self, sources: Indices, targets: Indices) -> NDArray[np.bool_]:
        """Return which moves turn a triangle too far."""
        target = np.arange(len(self._place))
        target[sources] = targets
        after = target[self._triangles]
        kept = (after != self._triangles).any(axis=1) & are_whole(self._place[after])
        normal, new = (triangle_normals(self._positions[t[kept]]) for t in (self._triangles, after))
        size = np.linalg.norm(normal, axis=1) * np.linalg.norm(new, axis=1)
        bad = np.einsum("ij,ij->i", normal, new) < MIN_COS_TURN * size
        spoiled = np.zeros(len(self._place), bool)
        spoiled[self._place[self._triangles[kept][bad]]] = True
        return np.asarray(spoiled[self._place[sources]])


def _thickness(corners: Floats, triangles: Indices, count: int) -> Floats:
    """Return how thick the connected part of each place is, (count,) [m].

    `corners` are the positions (n, 3, 3) of the places of `triangles` (n, 3).

    It is three times the volume over the area: the radius of a sphere, and nearly 0 for a patch
    that lies on another part.
    """
    parts = connect(triangles, count)
    part = parts[triangles[:, 0]]
    area = np.bincount(part, 0.5 * np.linalg.norm(triangle_normals(corners), axis=1), count)
    sums = [np.bincount(part, column, count) for column in corners.mean(axis=1).T]
    number = np.maximum(np.bincount(part, minlength=count), 1)
    corners = corners - (np.stack(sums, axis=1) / number[:, None])[part][:, None]
    volume = np.bincount(part, np.linalg.det(corners) / 6.0, count)
    return np.asarray((3.0 * np.abs(volume) / np.maximum(area, 1e-20))[parts])
