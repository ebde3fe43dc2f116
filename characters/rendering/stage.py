"""The picture: characters on the table in the camera's frame."""

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.rendering.camera_picture.light import LightEstimator, paper_color
from cubeling.characters.rendering.camera_picture.occlusion import visible_cubes
from cubeling.characters.rendering.camera_picture.undistortion import Undistorter
from cubeling.characters.rendering.environment.room import RoomMaps
from cubeling.characters.rendering.geometry.character_cache import CharacterCache, PictureFineness
from cubeling.characters.rendering.passes.by_quality import passes_for
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.programs import ShaderPrograms
from cubeling.characters.rendering.projection import is_invertible, is_pinhole
from cubeling.characters.rendering.quality import FULL, QUALITIES, Quality
from cubeling.characters.rendering.resources import FrameResources
from cubeling.characters.rendering.scene import (
    CameraView,
    FloorPath,
    Scene,
    SceneCharacter,
    Softness,
)
from cubeling.characters.rendering.target import TargetCache
from cubeling.characters.skeleton.pose import Array

Image = NDArray[np.uint8]


class CoarseSoftness(NamedTuple):
    """Blur of a layer as coarse as the picture: it hides the steps along edges; a `Softness`."""

    blur: float = 0.64
    noise: float = 0.0
    haze: float = 0.0
    paper: float = 1.0


class Stage:
    """Draws characters into the camera's picture.

    A picture is an ordered list of passes over one `FrameResources`. Only the characters go through
    the graphics card, so that software rendering keeps up with a camera: all else is in memory. The
    light is estimated from the pictures: a picture depends on those since `forget` alone.

    Parameters
    ----------
    context
        From `create_context`; the stage does not release it.
    size
        Of the picture, (width, height) [px]. A camera frame of another size is scaled to fit.

    Raises
    ------
    CharacterError
        The graphics card cannot draw a picture of this size.
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        finest = max(each.fineness for each in QUALITIES.values())
        limit = context.info["GL_MAX_TEXTURE_SIZE"] // finest
        if min(size) < 1 or max(size) > limit:
            raise CharacterError(
                f"cannot draw a picture of {size[0]}×{size[1]} pixels: this graphics card "
                f"draws 1 to {limit} along each side"
            )
        self.size = size
        """(width, height) [px]."""
        self.programs = ShaderPrograms(context)
        """The shaders of all passes."""
        self._own_passes = passes_for(FULL, context, self.programs)
        self.passes: list[RenderPass] = [*self._own_passes]
        """The passes, in the order in which they draw; the stage releases them. A change of the
        quality replaces the stage's own; others come after them then."""
        self._context = context
        self._undistorter = Undistorter(size)
        self._light = LightEstimator()
        self._room = RoomMaps(context)
        self._quality = FULL
        self._layers = TargetCache(context, FULL.fineness)
        self._one_texel = context.texture((1, 1), 4)
        self._idle = context.framebuffer([self._one_texel])  # in use while nothing is drawn
        self._characters = CharacterCache(context, self.programs)

    @property
    def quality(self) -> Quality:
        """How finely characters are drawn; it may change between pictures."""
        return self._quality

    @quality.setter
    def quality(self, quality: Quality) -> None:
        if quality != self._quality:
            self._context.detect_framebuffer(0).use()
            self._layers.release()
            self._layers = TargetCache(self._context, quality.fineness)
            self._quality = quality
            added = [each for each in self.passes if each not in self._own_passes]
            for render_pass in self._own_passes:
                render_pass.release()
            self._own_passes = passes_for(quality, self._context, self.programs)
            self.passes = [*self._own_passes, *added]

    @property
    def triangles(self) -> int:
        """How many triangles the characters of the last picture had."""
        return self._characters.triangles

    def forget(self) -> None:
        """Forget the light that was seen: the next picture is of another time or place."""
        self._light = LightEstimator()
        self._room.forget()

    def expect(self, image: Image, matrix: Array, distortion: Array) -> None:
        """Begin with a frame that `draw` gets next, while the caller still finds out what is in it.

        The picture is the same without this call, only later.
        """
        self._undistorter.start(image, matrix, distortion)

    def draw(
        self,
        view: CameraView,
        characters: Sequence[SceneCharacter],
        floor: Sequence[FloorPath] = (),
    ) -> Image:
        """Return the picture, (height, width, 3) uint8 BGR.

        Parameters
        ----------
        view
            The camera's frame, its pinhole matrix and distortion, the pose of the table, and what
            else is known of the scene. Without a table, nothing is drawn.
        characters
            The posed characters on the table.
        floor
            Paths that are painted on the table, below the characters and their shadows.

        Raises
        ------
        CharacterError
            The frame is not an image, or a character has nothing to draw.
        """
        frame = self._frame(Scene(view, characters, floor))
        if frame is None:
            return self._undistorter.undistort(view)
        self._draw_layer(frame)
        cover = None if view.hand is None else self._undistorter.cover_in_picture(view.hand)
        self._context.front_face = "cw"
        for each in self.passes:
            each.composite(frame, cover)
        self._context.front_face = "ccw"
        return frame.picture

    def _draw_layer(self, frame: FrameResources) -> None:
        """Prepare all passes and draw the characters; the driver draws while the caller goes on."""
        for each in self.passes:
            each.prepare(frame)
        self._begin_to_draw()
        # Found while the driver draws the shadow maps, which are read next.
        _ = frame.hidden_by_cubes
        if frame.layer is not None:
            self._context.front_face = "cw"  # the first row of a target is its top row
            for each in self.passes:
                each.draw_layer(frame, frame.layer)
            self._context.front_face = "ccw"  # as code outside of the stage expects it
        self._begin_to_draw()

    def _begin_to_draw(self) -> None:
        """Let a software driver start, as it does when another framebuffer is drawn on."""
        self._idle.use()
        self._idle.clear()

    def release(self) -> None:
        """Release everything but the context; a second call does nothing."""
        # moderngl binds the last framebuffer again when it creates the next: it must still exist.
        self._context.detect_framebuffer(0).use()
        for render_pass in self.passes:
            render_pass.release()
        self._characters.release()
        self._room.release()
        self._layers.release()
        self._idle.release()
        self._one_texel.release()
        self._undistorter.release()
        self.programs.release()

    def _softness(self, view: CameraView) -> Softness | None:
        """Return the blur and noise of what is drawn; a coarse layer is blurred to be smooth."""
        return view.softness if self._quality.matched else CoarseSoftness()

    def _frame(self, scene: Scene) -> FrameResources | None:
        """Return the resources to draw on the picture if there is a table."""
        view = scene.view
        matrix = self._undistorter.matrix_of(view)
        table = view.camera_from_table
        if not is_invertible(table):
            table = None
        seen = self._undistorter.undistort(view) if view.image is None else view.image
        light = self._light.update(seen, partial(paper_color, view), view.light, table)
        if table is None or not is_pinhole(view.matrix):
            return None
        self._idle.use()
        characters = self._characters.skin(
            scene.characters,
            PictureFineness(table, float(matrix[1, 1]), self._quality.max_error_px),
        )
        mirrored = [each for character in characters for each in character.skinned.mirrored]
        return FrameResources(
            context=self._context,
            layers=self._layers,
            scene=scene,
            undistorted=partial(self._undistorter.undistort, view),
            size=self.size,
            camera_matrix=matrix,
            camera_from_table=np.asarray(table, float),
            light=light,
            softness=self._softness(view),
            cubes=visible_cubes(view.occluders, matrix, self.size),
            characters=characters,
            room=self._room.update(view.room, view.timestamp, mirrored),
        )
