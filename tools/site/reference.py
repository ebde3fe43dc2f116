"""The public names of all rooms, by pdoc: one page for each face."""

import ast
import warnings
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

from tools.package_links import ROOMS, ROOT
from tools.site.highlighting import code_colours

DESIGN = Path(__file__).parent / "pdoc"


def faces() -> list[str]:
    """Return the packages that others enter: those whose names stand in an `__init__.pyi`."""
    stubs = sorted(stub for room in ROOMS for stub in (ROOT / room).rglob("__init__.pyi"))
    return [".".join(("cubeling", *stub.parent.relative_to(ROOT).parts)) for stub in stubs]


def make_reference(folder: Path) -> tuple[int, list[str]]:
    """Write the reference; return how many public names there are, and those that it lacks."""
    import pdoc.render

    entered = {name: import_module(name) for name in faces()}
    exported = {
        f"{name}.{each}": getattr(package, each)  # a face loads a name when it is asked for
        for name, package in entered.items()
        for each in package.__all__
    }
    modules = [each.__name__ for each in exported.values() if isinstance(each, ModuleType)]
    with TemporaryDirectory() as design, warnings.catch_warnings():
        # Names that are imported for type checkers alone: pdoc writes them as they stand.
        warnings.filterwarnings("ignore", "Error parsing type annotation")
        for file in DESIGN.iterdir():
            (Path(design) / file.name).write_bytes(file.read_bytes())
        (Path(design) / "syntax-highlighting.css").write_text(code_colours(".pdoc-code"))
        pdoc.render.configure(docformat="numpy", show_source=False, template_directory=Path(design))
        pages = {
            name: pdoc.doc.Module.from_name(name) for name in dict.fromkeys([*entered, *modules])
        }
        for page in pages.values():
            _describe_constants(page)
        for name, page in pages.items():
            file = folder / f"{name.replace('.', '/')}.html"
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(pdoc.render.html_module(page, pages), "utf-8")
        (folder / "index.html").write_text(pdoc.render.html_index(pages), "utf-8")
        (folder / "search.js").write_text(pdoc.render.search_index(pages), "utf-8")
    return len(exported), [
        name for name, value in exported.items() if not _is_in(pages, name, value)
    ]


def _describe_constants(page: Any) -> None:
    """Give the constants of a face their docstrings, which stand where they are defined."""
    import pdoc.doc

    stub = Path(page.obj.__file__).with_suffix(".pyi")
    origins = {
        alias.name: line.module
        for line in (ast.parse(stub.read_text("utf-8")).body if stub.exists() else ())
        if isinstance(line, ast.ImportFrom)
        for alias in line.names
    }
    for member in page.members.values():
        if isinstance(member, pdoc.doc.Variable) and not member.docstring:
            origin = pdoc.doc.Module.from_name(str(origins.get(member.name, page.modulename)))
            member.docstring = origin._var_docstrings.get(member.name, "")


def _is_in(pages: dict[str, Any], name: str, value: object) -> bool:
    if isinstance(value, ModuleType):
        return value.__name__ in pages
    face, _, member = name.rpartition(".")
    return member in pages[face].members
