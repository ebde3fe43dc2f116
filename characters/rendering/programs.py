"""The shaders, read from the package and built once a context."""

import re
from collections.abc import Sequence
from importlib.resources import files

import moderngl
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SHADERS = files("characters.rendering") / "shaders"


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
        self.plain = build("character.vert", "character.frag")
        """Vertices to colour, without a texture."""
        self.textured = build("character.vert", "character.frag", "TEXTURED")
        """Vertices to colour, with one. A program of its own: drivers on the processor take a
        sample even where a condition says no."""
        self.over = build("screen.vert", "over.frag")
        """Figures onto the ground."""
        self.copy = build("copy.vert", "copy.frag")
        """A finished part of the picture into a window."""

    def release(self) -> None:
        """Give the programs back; a second call does nothing."""
        for program in vars(self).values():
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
