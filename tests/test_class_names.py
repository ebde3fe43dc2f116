"""A name of a public class means one class, in whichever room a reader meets it."""

import ast
from collections import defaultdict
from pathlib import Path

import pytest

from tools.package_links import ROOMS

ROOT = Path(__file__).parent.parent


@pytest.mark.slow(reason="all modules are parsed")
def test_no_two_public_classes_have_one_name():
    places = defaultdict(list)
    for room in ROOMS:
        for path in (ROOT / room).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text())):
                if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                    places[node.name].append(str(path.relative_to(ROOT)))
    assert {name: paths for name, paths in places.items() if len(paths) > 1} == {}
