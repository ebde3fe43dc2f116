"""The shaders, read from the package and built once a context."""

import re
from collections.abc import Sequence
from importlib.resources import files

import moderngl
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SHADERS = files("characters.rendering") / "shaders"

LOOKS = ("TEXTURED", "SURFACE", "BUMPS", "GLOW", "CUTOFF")
"""What a surface may have beyond one colour, one roughness and one metalness: a texture of the base
colour, one of roughness and metalness, a normal map, light of its own, holes."""


class Programs:
    """Every program of the picture.

    Parameters
    ----------
    context
        Where they are built.
    """

    def __init__(self, context: moderngl.Context) -> None:
        def build(vertex: str, fragment: str, *defines: str) -> moderngl.Program:
            return context.program(
                vertex_shader=_source(vertex, *defines), fragment_shader=_source(fragment, *defines)
            )

        self.skin = context.program(
            vertex_shader=_source("skin.vert"), varyings=("skinned_position", "skinned_normal")
        )
        """Joint matrices and bind pose to vertices in the table frame."""
        self.caster = build("caster.vert", "caster.frag")
        """Vertices to what they keep from the table, sorted by height."""
        self.blur = build("screen.vert", "blur.frag")
        """Softens each height as far as a lamp of some width would."""
        self.keep = build("screen.vert", "keep.frag")
        """The softened map to what is left of the light."""
        self.box = build("box.vert", "nothing.frag")
        """Depth of a real cube."""
        self.marks = build("marks.vert", "marks.frag")
        """Discs and dashes on the table."""
        self.shadow = build("shadow.vert", "shadow.frag")
        """What is left of the light onto the table."""
        self.over = build("screen.vert", "over.frag")
        """Figures onto the ground."""
        self.copy = build("copy.vert", "copy.frag")
        """A finished part of the picture into a window."""
        self._build = build
        self._figures: dict[frozenset[str], moderngl.Program] = {}

    def figure(self, looks: frozenset[str]) -> moderngl.Program:
        """Return vertices to colour for surfaces with some of `LOOKS`, built when first asked for.

        Each set of looks is a program of its own: drivers on the processor take a sample even where
        a condition says no, and a surface without looks is to cost nothing for those of others.
        """
        if looks not in self._figures:
            mapped = {"MAPPED"} if looks & {"TEXTURED", "SURFACE", "BUMPS"} else set()
            program = self._build("character.vert", "character.frag", *sorted(looks | mapped))
            assign(program, base_texture=0, surface_map=1, bump_map=2)
            self._figures[looks] = program
        return self._figures[looks]

    @property
    def every(self) -> tuple[moderngl.Program, ...]:
        """All that were built so far."""
        programs = (owned for owned in vars(self).values() if isinstance(owned, moderngl.Program))
        return (*programs, *self._figures.values())

    def release(self) -> None:
        """Give the programs back; a second call does nothing."""
        for program in self.every:
            program.release()


def _source(name: str, *defines: str) -> str:
    """Return the text of a shader, with some names defined after its version line.

    A line `#include "name"` is replaced by the text of that file; GLSL itself has none.
    """
    version, text = _text(name).split("\n", 1)
    text = re.sub(r'^#include "([\w.]+)"$', lambda found: _text(found[1]), text, flags=re.MULTILINE)
    return "\n".join([version, *(f"#define {define}" for define in defines), text])


def _text(name: str) -> str:
    return (SHADERS / f"{name}.glsl").read_text(encoding="utf-8")


def assign(program: moderngl.Program, **values: "bool | float | Sequence[float] | Array") -> None:
    """Set uniforms of a program by name.

    Arrays are written as float32 as they lie in memory, but for 4×4 matrices, which GLSL takes
    column by column. A uniform that the driver removed, for no result needs it, is passed over.
    """
    for name, value in values.items():
        uniform = program.get(name, None)
        if not isinstance(uniform, moderngl.Uniform):
            continue
        if isinstance(value, np.ndarray):
            lying = value.T if value.shape == (4, 4) else value
            uniform.write(np.ascontiguousarray(lying, np.float32))
        else:
            uniform.value = value
