"""The picture: characters on the table in the camera's frame."""

from collections import OrderedDict
from collections.abc import Sequence

import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.errors import CharacterError
from characters.rendering.background import Background
from characters.rendering.floor import FloorMarks
from characters.rendering.light import TO_LIGHT, Light, LightEstimate
from characters.rendering.programs import Programs, assign
from characters.rendering.projection import clip_from_camera, is_pinhole, is_rigid, part_that_shows
from characters.rendering.shadow import Shadow
from characters.rendering.skinning import SkinnedCharacter
from characters.rendering.target import Target, Targets
from characters.rendering.view import Actor, Box, Drawable, FloorPath, Rectangle, View

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

KEPT_CHARACTERS = 8
"""How many characters stay on the graphics card; the one not drawn for longest leaves first."""


class Stage:
    """Draws characters into the camera's picture, off screen or into a window.

    Only the part of the picture in which there is something to draw goes through the graphics card, so that
    software rendering keeps up with a camera.

    Parameters
    ----------
    context
        From `create_context`; the stage does not release it.
    size
        Of the picture, (width, height) [px]. A camera frame of another size is fitted into it.
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        if min(size) < 1 or max(size) > context.info["GL_MAX_TEXTURE_SIZE"]:
            raise CharacterError(
                f"cannot draw a picture of {size[0]}×{size[1]} pixels on this graphics card"
            )
        self.size = size
        self._context = context
        self._programs = Programs(context)
        self._background = Background(size)
        self._estimate = LightEstimate()
        self._targets = Targets(context)
        self._marks = FloorMarks(context, self._programs)
        self._shadows: list[Shadow] = []
        self._characters: OrderedDict[int, tuple[Drawable, SkinnedCharacter]] = OrderedDict()
        self._patch = _Patches(context)
        self._screen = context.vertex_array(self._programs.backdrop, [])
        self._copy = context.vertex_array(self._programs.copy, [])
        self._cube = context.buffer(_CUBE.astype("f4"))
        self._box = context.vertex_array(self._programs.box, [(self._cube, "3f", "position")])

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
        picture, part, target = self._compose(view, actors, floor)
        if part is not None and target is not None:
            patch = target.result.read((0, 0, part.width, part.height), components=3, alignment=1)
            picture[part.rows_and_columns] = np.frombuffer(patch, np.uint8).reshape(
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
            Where in the framebuffer, (x, y, width, height) [px] from its lower left corner; all of it if None.
            The caller chooses it with the picture's ratio of sides.
        """
        picture, part, target = self._compose(view, actors, floor)
        context = self._context
        framebuffer.use()
        framebuffer.viewport = viewport or (0, 0, *framebuffer.size)
        context.enable_only(moderngl.NOTHING)
        width, height = self.size
        self._show(self._patch.upload(picture), Rectangle(0, 0, width, height))
        if part is not None and target is not None:
            self._show(target.picture, part)

    def release(self) -> None:
        """Give back everything but the context; a second call does nothing."""
        for _, character in self._characters.values():
            character.release()
        self._characters.clear()
        while self._shadows:
            self._shadows.pop().release()
        for owned in (
            self._marks, self._targets, self._patch, self._screen, self._copy, self._box, self._cube,
            self._programs,
        ):  # fmt: skip
            owned.release()

    def _compose(
        self, view: View, actors: Sequence[Actor], floor: Sequence[FloorPath]
    ) -> tuple[Image, Rectangle | None, Target | None]:
        """Return the camera's picture, the part of it that changes, and that part as drawn."""
        picture, matrix = self._background.of(view)
        light = self._estimate.update(picture)
        table = view.camera_from_table
        if not is_pinhole(view.matrix) or table is None or not is_rigid(table):
            return picture, None, None
        context = self._context
        casts, around = self._pose(actors)
        around.append(self._marks.lay(floor))
        part = part_that_shows(np.concatenate(around), matrix, table, self.size)
        if part is None:
            return picture, None, None
        target = self._targets.at_least(part.width, part.height)
        target.canvas.use()
        target.canvas.viewport = (0, 0, part.width, part.height)
        target.canvas.clear()
        context.front_face = "cw"  # the rows of the canvas run downwards
        self._patch.upload(picture[part.rows_and_columns]).use(0)
        context.enable_only(moderngl.NOTHING)
        self._screen.render(moderngl.TRIANGLES, vertices=3)
        clip = clip_from_camera(matrix, part)
        self._hide(view.occluders, clip)
        self._paint(casts, clip @ table, np.linalg.inv(table)[:3, 3], light)
        target.resolve()
        return picture, part, target

    def _pose(
        self, actors: Sequence[Actor]
    ) -> tuple[list[tuple[SkinnedCharacter, Shadow, float]], list[Array]]:
        """Skin all characters and cast their shadows; return them with their heights, and points around."""
        casts: list[tuple[SkinnedCharacter, Shadow, float]] = []
        around: list[Array] = []
        # Transform feedback needs a complete framebuffer in use, though it draws nothing.
        self._targets.at_least(1, 1).canvas.use()
        for actor in actors:
            place = np.asarray(actor.posed.table_from_character, float)
            if not actor.posed.visible or not is_rigid(place):
                continue
            character = self._skinned(actor.character)
            joints = actor.posed.pose.globals(actor.character.skeleton)
            enclosing = character.pose(joints, place)
            if enclosing is None:
                continue
            if len(casts) == len(self._shadows):
                self._shadows.append(Shadow(self._context, self._programs))
            shadow = self._shadows[len(casts)]
            height = character.height * float(np.linalg.norm(place[:3, 1]))
            around += [enclosing, shadow.cast(character, enclosing, height)]
            casts.append((character, shadow, height))
        return casts, around

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

    def _hide(self, boxes: Sequence[Box], clip_from_camera: Array) -> None:
        """Write the depth of the real cubes, and nothing else."""
        framebuffer = self._context.fbo
        framebuffer.color_mask = False, False, False, False
        self._context.enable_only(moderngl.DEPTH_TEST)
        for box in boxes:
            if is_rigid(box.camera_from_box) and np.isfinite(box.edge):
                scale = np.diag([box.edge, box.edge, box.edge, 1.0])
                clip = clip_from_camera @ box.camera_from_box @ scale
                assign(self._programs.box, clip_from_box=clip)
                self._box.render(moderngl.TRIANGLES)
        framebuffer.color_mask = True, True, True, True

    def _paint(
        self,
        casts: Sequence[tuple[SkinnedCharacter, Shadow, float]],
        clip_from_table: Array,
        eye: Array,
        light: Light,
    ) -> None:
        """Draw the marks, the shadows on them, then the characters."""
        context = self._context
        context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        context.fbo.depth_mask = False
        context.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        self._marks.draw(clip_from_table, light.white)
        context.blend_func = moderngl.DST_COLOR, moderngl.ZERO
        for _, shadow, _ in casts:
            shadow.draw(clip_from_table, light.key * TO_LIGHT[1] / light.white)
        context.fbo.depth_mask = True
        context.enable_only(moderngl.DEPTH_TEST)
        program = self._programs.character
        assign(program, clip_from_table=clip_from_table, eye=eye, to_light=TO_LIGHT)
        assign(program, key=light.key, sky=light.sky, ground=light.ground)
        for character, _, height in casts:
            assign(program, height=height)
            self._surface(character)

    def _surface(self, character: SkinnedCharacter) -> None:
        program, context = self._programs.character, self._context
        for part in character.parts:
            material = part.material
            (context.disable if material.double_sided else context.enable)(moderngl.CULL_FACE)
            assign(program, base_color=material.base_color[:3], metallic=material.metallic)
            assign(program, roughness=material.roughness, textured=part.texture is not None)
            if part.texture is not None:
                part.texture.use(0)
            character.surface.render(vertices=part.count, first=part.first)

    def _show(self, texture: moderngl.Texture, place: Rectangle) -> None:
        """Copy a part of the picture into the framebuffer in use."""
        width, height = self.size
        shares = (place.x / width, place.y / height, place.width / width, place.height / height)
        filled = (place.width / texture.width, place.height / texture.height)
        assign(self._programs.copy, place=shares, filled=filled)
        texture.use(0)
        self._copy.render(moderngl.TRIANGLE_STRIP, vertices=4)


class _Patches:
    """One texture that takes patches of pictures, made anew when one is larger."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._texture: moderngl.Texture | None = None

    def upload(self, patch: Image) -> moderngl.Texture:
        """Send a patch (height, width, 3) to the lower left corner of the texture, first row first."""
        height, width = patch.shape[:2]
        room = (0, 0) if self._texture is None else self._texture.size
        if self._texture is None or room[0] < width or room[1] < height:
            self.release()
            room = (max(room[0], width), max(room[1], height))
            self._texture = self._context.texture(room, 3)
            self._texture.repeat_x = self._texture.repeat_y = False
        self._texture.write(
            np.ascontiguousarray(patch), viewport=(0, 0, width, height), alignment=1
        )
        return self._texture

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        if self._texture is not None:
            self._texture.release()
            self._texture = None


_FACE = np.array([(-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, -1, 1), (1, 1, 1), (-1, 1, 1)]) / 2
_CUBE = np.concatenate(
    [sign * np.roll(_FACE, axis, axis=1) for axis in range(3) for sign in (1, -1)]
)
