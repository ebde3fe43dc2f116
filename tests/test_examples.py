"""The examples in docstrings are true."""

import doctest
import importlib
from pathlib import Path

import pytest

from tools.package_links import ROOMS

ROOT = Path(__file__).parents[1]

MODULES = [
    ("cubeling." if room in ROOMS else "")
    + ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
    for room in (*ROOMS, "cubeling", "tools")
    for path in sorted((ROOT / room).rglob("*.py"))
    if ">>> " in path.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("name", MODULES)
def test_examples_in_docstrings_are_true(name):
    results = doctest.testmod(importlib.import_module(name))
    assert results.attempted
    assert not results.failed
