"""What the passes of a picture share."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.camera_picture.haze import haze_table
from cubeling.characters.rendering.camera_picture.light import Light
from cubeling.characters.rendering.camera_picture.occlusion import corners_of, hidden_by_cube
from cubeling.characters.rendering.environment.room import RoomLighting
from cubeling.characters.rendering.geometry.character_cache import CharacterInstance
from cubeling.characters.rendering.projection import (
    NEAR_M,
    Rectangle,
    bounding_rectangle,
    clip_from_camera,
)
from cubeling.characters.rendering.scene import Box, Scene, Softness
from cubeling.characters.rendering.target import LayerTarget, TargetCache
from cubeling.characters.skeleton.pose import Array

Image = NDArray[np.uint8]

MIN_TABLE_DISTANCE_M = 1e-6
"""A camera that is nearer to the plane of the table sees its edge, and nothing on it [m]."""


@dataclass(frozen=True)
class CharacterLayer:
    """Where the characters are drawn: supersampled, with depth, on transparent ground."""

    area: Rectangle
    """The area of the picture that it covers."""

    target: LayerTarget
    """It is drawn on from its first texel on."""

    clip_from_camera: Array
    """Projection to the layer, (4, 4)."""

    cubes: tuple[Box, ...]
    """Real cubes in this area."""

    @property
    def texels(self) -> tuple[int, int]:
        """Columns and rows of the target that are used."""
        return self.target.fineness * self.area.width, self.target.fineness * self.area.height

    def use(self) -> moderngl.Framebuffer:
        """Draw on this layer from now on."""
        return self._use(self.target.framebuffer)

    def use_geometry(self) -> moderngl.Framebuffer:
        """Draw on the geometry buffer of this layer from now on."""
        return self._use(self.target.geometry.framebuffer)

    def use_light(self) -> moderngl.Framebuffer:
        """Draw on the light buffer of this layer from now on."""
        return self._use(self.target.light.framebuffer)

    def use_scattered(self) -> moderngl.Framebuffer:
        """Draw on the scattered light of this layer from now on."""
        return self._use(self.target.light.scattered_framebuffer)

    def use_sum(self) -> moderngl.Framebuffer:
        """Draw on the sum of the light of this layer from now on."""
        return self._use(self.target.light.sum_framebuffer)

    def _use(self, framebuffer: moderngl.Framebuffer) -> moderngl.Framebuffer:
        framebuffer.use()
        framebuffer.viewport = (0, 0, *self.texels)
        return framebuffer


@dataclass(frozen=True)
class FrameResources:
    """All that the passes share while they draw one picture; built once a frame."""

    context: moderngl.Context
    """Where everything is drawn."""

    layers: TargetCache
    """Targets to draw the characters in."""

    scene: Scene
    """What the picture shows."""

    undistorted: Callable[[], Image]
    """Returns `picture` without lens distortion, when a thread has computed it."""

    size: tuple[int, int]
    """(width, height) of the picture [px]."""

    camera_matrix: Array
    """Pinhole matrix of the picture, (3, 3) [px]."""

    camera_from_table: Array
    """Pose of the table, (4, 4) [m]."""

    light: Light
    """What lights the scene."""

    softness: Softness | None
    """Blur and noise of the characters."""

    cubes: tuple[tuple[Box, Rectangle], ...]
    """Real cubes in the picture, and where they are in it."""

    characters: tuple[CharacterInstance, ...]
    """The visible characters, skinned on the graphics card."""

    room: RoomLighting | None = None
    """The light from all around, if there is a map of the room."""

    @property
    def scale(self) -> float:
        """Size of a pixel of the camera's frame in the picture [px]."""
        return float(self.camera_matrix[1, 1] / self.scene.view.matrix[1, 1])

    @cached_property
    def picture(self) -> Image:
        """The undistorted camera frame, (height, width, 3) BGR, which passes draw on.

        Another thread may still be at work on it: it is not asked for before `composite`.
        """
        return self.undistorted()

    @cached_property
    def haze(self) -> Image | None:
        """What each sRGB value becomes in this picture, (256,); None if it is clear."""
        soft = self.softness
        return None if soft is None else haze_table(soft.haze, soft.paper)

    @cached_property
    def hidden_by_cubes(self) -> tuple[tuple[Rectangle, Image], ...]:
        """Where real cubes are in the picture, and what share of each pixel they hide, 0…255."""
        return tuple(
            (place, hidden_by_cube(box, self.camera_matrix, place)) for box, place in self.cubes
        )

    @cached_property
    def camera_position(self) -> Array:
        """The camera in the table frame, (3,) [m]."""
        rotation, origin = self.camera_from_table[:3, :3], self.camera_from_table[:3, 3]
        # −Rᵀ t, written as a row times a matrix.
        return np.asarray(-origin @ rotation, float)

    @cached_property
    def table_plane(self) -> Array:
        """The table in the camera frame, (3,) [1/m]: a point is on it if its product is 1.

        It is zero, which no point is on, if the camera looks along the table.
        """
        up, point = self.camera_from_table[:3, 1], self.camera_from_table[:3, 3]
        distance = float(up @ point)
        return up / distance if abs(distance) > MIN_TABLE_DISTANCE_M else np.zeros(3)

    def depths_of(self, character: CharacterInstance) -> tuple[float, float]:
        """Return the least and the greatest depth of a character, not before the near plane [m]."""
        row = self.camera_from_table[2]
        depths = character.enclosing @ row[:3] + row[3]
        return max(float(depths.min()), NEAR_M), max(float(depths.max()), NEAR_M)

    def area_of(self, points: Array) -> Rectangle | None:
        """Return the area of the picture around points (n, 3) of the table frame, or None."""
        return bounding_rectangle(points, self.camera_matrix, self.camera_from_table, self.size)

    @property
    def on_table(self) -> tuple[CharacterInstance, ...]:
        """The characters that are in no cube: their shadows fall on the table."""
        return tuple(each for each in self.characters if each.inside is None)

    @property
    def open_cubes(self) -> tuple[Box, ...]:
        """Real cubes in the picture whose inside is seen."""
        return tuple(box for box, _ in self.cubes if box.is_open)

    @cached_property
    def character_area(self) -> Rectangle | None:
        """The area around all characters and open cubes, without shadows; None for neither."""
        points = self.points_on_layer
        return self.area_of(points) if len(points) else None

    @property
    def pixel_m(self) -> float:
        """Size of a pixel in the middle of all characters and open cubes [m]."""
        middle, row = self.points_on_layer.mean(axis=0), self.camera_from_table[2]
        return max(float(middle @ row[:3] + row[3]), NEAR_M) / float(self.camera_matrix[1, 1])

    @property
    def points_on_layer(self) -> Array:
        """Points of the table frame around all characters and open cubes, (n, 3) [m]."""
        points = [character.enclosing for character in self.characters]
        points += [corners_of(box, self.camera_from_table) for box in self.open_cubes]
        return np.concatenate([np.zeros((0, 3)), *points])

    @cached_property
    def layer(self) -> CharacterLayer | None:
        """Where the characters and open cubes are drawn; None for neither."""
        area = self.character_area
        if area is None:
            return None
        return CharacterLayer(
            area,
            self.layers.at_least(area.width, area.height),
            clip_from_camera(self.camera_matrix, area),
            tuple(box for box, place in self.cubes if place.intersection(area)),
        )
