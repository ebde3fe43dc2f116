"""The picture: characters on the table in the camera's frame."""

from collections import OrderedDict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.errors import CharacterError
from characters.rendering.background import Background
from characters.rendering.floor import FloorMarks
from characters.rendering.ground import Ground, Patches
from characters.rendering.light import TO_LIGHT, Light, LightEstimate
from characters.rendering.paper import paper_of
from characters.rendering.programs import Programs, assign
from characters.rendering.projection import (
    clip_from_camera,
    is_pinhole,
    is_rigid,
    merged,
    part_that_shows,
)
from characters.rendering.shadow import Shadow
from characters.rendering.skinning import SkinnedCharacter
from characters.rendering.target import FINER, Target, Targets
from characters.rendering.view import Actor, Drawable, FloorPath, Rectangle, View

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

KEPT_CHARACTERS = 8
"""How many characters stay on the graphics card; the one not drawn for longest leaves first."""


@dataclass(frozen=True)
class Cast:
    """A character that is posed on the graphics card, with its shadow."""

    character: SkinnedCharacter
    """Skinned in the table frame."""

    shadow: Shadow
    """Its map is ready."""

    height: float
    """On the table [m]."""


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
        self._ground = Ground(context, self._programs)
        self._marks = FloorMarks(context, self._programs)
        self._shadows: list[Shadow] = []
        self._characters: OrderedDict[int, tuple[Drawable, SkinnedCharacter]] = OrderedDict()
        self._frame = Patches(context)
        self._copy = context.vertex_array(self._programs.copy, [])

    def draw(self, view: View, actors: Sequence[Actor], floor: Sequence[FloorPath] = ()) -> Image:
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
        actors: Sequence[Actor],
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
        while self._characters:
            self._characters.popitem()[1][1].release()
        while self._shadows:
            self._shadows.pop().release()
        for owned in (self._marks, self._targets, self._ground, self._frame, self._programs):
            owned.release()
        self._copy.release()

    def _parts(
        self,
        picture: Image,
        matrix: Array,
        view: View,
        actors: Sequence[Actor],
        floor: Sequence[FloorPath],
    ) -> Iterator[tuple[Rectangle, Target]]:
        """Draw the parts of the picture that change, one after the other; a later one is on top.

        The caller takes each before it asks for the next, and may write into `picture`.
        """
        light = self._estimate.update(picture, paper_of(picture, matrix, view))
        table = view.camera_from_table
        if table is None or not is_pinhole(view.matrix) or not is_rigid(table):
            return
        casts, around = self._pose(actors)
        strewn = [
            part_that_shows(points, matrix, table, self.size) for points in self._marks.lay(floor)
        ]
        parts = merged([part for part in strewn if part is not None])
        figures = part_that_shows(around, matrix, table, self.size)
        jobs: list[tuple[Rectangle, Sequence[Cast]]] = [(part, ()) for part in parts]
        if figures is not None:
            jobs = [job for job in jobs if figures.joined(job[0]) != figures]
            jobs.append((figures, casts))
        patches = [picture[part.rows_and_columns].copy() for part, _ in jobs]
        for (part, cast), patch in zip(jobs, patches, strict=True):
            clip = clip_from_camera(matrix, part)
            yield part, self._draw_part(part, patch, clip, view, cast, light)

    def _draw_part(
        self,
        part: Rectangle,
        patch: Image,
        clip: Array,
        view: View,
        casts: Sequence[Cast],
        light: Light,
    ) -> Target:
        """Draw the ground with marks and shadows, then the figures, then one over the other."""
        context, table = self._context, np.asarray(view.camera_from_table, float)
        target = self._targets.at_least(part.width, part.height)
        context.front_face = "cw"  # the rows of the canvas run downwards
        target.ground.use()
        target.ground.viewport = (0, 0, part.width, part.height)
        target.ground.clear()
        self._ground.draw(patch)
        self._ground.hide(view.occluders, clip)
        target.ground.depth_mask = False  # marks and shadows lie in one plane
        target.ground.use()
        context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        context.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        self._marks.draw(clip @ table, light.white)
        context.blend_func = moderngl.DST_COLOR, moderngl.ZERO
        for cast in casts:
            cast.shadow.draw(clip @ table, light.key * TO_LIGHT[1] / light.white)
        target.ground.depth_mask = True
        if casts:
            target.figures.use()
            target.figures.viewport = (0, 0, FINER * part.width, FINER * part.height)
            target.figures.clear()
            self._ground.hide(view.occluders, clip)
            self._figures(casts, clip @ table, np.linalg.inv(table)[:3, 3], light)
        target.resolve(with_figures=bool(casts))
        return target

    def _pose(self, actors: Sequence[Actor]) -> tuple[list[Cast], Array]:
        """Skin all characters, cast their shadows, and find points around them, (n, 3)."""
        casts: list[Cast] = []
        around = [np.zeros((0, 3))]
        # Transform feedback needs a complete framebuffer in use, though it draws nothing.
        self._targets.at_least(1, 1).result.use()
        for actor in actors:
            place = np.asarray(actor.posed.table_from_character, float)
            if not actor.posed.visible or not is_rigid(place):
                continue
            character = self._skinned(actor.character)
            with np.errstate(invalid="ignore", over="ignore"):  # `pose` tells such numbers
                joints = actor.posed.pose.globals(actor.character.skeleton)
                enclosing = character.pose(joints, place)
            if enclosing is None:
                continue
            if len(casts) == len(self._shadows):
                self._shadows.append(Shadow(self._context, self._programs))
            shadow = self._shadows[len(casts)]
            height = character.height * float(np.linalg.norm(place[:3, 1]))
            around += [enclosing, shadow.cast(character, enclosing, height)]
            casts.append(Cast(character, shadow, height))
        return casts, np.concatenate(around)

    def _skinned(self, character: Drawable) -> SkinnedCharacter:
        """Return a character's buffers, made when it is first seen."""
        key = id(character)
        kept = self._characters.pop(key, None)
        if kept is None:
            kept = (character, SkinnedCharacter(self._context, self._programs, character))
        self._characters[key] = kept
        if len(self._characters) > KEPT_CHARACTERS:
            self._characters.popitem(last=False)[1][1].release()
        return kept[1]

    def _figures(
        self, casts: Sequence[Cast], clip_from_table: Array, eye: Array, light: Light
    ) -> None:
        """Draw the characters into the framebuffer in use."""
        context = self._context
        context.enable_only(moderngl.DEPTH_TEST)
        for cast in casts:
            for part in cast.character.parts:
                textured = part.texture is not None
                program = self._programs.textured if textured else self._programs.plain
                surface = cast.character.textured if textured else cast.character.plain
                material = part.material
                assign(program, clip_from_table=clip_from_table, eye=eye, to_light=TO_LIGHT)
                assign(program, key=light.key, sky=light.sky, ground=light.ground)
                assign(program, height=cast.height, base_color=material.base_color[:3])
                assign(program, metallic=material.metallic, roughness=material.roughness)
                if part.texture is not None:
                    part.texture.use(0)
                (context.disable if material.double_sided else context.enable)(moderngl.CULL_FACE)
                surface.render(vertices=part.count, first=part.first)

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
