"""What light comes from each direction in the room, gathered from the camera's picture."""

from functools import cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.tracking.appearance.appearance import (
    ENVIRONMENT_PX,
    EnvironmentMap,
    MeasuredLight,
)
from cubeling.tracking.appearance.colour_space import LINEAR_FROM_SRGB
from cubeling.tracking.appearance.room.cube_map import (
    COARSE_PX,
    FACES,
    directions,
    enlarged,
    filled,
    solid_angles,
)
from cubeling.tracking.appearance.room.standing_things import EmptyTable, StandingThing
from cubeling.tracking.geometry.arrays import Array, Floats, Image, Indices
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.projection import MIN_DEPTH, Projection

CENTRE_M = np.array([0.0, 0.08, 0.0])
"""Where the map is seen from, in the table frame [m]: half as high as a character stands."""

REACH_M = 1.0
"""How far the table reaches, and how far what stands around it is [m]: a desk, and its walls."""

LOOK_INTERVAL_S, RENEWAL_INTERVAL_S, TWO_MAPS_S = 0.1, 0.6, 1.0
"""Time from one look at the picture to the next, usual time from one map to the next, and least
time in which there are two."""

HASTY_INTERVAL_S, QUIET_S = 0.2, 0.9
"""Time from one map to the next where much has changed, if the last came so long after the one
before: while all is in motion, maps are evenly spaced."""

MIN_CHANGE, MUCH_CHANGE = 3.0, 8.0
"""Difference from the picture of the last map from which on there is a new one, and in haste: the
root of the mean square, of 255. The noise of a camera is less in a picture of so few pixels."""

MIN_DISTANCE_M = 0.06
"""Least distance of what stands on the table from the centre: what is nearer would hide all else,
and no character is where it is [m]."""

MAX_MOVE = 2e-3
"""How much the numbers of the table's pose may change until directions are found again [m, 1]."""

SMALL_WIDTH = 160
"""Width of the picture that is looked at [px]: a texel is as wide as two to four of them."""

SOFT_EDGE = 0.06
"""Width of the edge of the picture in which it counts less and less, as a share of its width."""

MEMORY_S = 60.0
"""Time in which what is no more in the picture is forgotten."""

MIN_LIGHT = 0.02
"""Least light from a direction that was never seen: no wall is black."""

FILL_GAINS = 0.5, 3.0
"""Limits of the light from unseen directions beside that at the edges of what is seen."""

THING_PX = 32
"""Side of a face for what stands on the table [texels]: as wide as a pixel is from the centre."""

COARSE_RADIUS = np.radians(11.0)
"""How far the edge of a coarse texel is from its middle at most [rad]."""

_LINEAR = LINEAR_FROM_SRGB.astype(np.float32)


Seen = tuple[Indices, Floats, Image]
"""Squares of four texels of the map, (n, 4), what share of each is covered, (n, 1, 1), and by which
sRGB, (n, 1, 3)."""

NOTHING_SEEN: Seen = (
    np.zeros((0, 4), np.intp),
    np.zeros((0, 1, 1), np.float32),
    np.zeros((0, 1, 3), np.uint8),
)


