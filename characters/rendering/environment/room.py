"""The room's light in the pictures of a stage: a new map is filtered and faded in."""

from dataclasses import dataclass

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.camera_picture.light import Light
from cubeling.characters.rendering.environment.cube_map import irradiance, pyramid
from cubeling.characters.rendering.environment.reflections import (
    HEIGHT,
    PARTS,
    TILES,
    WIDTH,
    ReflectionFilter,
    filtered,
)
from cubeling.characters.rendering.scene import RoomMap
from cubeling.characters.skeleton.pose import Array

FADE_S = 0.5
"""Time in which a new map takes the place of the last one [s]."""

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
            "room_tiles": np.array(TILES, float),
        }

    def use(self) -> None:
        """Bind what surfaces mirror."""
        if self.texture is not None:
            self.texture.use(ROOM_UNIT)


@dataclass(frozen=True)
class _Prepared:
    """A map, ready to be drawn with."""

    irradiance: Array
    reflections: NDArray[np.uint8] | None

    def mix(self, other: "_Prepared", share: float) -> "_Prepared":
        """Return this with a share of another."""
        mixed = None
        if self.reflections is not None and other.reflections is not None:
            mixed = cv2.addWeighted(self.reflections, 1.0 - share, other.reflections, share, 0.0)
        return _Prepared(
            self.irradiance + share * (other.irradiance - self.irradiance),
            other.reflections if mixed is None else np.asarray(mixed, np.uint8),
        )


class RoomMaps:
    """Prepares the maps that a stage is given, one after the other.

    A map is filtered in some pictures, and then fades in. The first one is there at once, and so is
    the newest one when the first character comes that mirrors anything: before that, none is
    filtered.
    """

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._texture: moderngl.Texture | None = None
        self.forget()

    def forget(self) -> None:
        """Forget what was seen: the next picture is of another time or place."""
        self._map: RoomMap | None = None  # of `_to`
        self._next: RoomMap | None = None  # that is being filtered
        self._filter: ReflectionFilter | None = None
        self._from: _Prepared | None = None
        self._to: _Prepared | None = None
        self._began, self._time = -np.inf, -np.inf
        self._written: _Prepared | None = None

    def update(self, room: RoomMap | None, now: float, mirrored: bool) -> RoomLighting | None:
        """Return the light of a picture.

        Parameters
        ----------
        room
            The map for it; None if there is none.
        now
            Time of the picture [s].
        mirrored
            Whether a surface mirrors the room: if none does, nothing is filtered.
        """
        if room is None:
            self.forget()
            return None
        if not 0.0 <= now - self._time <= MAX_PAUSE_S:
            self.forget()
        self._time = now
        if self._to is None or (mirrored and self._to.reflections is None):
            self._show_at_once(room, mirrored)
        else:
            self._prepare(room, now, mirrored)
        shown = self._mixed(now)
        if mirrored:
            self._write(shown)
        sphere = np.array([*room.centre, room.reach])
        return RoomLighting(shown.irradiance, sphere, self._texture if mirrored else None)

    def _show_at_once(self, room: RoomMap, mirrored: bool) -> None:
        light = pyramid(room.planes)
        self._to = _Prepared(irradiance(light), filtered(light) if mirrored else None)
        self._map, self._next, self._filter, self._from = room, None, None, None

    def _prepare(self, room: RoomMap, now: float, mirrored: bool) -> None:
        """Begin to filter a new map, or go on; begin to fade when one is ready."""
        if self._next is None and room is not self._map:
            light = pyramid(room.planes)
            self._next, self._coefficients = room, irradiance(light)
            self._filter = ReflectionFilter(light) if mirrored else None
        if self._next is None:
            return
        if self._filter is not None:
            self._filter.step()
            if self._filter.done < PARTS:
                return
        reflections = None if self._filter is None else self._filter.texture
        self._from = self._mixed(now)
        self._to = _Prepared(self._coefficients, reflections)
        self._map, self._next, self._filter, self._began = self._next, None, None, now

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
            self._written = None
        if shown is not self._written and shown.reflections is not None:
            self._texture.write(shown.reflections)
            self._written = shown

    def release(self) -> None:
        """Release the texture; a second call does nothing."""
        if self._texture is not None:
            self._texture.release()
            self._texture = None
