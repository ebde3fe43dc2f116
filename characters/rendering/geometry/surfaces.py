"""The surfaces of a character on the graphics card: materials with textures and programs."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.mesh import Material
from cubeling.characters.rendering.environment.room import ROOM_UNIT
from cubeling.characters.rendering.geometry.face_split import FaceSplit
from cubeling.characters.rendering.geometry.face_texture import FaceTexture
from cubeling.characters.rendering.programs import ShaderPrograms, set_uniforms

GL_SRGB8_ALPHA8 = 0x8C43
"""OpenGL's texture format that is decoded from sRGB when it is sampled."""

TEXTURE_UNITS = {
    **{"base_texture": 0, "surface_map": 1, "bump_map": 2, "shade_map": 3},
    **{"glow_map": 4, "occlusion_map": 5, "face_map": 6},
}
"""Texture units of a material's base colour, roughness and metalness, normals, toon shade, emission
and occlusion, and of the wrinkles and the blood of a face."""

FACE_FEATURE = "FACE"
"""What the shaders test to draw wrinkles and blood."""

GEOMETRY, CASTER, BEHIND = "GEOMETRY", "CASTER", "BEHIND"
"""Features of programs that write, instead of its colour in the light, what a surface is like, its
distance from the lamp, and the depths of its hidden sides."""

VERTEX_LIT = "VERTEX_LIT"
"""Feature of programs that shade vertices, not fragments, for surfaces that allow it."""

ROOM, MIRRORED, VERTEX_ROOM = "ROOM", "MIRRORED", "VERTEX_ROOM"
"""Features of programs that light a surface by a map of the room, that mirror it in there, and that
find at vertices only what light from all around falls on it."""

MIN_MIRROR_METALNESS, MAX_MIRROR_ROUGHNESS = 0.2, 0.45
"""Metalness from which on a surface mirrors more of the room than its mean light, and roughness
below which any does; in `room.glsl` too."""

CLIPPED = "CLIPPED"
"""Feature of programs that cut off what is outside of the cube that a character stands in."""

MIN_VERTEX_ROUGHNESS = 0.5
"""Least roughness of a surface of which vertices alone are shaded: highlights of a smoother one are
as small as triangles."""

BLENDED = "BLENDED"
"""Feature of a surface that is partly transparent, for the programs that can draw it so."""

# All others are linear.
_COLOR_UNITS = tuple(TEXTURE_UNITS[name] for name in ("base_texture", "shade_map", "glow_map"))

SKIN_FEATURE = "SKIN"
"""Feature of a surface below which light spreads, for the programs that keep that."""

MAPPED_FEATURES = {
    *("TEXTURED", "SURFACE", "BUMPS", "SHADE", "GLOW_MAP", "OCCLUSION"),
    *(FACE_FEATURE, SKIN_FEATURE),
}
"""Features that need texture coordinates."""

PLACED_FEATURES = {"BUMPS", GEOMETRY, CASTER, BEHIND, FACE_FEATURE, MIRRORED}
"""Features that need the place in the table frame."""