class RoomMeter:
    """Gathers the light from all directions, from picture to picture.

    A pixel shows a place on the table, or on a sphere around it: that place, not the line of sight,
    tells from which direction its light comes to a character. What comes into the picture stands on
    the table, and is not painted on it. What the camera has seen from another
    pose is remembered. What it never saw has the light of the nearest edges, blurred; above the
    table, so much that a sheet on it gets the light from all around that was measured on paper.
    """

    def __init__(self, intrinsics: Intrinsics) -> None:
        self._projection = Projection(intrinsics)
        self._light: Image = np.zeros((FACES * ENVIRONMENT_PX**2, 3), np.uint8)  # sRGB
        self._known: Floats = np.zeros(len(self._light), np.float32)
        self._pose: Array | None = None  # for which `_texels`, `_pixels` and `_shares` hold
        self._texels: Indices = np.zeros(0, np.intp)
        self._pixels: Floats = np.zeros((0, 2), np.float32)  # of small pictures
        self._shares: Floats = np.zeros(0, np.float32)
        self._table = EmptyTable()
        self._standing: list[Seen] = []
        self._last: Image | None = None  # small picture of the last map
        self._map: EnvironmentMap | None = None
        self._looked = self._renewed = -np.inf
        self._gap = np.inf  # from the map before the last to the last [s]

    def update(
        self,
        image: Image,
        camera_from_table: Array | None,
        light: MeasuredLight | None,
        now: float,
    ) -> EnvironmentMap | None:
        """Take a picture into account and return the map, a new one where the picture has changed.

        Parameters
        ----------
        image
            The camera's picture, (H, W, 3) BGR.
        camera_from_table
            Pose of the table, (4, 4); None while it is not known.
        light
            The light on paper, if any was measured.
        now
            Time of the picture [s].

        Returns
        -------
        None until the table was known.
        """
        if now < self._looked:  # a recording is wound back
            self._looked = self._renewed = now - RENEWAL_INTERVAL_S
            self._gap = np.inf
        due = self._map is None or now - self._looked >= LOOK_INTERVAL_S - 1e-6
        if camera_from_table is None or not due:
            return self._map
        self._looked = now
        waited = now - self._renewed + 1e-6
        is_due = waited >= max(RENEWAL_INTERVAL_S, TWO_MAPS_S - self._gap)
        if not is_due and (waited < HASTY_INTERVAL_S or self._gap < QUIET_S):
            return self._map
        height = max(image.shape[0] * SMALL_WIDTH // image.shape[1], 1)
        small = np.asarray(cv2.resize(image, (SMALL_WIDTH, height)), np.uint8)
        change = MIN_CHANGE if is_due else MUCH_CHANGE
        if self._differs(small, change) or self._has_moved(camera_from_table):
            self._see(small, camera_from_table, now)
            self._map = self._complete(light, now)
            self._last, self._gap, self._renewed = small, waited, now
        return self._map

    def _differs(self, small: Image, least: float) -> bool:
        last = self._last
        if last is None or last.shape != small.shape:
            return True
        return bool(cv2.norm(small, last) > least * np.sqrt(small.size))

    def _has_moved(self, camera_from_table: Array) -> bool:
        return self._pose is None or bool(np.abs(camera_from_table - self._pose).max() > MAX_MOVE)

    def _see(self, small: Image, camera_from_table: Array, now: float) -> None:
        """Take what a picture shows into what is known."""
        scale = small.shape[1] / self._projection.size[0]
        if self._has_moved(camera_from_table):
            self._aim(camera_from_table, scale)
            self._table.forget()
        if np.isfinite(self._renewed):
            self._known *= np.float32(np.exp(-(now - self._renewed) / MEMORY_S))
        if not len(self._texels):
            return
        things = self._table.find(small)
        seen, before = _sampled(self._table.picture, self._pixels), self._known[self._texels]
        share = self._shares / np.maximum(self._shares, before)
        if (share < 1.0).any():  # it was seen better before
            old = self._light[self._texels]
            seen = _bytes(old + share[:, None] * (seen.astype(np.float32) - old))
        self._light[self._texels] = seen
        self._known[self._texels] = np.maximum(before, self._shares)
        self._standing = [self._stand(thing, small, scale) for thing in things]

    def _aim(self, camera_from_table: Array, scale: float) -> None:
        """Find where in the picture the places are that light comes from."""
        self._pose = camera_from_table.copy()
        places = CENTRE_M + _reaches(ENVIRONMENT_PX)[:, None] * directions(ENVIRONMENT_PX)
        self._texels, pixels, margins = self._in_picture(places)
        self._pixels = ((pixels + 0.5) * scale - 0.5).astype(np.float32)
        soft = SOFT_EDGE * self._projection.size[0]
        self._shares = np.minimum(margins / soft, 1.0).astype(np.float32)

    def _stand(self, thing: StandingThing, small: Image, scale: float) -> Seen:
        """Return what is seen of something that stands on the table, from the centre."""
        assert self._pose is not None
        rotation, origin = self._pose[:3, :3], self._pose[:3, 3]
        outline = (np.vstack([thing.foot, thing.corners]) + 0.5) / scale - 0.5
        rays = np.column_stack([self._projection.rays(outline), np.ones(5)]) @ rotation
        camera = -rotation.T @ origin
        if rays[0, 1] > -1e-6:  # its foot is above the horizon
            return NOTHING_SEEN
        foot = camera - camera[1] / rays[0, 1] * rays[0]
        if np.hypot(*(foot - CENTRE_M)[[0, 2]]) < MIN_DISTANCE_M:
            return NOTHING_SEEN
        # It is on the upright plane through the foot, turned to the camera.
        facing = (camera - foot) * (1.0, 0.0, 1.0)
        ways = facing @ (foot - camera) / (rays[1:] @ facing)
        around = camera + ways[:, None] * rays[1:] - CENTRE_M
        # The directions between four planes, through the centre and each edge of the rectangle.
        sides = np.cross(around, np.roll(around, -1, axis=0))
        sides *= np.copysign(1.0 / np.linalg.norm(sides, axis=1), sides @ around.sum(axis=0))[
            :, None
        ]
        inside = (directions(COARSE_PX) @ sides.T).min(axis=1) > -np.sin(COARSE_RADIUS)
        near = _blocks(COARSE_PX, THING_PX)[inside].ravel()
        unit = directions(THING_PX)[near]
        with np.errstate(divide="ignore"):
            distance = float(facing @ (foot - CENTRE_M)) / (unit @ facing)
        kept = np.flatnonzero((distance > 0.0) & (distance < _reaches(THING_PX)[near]))
        shown, pixels, _ = self._in_picture(CENTRE_M + distance[kept, None] * unit[kept])
        if not len(shown):
            return NOTHING_SEEN
        pixels = (pixels + 0.5) * scale - 0.5
        covered = _sampled(thing.pixels, pixels)
        there = np.flatnonzero(covered)
        if not len(there):
            return NOTHING_SEEN
        share = _floats(covered[there, None] / np.float32(255.0))
        texels = _blocks(THING_PX, ENVIRONMENT_PX)[near[kept[shown[there]]]]
        return texels, share[:, None], _sampled(small, pixels[there])[:, None]

    def _in_picture(self, places: Array) -> tuple[Indices, Array, Array]:
        """Return which places (n, 3) are in the picture, their pixels, and how far from its edge.

        Places are in the table frame [m], pixels those of the camera's picture.
        """
        assert self._pose is not None
        seen = places @ self._pose[:3, :3].T + self._pose[:3, 3]
        ahead = np.flatnonzero(seen[:, 2] > MIN_DEPTH)
        width, height = self._projection.size
        matrix = self._projection.matrix
        # A lens's polynomial may bend what is far outside of the picture into it.
        straight = seen[ahead, :2] / seen[ahead, 2:] * matrix[[0, 1], [0, 1]] + matrix[:2, 2]
        ahead = ahead[_inside(straight, width, height) > -0.1 * width]
        pixels = self._projection.project(seen[ahead])
        margins = _inside(pixels, width, height)
        kept = margins > 0.0
        return ahead[kept], pixels[kept], margins[kept]

    def _complete(self, light: MeasuredLight | None, now: float) -> EnvironmentMap | None:
        """Return the map with what is unknown filled; None if nothing is known."""
        side, coarse = ENVIRONMENT_PX, (COARSE_PX, FACES * COARSE_PX)
        known, seen = self._known.reshape(-1, side), self._light.reshape(-1, side, 3)
        share = _floats(cv2.resize(known, coarse, interpolation=cv2.INTER_AREA)).reshape(-1, 1)
        if float(share.max()) < 1e-3:
            return self._map
        linear = cv2.multiply(cv2.LUT(seen, _LINEAR), cv2.merge([known] * 3))
        edges = _floats(cv2.resize(linear, coarse, interpolation=cv2.INTER_AREA)).reshape(-1, 3)
        least = np.float32(MIN_LIGHT)
        mean = _floats(edges / np.maximum(share, np.float32(1e-6)))
        guessed = np.maximum(filled(mean, share), least)
        if light is not None:
            unseen = _from_above() @ ((1.0 - share) * guessed)
            missing = light.ambient - _from_above() @ edges
            gain = np.clip(missing / np.maximum(unseen, 1e-6), *FILL_GAINS)
            high = np.clip(0.5 + 2.0 * directions(COARSE_PX)[:, 1:2], 0.0, 1.0)
            guessed = np.maximum(guessed * _floats(1.0 + high * (gain - 1.0)), least)
        shown = _bytes(np.interp(guessed, LINEAR_FROM_SRGB, np.arange(256.0)))
        walls = enlarged(shown, side)
        whole = np.asarray(cv2.blendLinear(seen, walls, known, np.float32(1.0) - known), np.uint8)
        # What stands there is not remembered, and tells nothing of the walls.
        texels = whole.reshape(-1, 3)
        for where, covered, colour in self._standing:
            behind = texels[where].astype(np.float32)
            texels[where] = _bytes(behind + covered * (colour - behind))
        planes = np.vstack(cv2.split(whole))
        return EnvironmentMap(np.asarray(planes, np.uint8), CENTRE_M, REACH_M, now)


def _floats(values: NDArray[Any]) -> Floats:
    return np.asarray(values, np.float32)


def _bytes(values: NDArray[Any]) -> Image:
    """Return the nearest bytes of values from 0 to 255."""
    return np.asarray(values + np.float32(0.5), np.uint8)


def _sampled(picture: Image, pixels: Array | Floats) -> Image:
    """Return the values of a picture at pixels (n, 2): (n,), or (n, 3) RGB of a BGR picture."""
    columns, rows = (np.ascontiguousarray(each[None], np.float32) for each in pixels.T)
    found = cv2.remap(picture, columns, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    colours = found if picture.ndim == 2 else cv2.cvtColor(found, cv2.COLOR_BGR2RGB)
    return np.asarray(np.asarray(colours, np.uint8)[0])


@cache
def _from_above() -> Array:
    """Return the share of each coarse texel in the light on a sheet on the table, (texels,)."""
    share = solid_angles(COARSE_PX) * np.maximum(directions(COARSE_PX)[:, 1], 0.0)
    return np.asarray(share / share.sum())


@cache
def _blocks(coarse: int, fine: int) -> Indices:
    """Return the numbers of the texels of a fine cube in each of a coarse one.

    They are (6 · coarse², texels) for faces of so many texels along a side.
    """
    step = fine // coarse
    numbers = np.arange(FACES * fine**2).reshape(-1, step, coarse, step)
    return numbers.transpose(0, 2, 1, 3).reshape(-1, step * step)


@cache
def _reaches(side: int) -> Array:
    """Return how far what is seen in each texel is, (texels,) [m]: on the table, or around it."""
    unit = directions(side)
    below = unit[:, 1] < -CENTRE_M[1] / REACH_M
    distance = np.full(len(unit), REACH_M)
    distance[below] = CENTRE_M[1] / -unit[below, 1]
    return distance


def _inside(pixels: Array, width: int, height: int) -> Array:
    """Return how far pixels (n, 2) are from the edges of a picture, below 0 outside [px]."""
    x, y = pixels.T
    across, down = np.minimum(x + 0.5, width - 0.5 - x), np.minimum(y + 0.5, height - 0.5 - y)
    return np.asarray(np.minimum(across, down), np.float64)
