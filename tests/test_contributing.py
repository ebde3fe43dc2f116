"""The recipes of CONTRIBUTING.md, as they stand there: a file, one line of a table, and a test."""

import inspect
import re
import sys
from pathlib import Path
from types import ModuleType

import pytest

from cubeling.app.pipeline.registry import SCENARIOS, SUMMARIES
from cubeling.characters.control.layers import LIVELINESS
from cubeling.robot.contract.driver import DRIVERS
from cubeling.tracking.gestures.detectors import DETECTORS
from tests.app.conftest import Hand

ROOT = Path(__file__).parents[1]

PAGE = (ROOT / "CONTRIBUTING.md").read_text("utf-8")

BLOCKS = re.findall(r"^```python\n# ([^\n]*)\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
"""What the head of each block says of its place, and the block."""

RECIPES = [BLOCKS[first : first + 3] for first in range(0, len(BLOCKS), 3)]

TABLES = {"LIVELINESS": LIVELINESS, "DRIVERS": DRIVERS, "DETECTORS": DETECTORS}


def load(name, source):
    """Return the module of a name, made from its source."""
    module = sys.modules[name] = ModuleType(name)
    exec(compile(source, name, "exec"), vars(module))
    return module


def register(table, line, monkeypatch):
    """Return the registry of a line, and the name and the place that it gives there."""
    ((name, value),) = eval(
        f"{{{line}}}", {"_LAYERS": "cubeling.characters.control.layers"}
    ).items()
    if table == "BUNDLED":
        place = f"cubeling.app.scenarios.{name}"
        name = name.partition(":")[0]
        monkeypatch.setitem(SUMMARIES, name, value)
        return SCENARIOS, name, place
    return TABLES[table], name, value


@pytest.mark.parametrize("recipe", RECIPES, ids=lambda recipe: recipe[1][0].partition(" ")[0])
def test_a_recipe_works_as_it_stands(recipe, monkeypatch):
    (file, source), (table, line), (test_file, test) = recipe
    named, _, table_file = table.partition(" of ")
    assert re.search(rf"^{named}\b", (ROOT / table_file).read_text("utf-8"), re.MULTILINE)
    assert (ROOT / test_file).parent.is_dir()
    registry, name, place = register(named, line, monkeypatch)
    module, _, attribute = place.partition(":")
    assert module == "cubeling." + file.removesuffix(".py").replace("/", ".")
    for each in (module, "recipe_test"):
        monkeypatch.setitem(sys.modules, each, None)  # so that it is removed at the end
    loaded = load(module, source)
    monkeypatch.setitem(registry, name, getattr(loaded, attribute))
    checks = inspect.getmembers(load("recipe_test", test), inspect.isfunction)
    tests = [check for each, check in checks if each.startswith("test_")]
    assert tests
    for check in tests:
        check(**{name: Hand() for name in inspect.signature(check).parameters})


def test_all_tables_of_recipes_are_in_the_page():
    for table in (*TABLES, "BUNDLED", "MOTION_READERS", "GROUPS"):
        assert re.search(rf"`{table}`", PAGE)


def test_every_file_that_the_page_names_is_there():
    named = re.findall(r"`((?:\w+/)+\w+\.(?:py|toml|yml))`", PAGE)
    files = {file for file, _ in BLOCKS}
    missing = [each for each in named if "NAME" not in each and not (ROOT / each).exists()]
    assert named
    assert set(missing) <= files
