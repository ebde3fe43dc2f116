"""Scenarios that other packages add: the page's own example, and packages that are broken."""

import importlib
import re
import sys
from pathlib import Path

import pytest

from cubeling import app
from cubeling.app.pipeline.registry import added_scenarios
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.table.situation import Situation
from cubeling.app.scenarios import make_scenario, scenario_names
from cubeling.app.session import messages, session_info
from cubeling.app.session.encoding import decode
from cubeling.characters import CharacterCommand
from cubeling.toml_file import parse
from tests.app.conftest import load_command_once

PAGE = Path(app.__file__).parents[1] / "docs" / "your-own-scenario.md"
(TOML,) = re.findall(r"```toml\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
(PYTHON,) = re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)

COMMAND = "/character/command"


LISTING = ("play", "play_options", "replay", "demo")
"""Commands whose help lists what is installed when they are loaded."""


@pytest.fixture
def install(tmp_path_factory, monkeypatch):
    """Install a package from the texts of its pyproject.toml and of its one module, as pip does."""

    def install(pyproject, source):
        site = tmp_path_factory.mktemp("site-packages")
        table = parse(pyproject, "pyproject.toml")
        project, (module,) = table["project"], table["tool"]["setuptools"]["py-modules"]
        (site / f"{module}.py").write_text(source, "utf-8")
        info = site / f"{project['name'].replace('-', '_')}-{project['version']}.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(
            f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n"
        )
        lines = [
            line
            for group, points in project["entry-points"].items()
            for line in (f"[{group}]", *(f"{name} = {value}" for name, value in points.items()))
        ]
        (info / "entry_points.txt").write_text("\n".join(lines))
        monkeypatch.syspath_prepend(site)
        monkeypatch.delitem(sys.modules, module, raising=False)
        for command in LISTING:
            monkeypatch.delitem(sys.modules, f"cubeling.app.commands.play.{command}", raising=False)
        importlib.invalidate_caches()
        added_scenarios.cache_clear()
        load_command_once.cache_clear()

    yield install
    added_scenarios.cache_clear()
    load_command_once.cache_clear()
    for module in [name for name in sys.modules if name.startswith("cubeling_")]:
        del sys.modules[module]
    for command in LISTING:
        sys.modules.pop(f"cubeling.app.commands.play.{command}", None)


def test_the_example_of_the_page_waves_and_cheers(install, hand):
    install(TOML, PYTHON)
    assert "greet" in scenario_names()
    greet = make_scenario("greet")

    def action(controls):
        return greet.update(controls, Situation(), Inputs()).command.activity

    assert action(hand.frame()) == "idle"
    assert action(hand.frame(resting=False, lifted=True)) == "wave"
    assert action(hand.frame(resting=True, lifted=False)) == "wave"
    assert [action(controls) for controls in hand.wait(3.0)][-1] == "idle"
    assert action(hand.frame(gestures=("shaken",))) == "cheer"
    assert action(hand.frame(gestures=())) == "cheer"
    assert [action(controls) for controls in hand.wait(3.0)][-1] == "idle"


@pytest.mark.full
@pytest.mark.slow(reason="four seconds are tracked")
def test_the_example_of_the_page_is_listed_and_plays(install, cubeling, lifting_session):
    install(TOML, PYTHON)
    code, out, _ = cubeling("play", "--help")
    assert code == 0
    assert "greet: lift the cube and the character waves" in " ".join(out.split())
    session = ["-s", lifting_session, "--record", "greet.mcap", "--robot", "none"]
    code, _, err = cubeling("play", "greet", *session, "--no-pictures")
    assert (code, err) == (0, "")
    recorded = (
        decode(CharacterCommand, data) for _, _, data in messages(Path("greet.mcap"), COMMAND)
    )
    assert {command.activity for command in recorded} == {"idle", "wave"}


BROKEN = {
    "the module cannot be imported": (TOML, "import nowhere", "No module named 'nowhere'"),
    "no such class": (TOML.replace(":Greet", ":Wave"), PYTHON, "has no attribute 'Wave'"),
    "not a class": (TOML.replace(":Greet", ":ACTION_S"), PYTHON, "must be a class with name"),
    "an attribute is missing": (
        TOML,
        PYTHON.replace("    roles = ()\n", ""),
        "must be a class with roles",
    ),
    "another name": (
        TOML,
        PYTHON.replace('name = "greet"', 'name = "meet"'),
        "its class has the name 'meet'",
    ),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_package_is_one_line_that_names_it(install, cubeling, case):
    pyproject, source, reason = BROKEN[case]
    install(pyproject, source)
    code, _, err = cubeling("play", "greet")
    assert code == 2
    assert err.startswith("cubeling: the scenario 'greet' of the package 'cubeling-greet' cannot")
    assert reason in err
    assert err.count("\n") == 1
    code, out, _ = cubeling("play", "--help")
    assert code == 0, "the other scenarios can still be played"
    assert "cubeling-greet" in out


FAILING = {
    "__init__": ("        self._presence", "        {}['mood']\n", "KeyError: 'mood'"),
    "update": (
        "        now = ",
        "        if controls.lifted:\n            1 / 0\n",
        "ZeroDivisionError: ",
    ),
    "a library": ("        now = ", "        Personality.load('cross')\n", "AffectError: "),
    "no outcome": ("        return Outcome", "        return None\n", "its update returned None"),
}


@pytest.mark.parametrize("case", FAILING)
def test_an_error_of_an_added_scenario_names_its_place_and_keeps_the_recording(
    install, cubeling, lifting_session, case
):
    before, failing, reason = FAILING[case]
    source = PYTHON.replace(before, failing + before, 1)
    install(TOML, source)
    session = ["-s", lifting_session, "--record", "kept.mcap", "--robot", "none"]
    code, out, err = cubeling("play", "greet", *session, "--no-pictures")
    assert code == 2
    assert err.startswith("cubeling: the scenario 'greet' failed in ")
    line = source[: source.index(failing)].count("\n") + failing.count("\n")
    assert f"cubeling_greet.py, line {line}: {reason}" in err or case == "no outcome"
    assert reason in err
    assert err.count("\n") == 1
    if case == "update":
        assert "Recorded to kept.mcap" in out
        assert session_info(Path("kept.mcap")).frames > 20


@pytest.mark.parametrize("name", ["greet", "follow"])
def test_two_scenarios_of_one_name_are_refused(install, cubeling, name):
    pyproject = TOML.replace("greet = ", f"{name} = ")
    install(pyproject, PYTHON)
    install(pyproject.replace("cubeling-greet", "cubeling-other"), PYTHON)
    code, _, err = cubeling("play", name)
    assert code == 2
    assert "cubeling-greet and cubeling-other each have a scenario" in err
    assert ("cubeling and" in err) == (name == "follow")
    assert err.count("\n") == 1


def test_the_demo_has_no_recording_of_an_added_scenario(install, cubeling):
    install(TOML, PYTHON)
    code, _, err = cubeling("demo", "greet")
    assert code == 2
    assert "cubeling play greet --source synthetic:companion" in err
