"""The picture: characters on the table in the camera's frame."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.errors import CharacterError
from characters.rendering.light import Light, LightEstimate
from characters.rendering.paper import paper_of
from characters.rendering.passes.background import Background
from characters.rendering.passes.characters import Cast, Figures
from characters.rendering.passes.cubes import Cubes, Outlines, that_show
from characters.rendering.passes.floor import FloorMarks
from characters.rendering.programs import Programs, assign
from characters.rendering.projection import (
    clip_from_camera,
    is_pinhole,
    is_rigid,
    merged,
    part_that_shows,
)
from characters.rendering.scene import Box, FloorPath, Rectangle, SceneCharacter, View
from characters.rendering.target import FINER, Patches, Target, Targets, widened

Array = NDArray[np.float64]
Image = NDArray[np.uint8]


@dataclass(frozen=True)
class Room:
    """What one part of the picture shows, without the characters."""

    matrix: Array
    """Pinhole matrix of the picture, (3, 3) [px]."""

    camera_from_table: Array
    """The table, (4, 4)."""

    cubes: Sequence[tuple[Box, Rectangle]]
    """Real cubes in this part, each with where it is in the picture."""

    outlines: Outlines
    """Of these cubes."""

    light: Light
    """What lights it."""


class Stage:
    """Draws characters into the camera's picture, off screen or into a window.

    Only those parts of the picture in which there is something to draw go through the graphics
    card, so that software rendering keeps up with a camera. The light is judged from the pictures
    drawn, so a picture depends on those before it, and on nothing else.

    Parameters
    ----------
    context
        From `create_context`; the stage does not release it.
    size
        Of the picture, (width, height) [px]. A camera frame of another size is fitted into it.
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        limit = context.info["GL_MAX_TEXTURE_SIZE"] // FINER
        if min(size) < 1 or max(size) > limit:
            raise CharacterError(
                f"cannot draw a picture of {size[0]}×{size[1]} pixels: this graphics card "
                f"draws 1 to {limit} along each side"
            )
        self.size = size
        """(width, height) [px]."""
        self._context = context
        self._programs = Programs(context)
        self._background = Background(size)
        self._estimate = LightEstimate()
        self._targets = Targets(context, self._programs)
        self._cubes = Cubes(context, self._programs)
        self._marks = FloorMarks(context, self._programs)
        self._figures = Figures(context, self._programs)
        self._frame = Patches(context)
        self._copy = context.vertex_array(self._programs.copy, [])

    def draw(
        self, view: View, actors: Sequence[SceneCharacter], floor: Sequence[FloorPath] = ()
    ) -> Image:
        """Return the picture, (height, width, 3) uint8 BGR.

        Parameters
        ----------
        view
            The camera's frame and the room in it.
        actors
            Who stands on the table.
        floor
            What is painted on the table.

        Raises
        ------
        CharacterError
            The frame is no picture, or a character has nothing to draw.
        """
        picture, matrix = self._background.of(view)
        for part, target in self._parts(picture, matrix, view, actors, floor):
            drawn = target.result.read((0, 0, part.width, part.height), components=3, alignment=1)
            picture[part.rows_and_columns] = np.frombuffer(drawn, np.uint8).reshape(
                part.height, part.width, 3
            )
        return picture

    def draw_to(
        self,
        framebuffer: moderngl.Framebuffer,
        view: View,
        actors: Sequence[SceneCharacter],
        floor: Sequence[FloorPath] = (),
        viewport: tuple[int, int, int, int] | None = None,
    ) -> None:
        """Draw the same picture into a window.

        Parameters
        ----------
        framebuffer
            The window's; it stays in use.
        view, actors, floor
            As for `draw`.
        viewport
            Where in the framebuffer, (x, y, width, height) [px] from its lower left corner; all of
            it if None. The caller chooses it with the picture's ratio of sides.
        """
        viewport = viewport or (0, 0, *framebuffer.size)
        picture, matrix = self._background.of(view)
        whole = Rectangle(0, 0, *self.size)
        self._show(self._frame.upload(picture), whole, framebuffer, viewport)
        for part, target in self._parts(picture, matrix, view, actors, floor):
            self._show(target.picture, part, framebuffer, viewport)
        framebuffer.use()

    def release(self) -> None:
        """Give back everything but the context; a second call does nothing."""
        # The next framebuffer to be made would bind again what was bound: it must still be there.
        self._context.detect_framebuffer(0).use()
        parts = (self._figures, self._marks, self._targets, self._cubes, self._frame)
        for owned in (*parts, self._programs):
            owned.release()
        self._copy.release()

    def _parts(
        self,
        picture: Image,
        matrix: Array,
        view: View,
        actors: Sequence[SceneCharacter],
        floor: Sequence[FloorPath],
    ) -> Iterator[tuple[Rectangle, Target]]:
        """Draw the parts of the picture that change, one after the other; a later one is on top.

        The caller takes each before it asks for the next, and may write into `picture`.
        """
        light = self._estimate.update(picture, paper_of(picture, matrix, view))
        table = view.camera_from_table
        if table is None or not is_pinhole(view.matrix) or not is_rigid(table):
            return
        self._targets.at_least(1, 1).result.use()
        casts, bodies, shadows = self._figures.pose(actors, light)
        strewn = [
            part_that_shows(points, matrix, table, self.size) for points in self._marks.lay(floor)
        ]
        parts = merged([part for part in strewn if part is not None])
        around = np.concatenate([bodies, shadows])
        figures = part_that_shows(around, matrix, table, self.size)
        inner = part_that_shows(bodies, matrix, table, self.size)
        jobs: list[tuple[Rectangle, Rectangle | None]] = [(part, None) for part in parts]
        if figures is not None:
            jobs = [job for job in jobs if figures.joined(job[0]) != figures]
            jobs.append((figures, inner or figures))
        cubes = that_show(view.occluders, matrix, self.size)
        patches = [widened(picture[part.rows_and_columns]) for part, _ in jobs]
        for (part, inside), patch in zip(jobs, patches, strict=True):
            room = Room(
                matrix,
                np.asarray(table, float),
                [cube for cube in cubes if cube[1].meets(part)],
                Outlines.of([box for box, place in cubes if place.meets(part)], matrix, part),
                light,
            )
            yield part, self._draw_part(part, patch, room, casts, inside)

    def _draw_part(
        self,
        part: Rectangle,
        patch: Image,
        room: Room,
        casts: Sequence[Cast],
        figures: Rectangle | None,
    ) -> Target:
        """Draw marks and shadows on the picture, then the figures, then these over it."""
        context, light = self._context, room.light
        clip_from_table = clip_from_camera(room.matrix, part) @ room.camera_from_table
        target = self._targets.at_least(part.width, part.height)
        target.lay(patch)
        target.result.use()
        target.result.viewport = (0, 0, part.width, part.height)
        context.enable_only(moderngl.BLEND)
        context.front_face = "cw"  # the rows of the canvas run downwards
        context.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        self._marks.draw(clip_from_table, light.white, room.outlines)
        context.blend_func = moderngl.DST_COLOR, moderngl.ZERO
        for cast in casts if figures else ():
            cast.shadow.draw(clip_from_table, room.outlines)
        if figures is not None:
            fine = self._draw_figures(figures, room, casts)
            target.combine(fine, figures.seen_from(part))
        context.front_face = "ccw"  # as others expect it
        return target

    def _draw_figures(self, part: Rectangle, room: Room, casts: Sequence[Cast]) -> Target:
        """Draw the figures in a part of the picture, on nothing."""
        fine = self._targets.at_least(part.width, part.height)
        fine.figures.use()
        fine.figures.viewport = (0, 0, FINER * part.width, FINER * part.height)
        fine.figures.clear()
        clip = clip_from_camera(room.matrix, part)
        self._cubes.hide([box for box, place in room.cubes if place.meets(part)], clip)
        eye = np.asarray(np.linalg.inv(room.camera_from_table)[:3, 3], float)
        self._figures.draw(casts, clip @ room.camera_from_table, eye, room.light)
        return fine

    def _show(
        self,
        texture: moderngl.Texture,
        place: Rectangle,
        framebuffer: moderngl.Framebuffer,
        viewport: tuple[int, int, int, int],
    ) -> None:
        """Copy a part of the picture into a window."""
        width, height = self.size
        shares = (place.x / width, place.y / height, place.width / width, place.height / height)
        filled = (place.width / texture.width, place.height / texture.height)
        framebuffer.use()
        framebuffer.viewport = viewport
        self._context.enable_only(moderngl.NOTHING)
        assign(self._programs.copy, place=shares, filled=filled)
        texture.use(0)
        self._copy.render(moderngl.TRIANGLE_STRIP, vertices=4)
