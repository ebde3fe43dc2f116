"""Check that public docstrings say something: `python -m tools.docstring_check`.

A docstring of three words or fewer ("Its name.", "Close it.") repeats what name and type say. ruff
knows whether a docstring is there, not whether it is empty of sense, so this counts the words.
Fields and constants need none: where the name says all, leave it away.
"""

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]

ROOMS = ("affect", "tracking", "characters", "robot", "app")
"""Folders that are checked."""

MAX_EMPTY_WORDS = 3
"""Docstrings of at most this many words fail."""

# What a name and a type cannot tell, however short: "Top speed [rad/s].", "(joints, 4).",
# "One of `ESTIMATORS`.", '"exposure" or "focus".', "Opacity, 0…1."
FACT = re.compile(r"\[.+\]|\(.+\)|`.+`|\".+\"|\d…\d")
"""A unit, a shape, a range, or the values that are allowed: enough for a field or a property."""


class ShortDocstring(NamedTuple):
    """A docstring that fails."""

    path: Path
    """The file, from the root of the repository."""

    line: int
    """Line in the file, from 1."""

    name: str
    """What it documents, such as "Class.field"."""

    text: str
    """The whole docstring."""


def short_docstrings(source: str, path: Path) -> list[ShortDocstring]:
    """Return the docstrings of a module's public names that say too little."""
    return [
        ShortDocstring(path, line, name, text)
        for line, name, text, is_value in _docstrings(ast.parse(source), path.stem)
        if len(text.split()) <= MAX_EMPTY_WORDS and not (is_value and FACT.search(text))
    ]


def _docstrings(module: ast.Module, stem: str) -> Iterator[tuple[int, str, str, bool]]:
    """Yield line, name, text, and whether it is of a value: a field, a constant, a property."""
    text = ast.get_docstring(module)
    if text is not None:
        yield module.body[0].lineno, stem, text, False
    yield from _inside(module, "")


def _inside(parent: ast.Module | ast.ClassDef, prefix: str) -> Iterator[tuple[int, str, str, bool]]:
    before: ast.stmt | None = None
    for node in parent.body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            if not node.name.startswith("_"):
                text, name = ast.get_docstring(node), prefix + node.name
                if text is not None:
                    yield node.body[0].lineno, name, text, _is_property(node)
                if isinstance(node, ast.ClassDef):
                    yield from _inside(node, name + ".")
        elif (target := _assigned(before)) and not target.startswith("_"):
            match node:
                case ast.Expr(value=ast.Constant(value=str(text))):
                    yield node.lineno, prefix + target, text, True
        before = node


def _is_property(node: ast.stmt) -> bool:
    decorators = getattr(node, "decorator_list", [])
    return any("property" in ast.unparse(each) for each in decorators)


def _assigned(node: ast.stmt | None) -> str:
    match node:
        case ast.AnnAssign(target=target) | ast.Assign(targets=[target]):
            return ast.unparse(target).strip("()").removeprefix("self.")
    return ""


def main() -> None:
    """Print the docstrings that say nothing, and exit with 1 if there are any."""
    found = [
        short
        for room in ROOMS
        for path in sorted((ROOT / room).rglob("*.py"))
        for short in short_docstrings(path.read_text(), path.relative_to(ROOT))
    ]
    for path, line, name, text in found:
        sys.stdout.write(f"{path}:{line}: {name}: {text!r} says nothing\n")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