@dataclass(frozen=True)
class Surface:
    """A run of triangles with one material."""

    first: int
    """Position of its first index."""

    count: int
    """Number of its indices."""

    material: Material

    features: frozenset[str]
    """Result of `surface_features`."""

    screen_layer: int
    """Its number among the partly transparent surfaces of its character."""

    textures: tuple[tuple[int, moderngl.Texture], ...]
    """Units and textures of the material, see `TEXTURE_UNITS`."""

    face: FaceTexture | None = None
    """Wrinkles and blood on it."""

    def program_features(self, wanted: frozenset[str]) -> frozenset[str]:
        """Return the features of the program that draws it, with `wanted` ones where possible.

        Vertices of a surface with textures, two sides, toon shading or narrow highlights are not
        shaded alone.
        """
        material = self.material
        mirror = MIRRORED in wanted and self.mirrored is not None
        plain = self.features <= {"GLOW", SKIN_FEATURE} and not material.double_sided
        plain &= material.roughness >= MIN_VERTEX_ROUGHNESS and not mirror
        left_out = {name for name, kept in ((VERTEX_LIT, plain), (MIRRORED, mirror)) if not kept}
        features = self.features | (wanted - left_out)
        smooth = not (features & {"BUMPS", "TOON", FACE_FEATURE} or material.double_sided)
        return features | {VERTEX_ROOM} if ROOM in wanted and smooth else features

    @property
    def mirrored(self) -> tuple[float, float] | None:
        """Least and greatest roughness with which it mirrors more than the mean of what is around.

        None if it does not.
        """
        material, mapped = self.material, "SURFACE" in self.features
        metal = material.metallic >= MIN_MIRROR_METALNESS
        if material.toon or not (metal or mapped or material.roughness < MAX_MIRROR_ROUGHNESS):
            return None
        return 0.0 if mapped else material.roughness, material.roughness

    def render(
        self, context: moderngl.Context, array: moderngl.VertexArray, both_sides: bool = False
    ) -> None:
        """Draw the triangles with the program of an array, which must fit the features.

        `both_sides` draws those of one side from behind too.
        """
        material = self.material
        set_uniforms(
            array.program,
            base_color=material.base_color[:3],
            metallic=material.metallic,
            roughness=material.roughness,
        )
        if self.features:
            set_uniforms(
                array.program,
                opacity=material.base_color[3],
                cutoff=material.alpha_cutoff or 0.0,
                bump_scale=material.normal_scale,
                glow=material.emissive,
                occlusion_strength=material.occlusion_strength,
                screen_layer=self.screen_layer,
            )
        set_uniforms(array.program, two_sided=material.double_sided)
        if material.toon is not None:
            set_uniforms(
                array.program,
                shade_color=material.toon.color,
                shade_shift=material.toon.shift,
                toony=material.toon.toony,
                evenness=material.toon.evenness,
            )
        if self.face is not None:
            set_uniforms(array.program, **self.face.uniforms)
        for unit, texture in self.textures:
            texture.use(unit)
        culled = not (both_sides or material.double_sided)
        (context.enable if culled else context.disable)(moderngl.CULL_FACE)
        array.render(vertices=self.count, first=self.first)


class SurfaceBuffers:
    """Creates and owns what the surfaces of one character are drawn with.

    `skinned` has the position and normal of each vertex in the table frame, 3 + 3 float32; `colors`
    linear RGBA and texture coordinates, 4 + 2 float32; `indices` three for each triangle.
    """

    def __init__(
        self,
        context: moderngl.Context,
        programs: ShaderPrograms,
        skinned: moderngl.Buffer,
        colors: moderngl.Buffer,
        indices: moderngl.Buffer,
    ) -> None:
        self._context = context
        self._programs = programs
        self._skinned, self._colors, self._indices = skinned, colors, indices
        self._arrays: dict[frozenset[str], moderngl.VertexArray] = {}
        self._textures: dict[tuple[int, bool], moderngl.Texture] = {}

    def surfaces(
        self, materials: Sequence[tuple[Material, int]], first: int
    ) -> tuple[Surface, ...]:
        """Return a surface for each material, with its number of indices, from one index on."""
        surfaces: list[Surface] = []
        for material, count in materials:
            features = surface_features(material)
            textures = tuple(
                (unit, self._texture(image, srgb=unit in _COLOR_UNITS))
                for unit, image in enumerate(material.textures)
                if image is not None
            )
            layer = sum(BLENDED in each.features for each in surfaces)
            surfaces.append(Surface(first, count, material, features, layer, textures))
            first += count
        return tuple(surfaces)

    def with_faces(
        self,
        surfaces: Sequence[Surface],
        splits: Sequence[FaceSplit],
        face: FaceTexture,
        start: int,
    ) -> tuple[Surface, ...]:
        """Return surfaces of which the triangles of `splits` are drawn with a face.

        The splits count indices from the first of the surfaces, `start`.
        """
        drawn: list[Surface] = []
        for number, surface in enumerate(surfaces):
            split = next((each for each in splits if each.run == number), None)
            if split is None or not split.painted:
                drawn.append(surface)
                continue
            if split.plain:
                drawn.append(replace(surface, first=start + split.first, count=split.plain))
            drawn.append(
                replace(
                    surface,
                    first=start + split.first + split.plain,
                    count=split.painted,
                    features=surface.features | {FACE_FEATURE},
                    textures=(*surface.textures, (TEXTURE_UNITS["face_map"], face.texture)),
                    face=face,
                )
            )
        return tuple(drawn)

    def release(self) -> None:
        """Release the arrays and textures; a second call does nothing."""
        for array in self._arrays.values():
            array.release()
        for texture in self._textures.values():
            texture.release()

    def array(self, features: frozenset[str]) -> moderngl.VertexArray:
        """Return all triangles with the program for some features."""
        if features not in self._arrays:
            program = surface_program(self._programs, features)
            # The compiler leaves out attributes that a surface does not use.
            content: list[tuple[object, ...]] = [(self._skinned, "3f 12x", "position")]
            if "normal" in program:
                content = [(self._skinned, "3f 3f", "position", "normal")]
            used = [name for name in ("color", "uv") if name in program]
            if used:
                color, uv = "4f" if "color" in used else "16x", "2f" if "uv" in used else "8x"
                content.append((self._colors, f"{color} {uv}", *used))
            self._arrays[features] = self._context.vertex_array(program, content, self._indices)
        return self._arrays[features]

    def _texture(self, image: NDArray[np.uint8], srgb: bool) -> moderngl.Texture:
        """Return an image as a texture; one that several materials share is uploaded once."""
        key = id(image), srgb
        if key not in self._textures:
            texture = self._upload(image, GL_SRGB8_ALPHA8 if srgb else None)
            texture.build_mipmaps()
            texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
            self._textures[key] = texture
        return self._textures[key]

    def _upload(self, image: NDArray[np.uint8], internal_format: int | None) -> moderngl.Texture:
        limit = int(self._context.info["GL_MAX_TEXTURE_SIZE"])
        height, width = image.shape[:2]
        if max(height, width) > limit:
            scale = limit / max(height, width)
            width, height = max(int(width * scale), 1), max(int(height * scale), 1)
            image = np.asarray(
                cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA), np.uint8
            )
        if image.shape[2] == 3:  # four bytes per texel are read faster, and need no padding
            image = np.asarray(cv2.cvtColor(image, cv2.COLOR_RGB2RGBA), np.uint8)
        pixels = np.ascontiguousarray(image)
        if internal_format is None:
            return self._context.texture((width, height), 4, pixels)
        return self._context.texture((width, height), 4, pixels, internal_format=internal_format)


