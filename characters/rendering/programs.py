"""The shader programs, read from the package and built once for each context."""

import re
from collections.abc import Sequence
from importlib.resources import files

import moderngl
import numpy as np

from cubeling.characters.skeleton.pose import Array

SHADER_FOLDER = files("cubeling.characters.rendering") / "shaders"


class ShaderPrograms:
    """Builds programs from the files in `shaders/`, each when it is first asked for."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._programs: dict[tuple[str, ...], moderngl.Program] = {}

    def load(self, vertex: str, fragment: str, *defines: str) -> moderngl.Program:
        """Return the program of `VERTEX.vert.glsl` and `FRAGMENT.frag.glsl`.

        `defines` are preprocessor names that are defined in both.
        """
        key = (vertex, fragment, *defines)
        if key not in self._programs:
            self._programs[key] = self._context.program(
                vertex_shader=_source(f"{vertex}.vert", *defines),
                fragment_shader=_source(f"{fragment}.frag", *defines),
            )
        return self._programs[key]

    def load_transform(self, vertex: str, *varyings: str) -> moderngl.Program:
        """Return a program that only writes vertex attributes back (transform feedback)."""
        key = (vertex, *varyings)
        if key not in self._programs:
            self._programs[key] = self._context.program(
                vertex_shader=_source(f"{vertex}.vert"), varyings=varyings
            )
        return self._programs[key]

    @property
    def built(self) -> tuple[moderngl.Program, ...]:
        """All programs built so far."""
        return tuple(self._programs.values())

    def release(self) -> None:
        """Release the programs; a second call does nothing."""
        for program in self.built:
            program.release()


def _source(name: str, *defines: str) -> str:
    """Return the text of a shader with preprocessor names defined after its version line.

    A line `#include "name"` is replaced by the text of that file; GLSL itself has no include.
    """
    version, text = _text(name).split("\n", 1)
    return "\n".join([version, *(f"#define {define}" for define in defines), text])


def _text(name: str) -> str:
    text = (SHADER_FOLDER / f"{name}.glsl").read_text(encoding="utf-8")
    return re.sub(r'^#include "([\w.]+)"$', lambda match: _text(match[1]), text, flags=re.MULTILINE)


def set_uniforms(
    program: moderngl.Program, **values: "bool | float | Sequence[float] | Array"
) -> None:
    """Set uniforms of a program by name.

    Arrays are written as float32 in row-major order, except that 4×4 matrices are transposed to
    GLSL's column-major order. Uniforms that the driver optimised away are ignored.
    """
    for name, value in values.items():
        uniform = program.get(name, None)
        if not isinstance(uniform, moderngl.Uniform):
            continue
        if isinstance(value, np.ndarray):
            rows = value.T if value.shape == (4, 4) else value
            uniform.write(np.ascontiguousarray(rows, np.float32))
        else:
            uniform.value = value
