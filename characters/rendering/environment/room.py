"""The room's light in the pictures of a stage: a new map is filtered and faded in."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import moderngl
import numpy as np

from cubeling.characters.rendering.camera_picture.light import Light
from cubeling.characters.rendering.environment.cube_map import irradiance, pyramid
from cubeling.characters.rendering.environment.reflections import (
    HEIGHT,
    PARTS,
    WIDTH,
    Image,
    ReflectionFilter,
    filter_at_once,
    rows_between,
    tiles_by_roughness,
)
from cubeling.characters.rendering.scene import RoomMap
from cubeling.characters.skeleton.pose import Array

FADE_S = 1.2
"""Time in which a new map takes the place of the last one [s]: the largest change, of what is white
in what was dark, is about the least that is seen in each of 30 pictures a second."""

MAX_PAUSE_S = 1.0
"""After a longer time without a picture, and after a step back in time, nothing is faded."""

ROOM_UNIT = 15
"""Texture unit of what surfaces mirror: the last one that every graphics card has."""

MIN_MEAN = 1e-3
"""Least mean light from all around that is scaled: a black room stays dark."""


@dataclass(frozen=True)
class RoomLighting:
    """The room's light in one picture."""

    irradiance: Array
    """Light that falls on surfaces, as coefficients of harmonics, (9, 3)."""

    sphere: Array
    """Centre of the map in the table frame and its reach, (4,) [m]."""

    texture: moderngl.Texture | None
    """What surfaces mirror; None if none does."""

    def uniforms(self, light: Light) -> dict[str, Array]:
        """Return the uniforms of `room.glsl`; all light that is scattered is that of a `Light`.

        The room only tells where it comes from: the mean over all directions stays the same.
        """
        scale = 0.5 * (light.sky + light.ground) / np.maximum(self.irradiance[0], MIN_MEAN)
        return {
            "irradiance": scale * self.irradiance,
            "room_sphere": self.sphere,
            "room_tiles": tiles_by_roughness(),
        }

    def use(self) -> None:
        """Bind what surfaces mirror."""
        if self.texture is not None:
            self.texture.use(ROOM_UNIT)


@dataclass(frozen=True)
class _Prepared:
    """A map, ready to be drawn with."""

    irradiance: Array
    reflections: Image
    rows: slice
    """Rows of the texture that these are."""

    def mix(self, other: "_Prepared", share: float) -> "_Prepared":
        """Return this with a share of another, which has the same rows."""
        mixed = self.reflections
        if mixed.size:
            both = cv2.addWeighted(mixed, 1.0 - share, other.reflections, share, 0.0)
            mixed = np.asarray(both, np.uint8)
        irradiance = self.irradiance + share * (other.irradiance - self.irradiance)
        return _Prepared(irradiance, mixed, self.rows)


class RoomMaps:
    """Prepares the maps that a stage is given, one after the other.

    A map is filtered in some pictures, and then fades in. The first one is there at once, and so is
    the newest one when a character comes that mirrors with another roughness: only what is mirrored
    is filtered.
    """

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._texture: moderngl.Texture | None = None
        self.forget()

    def forget(self) -> None:
        """Forget what was seen: the next picture is of another time or place."""
        self._map: RoomMap | None = None  # of `_to`
        self._next: RoomMap | None = None  # that is being filtered
        self._from: _Prepared | None = None
        self._to: _Prepared | None = None
        self._began, self._time = -np.inf, -np.inf
        self._written: _Prepared | None = None

    def update(
        self, room: RoomMap | None, now: float, mirrored: Sequence[tuple[float, float]]
    ) -> RoomLighting | None:
        """Return the light of a picture.

        Parameters
        ----------
        room
            The map for it; None if there is none.
        now
            Time of the picture [s].
        mirrored
            Least and greatest roughness of each surface that mirrors the room: the light in it
            is filtered for these only.
        """
        if room is None:
            self.forget()
            return None
        if not 0.0 <= now - self._time <= MAX_PAUSE_S:
            self.forget()
        self._time = now
        rows = slice(0, 0)
        if mirrored:
            rows = rows_between(min(mirrored)[0], max(most for _, most in mirrored))
        if self._to is None or not _contains(self._to.rows, rows):
            self._show_at_once(room, rows)
        else:
            self._prepare(room, now)
        shown = self._mixed(now)
        if mirrored:
            self._write(shown)
        sphere = np.array([*room.centre, room.reach])
        return RoomLighting(shown.irradiance, sphere, self._texture if mirrored else None)

    def _show_at_once(self, room: RoomMap, rows: slice) -> None:
        light = pyramid(room.planes)
        self._to = _Prepared(irradiance(light), filter_at_once(light, rows), rows)
        self._map, self._next, self._from = room, None, None

    def _prepare(self, room: RoomMap, now: float) -> None:
        """Begin to filter a new map, or go on; begin to fade when one is ready."""
        assert self._to is not None
        if self._next is None and room is not self._map:
            light = pyramid(room.planes)
            self._next, self._coefficients = room, irradiance(light)
            self._filter = ReflectionFilter(light, self._to.rows)
        if self._next is None:
            return
        self._filter.step()
        if self._filter.done < PARTS:
            return
        self._from = self._mixed(now)
        self._to = _Prepared(self._coefficients, self._filter.texture, self._to.rows)
        self._map, self._next, self._began = self._next, None, now

    def _mixed(self, now: float) -> _Prepared:
        """Return what is shown at a time."""
        assert self._to is not None
        share = min((now - self._began) / FADE_S, 1.0)
        if self._from is None or share >= 1.0:
            self._from = None
            return self._to
        return self._from.mix(self._to, share)

    def _write(self, shown: _Prepared) -> None:
        if self._texture is None:
            self._texture = self._context.texture((WIDTH, HEIGHT), 4)
            self._texture.repeat_x = self._texture.repeat_y = False
        if shown is not self._written:
            box = 0, shown.rows.start, WIDTH, shown.rows.stop - shown.rows.start
            self._texture.write(shown.reflections, viewport=box)
            self._written = shown

    def release(self) -> None:
        """Release the texture; a second call does nothing."""
        if self._texture is not None:
            self._texture.release()
            self._texture = None


def _contains(outer: slice, inner: slice) -> bool:
    return bool(
        (outer.start <= inner.start and inner.stop <= outer.stop) or inner.stop == inner.start
    )