def surface_features(material: Material) -> frozenset[str]:
    """Return what a material has beyond one colour, one roughness and one metalness.

    TEXTURED: a texture of the base colour; SURFACE: one of roughness and metalness; BUMPS: a normal
    map; GLOW: emitted light; GLOW_MAP: a texture of it; OCCLUSION: one of what arrives of the light
    from all around; CUTOFF: holes where alpha is low; BLENDED: partly transparent instead, where
    that can be drawn; TOON: MToon's shading; SHADE: its texture; SKIN: light spreads below it. The
    shaders test these.

    >>> sorted(surface_features(Material(emissive=(0.0, 0.2, 0.0), alpha_cutoff=0.5)))
    ['CUTOFF', 'GLOW']
    """
    has = {
        "TEXTURED": material.base_color_texture is not None,
        "SURFACE": material.metallic_roughness_texture is not None and material.toon is None,
        "BUMPS": material.normal_texture is not None and material.normal_scale != 0.0,
        "GLOW": any(material.emissive),
        "GLOW_MAP": any(material.emissive) and material.emissive_texture is not None,
        "OCCLUSION": material.occlusion_texture is not None and material.toon is None,
        "CUTOFF": material.alpha_cutoff is not None,
        BLENDED: material.blended and material.alpha_cutoff is not None,
        "TOON": material.toon is not None,
        SKIN_FEATURE: material.scattering > 0.0 and material.toon is None,
        "SHADE": material.toon is not None and material.toon.texture is not None,
    }
    return frozenset(feature for feature, present in has.items() if present)


def surface_program(programs: ShaderPrograms, features: frozenset[str]) -> moderngl.Program:
    """Return the program that shades surfaces with some features.

    Each set of features is a program of its own: software rendering samples a texture even where a
    condition excludes it, and a plain surface must not pay for the features of others.
    """
    if not features & {GEOMETRY, CASTER, BEHIND}:
        features -= {BLENDED}
    if not features & {GEOMETRY, CASTER}:
        features -= {SKIN_FEATURE}
    if VERTEX_LIT in features:
        return programs.load(
            "vertex_lit", "vertex_lit", *sorted(features & {"GLOW", CLIPPED, ROOM})
        )
    mapped = {"MAPPED"} if features & MAPPED_FEATURES else set()
    placed = {"PLACED"} if features & PLACED_FEATURES else set()
    program = programs.load("character", "character", *sorted(features | mapped | placed))
    set_uniforms(program, **TEXTURE_UNITS, room_map=ROOM_UNIT)
    return program
