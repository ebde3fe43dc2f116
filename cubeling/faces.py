"""The face of a room: the names that a package exports, each loaded when it is asked for.

A face stands in the package's `__init__.pyi`, one import for each name. Type checkers, editors and
pdoc read it as the types of the package; at run time `face` reads the same lines, so the two cannot
part. A program that takes one name from a room loads what that name needs and not the whole room.
"""

import ast
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any


def face(package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return `__getattr__`, `__dir__` and `__all__` for a package with an `__init__.pyi`.

    Parameters
    ----------
    package
        Its `__name__`.

    Raises
    ------
    ModuleNotFoundError, AttributeError
        By `__getattr__`: a name that stands in the face is not where the face says.
    """
    module = sys.modules[package]
    stub = ast.parse(Path(str(module.__file__)).with_suffix(".pyi").read_text(encoding="utf-8"))
    origins = {
        alias.name: str(line.module)
        for line in stub.body
        if isinstance(line, ast.ImportFrom)
        for alias in line.names
    }

    def load(name: str) -> Any:
        if name not in origins:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        origin = import_module(origins[name])
        if not hasattr(origin, name):  # the name of a module, such as `rotations`
            import_module(f"{origins[name]}.{name}")
        value = getattr(origin, name)
        setattr(module, name, value)  # the next time Python finds it without asking
        return value

    names = sorted(origins)
    return load, lambda: sorted({*vars(module), *names}), names
