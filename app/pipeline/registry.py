"""The scenarios by name: the bundled ones, and those that other packages add."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from cubeling.app.errors import AppError
from cubeling.registry import Registry

if TYPE_CHECKING:  # the command line asks for names and summaries, which need neither of these
    from importlib.metadata import EntryPoint

    from cubeling.app.pipeline.scenario import Scenario
    from cubeling.tracking import CubeModel

ENTRY_POINT_GROUP = "cubeling.scenarios"
"""The group in which a package names its scenarios, one entry point each."""

BUNDLED = {
    "follow:Follow": "the character follows the cube; turn the cube to make it walk or run",
    "sketch:Sketch": "the cube draws a path of up to eight points, and the character walks it",
    "companion:Companion": "Vleo kisses or shouts, and changes the robot's mood",
    "reach.scenario:Reach": "the character reaches for the cube, and brings small things to it",
    "talk:Talk": "Vleo talks with you about dinosaurs and feelings: type what you say",
}
"""The bundled scenarios; a new one is registered here. Each is the module in `app.scenarios`, whose
first part gives the scenario its name, with its class; then comes what it is, for the help of the
command line: one sentence without a full stop."""

_PLACES = {re.split("[.:]", place)[0]: place for place in BUNDLED}

SCENARIOS: Registry[type[Scenario]] = Registry(
    {name: f"cubeling.app.scenarios.{place}" for name, place in _PLACES.items()}
)
"""The bundled scenarios by name."""

WAITING = Registry[Callable[..., "Scenario"]]({"waiting": "cubeling.app.scenarios.waiting:Waiting"})
"""What decides for the characters of a cast that no cube leads."""

SUMMARIES = {name: BUNDLED[place] for name, place in _PLACES.items()}
"""What the bundled scenarios are; each class takes its own from here."""


RULES_SUFFIX = ".toml"
"""Ending of a scenario that is a file of rules: see `cubeling.app.scenarios.rules`."""

SCRIPT_SUFFIX = ".xml"
"""Ending of a scenario that is a dialogue: see `cubeling.app.scenarios.dialogue`."""

SHOW_SUFFIX = ".show"
"""Ending of a scenario that is a play: see `cubeling.app.show`."""

BLOCK_SUFFIXES = (".bml", ".fml")
"""Endings of a scenario that is a block, which one character performs: see the same."""

_RULES = "cubeling.app.scenarios.rules"
_SHOW = "cubeling.app.show"
_DIALOGUE = "cubeling.app.scenarios.dialogue.scenario:dialogue_scenario"
CHECKS = Registry[Callable[[str], "Any"]](
    {
        RULES_SUFFIX: f"{_RULES}.file:read_rules",
        SCRIPT_SUFFIX: _DIALOGUE,
        **dict.fromkeys((SHOW_SUFFIX, *BLOCK_SUFFIXES), f"{_SHOW}.script:read_show"),
    }
)
"""What reads a file that is a scenario, by its suffix, to refuse what cannot be played."""

FILES = Registry[Callable[[str], "Any"]](
    {
        RULES_SUFFIX: f"{_RULES}.scenario:rules_scenario",
        SCRIPT_SUFFIX: _DIALOGUE,
        **dict.fromkeys((SHOW_SUFFIX, *BLOCK_SUFFIXES), f"{_SHOW}.scenario:show_scenario"),
    }
)
"""What makes a scenario of it; that of rules loads numpy."""


@cache
def added_scenarios() -> tuple[EntryPoint, ...]:
    """Return the scenarios of other packages; reading the installed ones takes 25 ms, so once."""
    if not _any_added():
        return ()
    from importlib.metadata import entry_points

    return tuple(entry_points(group=ENTRY_POINT_GROUP))


def _any_added() -> bool:
    """Whether an installed package names our group; most often none does, and this takes 2 ms."""
    files = (file for each in sys.path for file in Path(each).glob("*-info/entry_points.txt"))
    try:
        return any(ENTRY_POINT_GROUP.encode() in file.read_bytes() for file in files)
    except OSError:  # one cannot be read: importlib.metadata knows what to do with it
        return True


def scenario_names() -> tuple[str, ...]:
    """Return the names of all scenarios: the bundled ones, then those of other packages."""
    return tuple(dict.fromkeys((*SCENARIOS, *sorted(point.name for point in added_scenarios()))))


def find_scenario(name: str) -> type[Scenario]:
    """Return the class of a scenario, by its name or the path of a file.

    Raises AppError if there is none of that name, if two packages add one, or if the package that
    adds it or the file is broken.
    """
    if (suffix := Path(name).suffix) in FILES:
        return cast("type[Scenario]", FILES[suffix](name))
    point = _entry_point(name)
    return SCENARIOS[name] if point is None else _load(point)


def check_scenario(name: str) -> None:
    """Raise AppError if there is no scenario of a name, or if two packages add one; load none.

    A file is read, which takes milliseconds.
    """
    if (suffix := Path(name).suffix) in CHECKS:
        CHECKS[suffix](name)
    else:
        _entry_point(name)


def scenario_summary(name: str) -> str:
    """Return what a scenario is; only one of another package is loaded for it.

    Raises AppError as `find_scenario` does.
    """
    return SUMMARIES[name] if _entry_point(name) is None else find_scenario(name).summary


def _entry_point(name: str) -> EntryPoint | None:
    """Return where another package has a scenario; None for a bundled one."""
    points = sorted((each for each in added_scenarios() if each.name == name), key=_package)
    packages = [*(["cubeling"] if name in SCENARIOS else []), *map(_package, points)]
    if not packages:
        near = get_close_matches(name, scenario_names(), 1)
        hint = f"; did you mean {near[0]}? Choose" if near else ": choose"
        known = ", ".join(scenario_names())
        raise AppError(
            f"no scenario is called '{name}'{hint} one of {known}, or a .toml file of rules, "
            "or the .xml file of a dialogue"
        )
    if len(packages) > 1:
        raise AppError(
            f"the packages {' and '.join(packages)} each have a scenario '{name}': "
            "uninstall one, or rename its scenario"
        )
    return points[0] if points else None


def _package(point: EntryPoint) -> str:
    return point.dist.name if point.dist is not None else "unknown"


def _load(point: EntryPoint) -> type[Scenario]:
    """Import the scenario of another package, which may fail in any way."""
    from cubeling.app.pipeline.scenario import Scenario

    broken = f"the scenario '{point.name}' of the package '{_package(point)}' cannot be used"
    try:
        scenario: type[Scenario] = point.load()
    except Exception as error:
        raise AppError(f"{broken}: {type(error).__name__}: {error}") from error
    members = (*Scenario.__annotations__, "update")
    missing = [member for member in members if not hasattr(scenario, member)]
    if not isinstance(scenario, type) or missing:
        raise AppError(
            f"{broken}: {point.value} must be a class with {', '.join(missing or members)}"
        )
    if scenario.name != point.name:
        raise AppError(f"{broken}: its class has the name '{scenario.name}'")
    return scenario


def scenario_cube(name: str) -> str:
    """Return the name of the bundled cube that a scenario is made for."""
    return find_scenario(name).cube


def make_scenario(
    name: str,
    cube: CubeModel | None = None,
    *,
    speed_map: str = "corrected",
    turns: float = 2.0,
    personality: str | None = None,
    language: str = "",
    asks_model: bool = False,
) -> Scenario:
    """Make a scenario by name; without a cube and a personality it has its own bundled ones.

    Raises AppError if the scenario cannot be used or a setting is wrong, and AffectError if the
    personality is missing or cannot be used.
    """
    from cubeling.affect import Personality
    from cubeling.app.pipeline.scenario import ScenarioSettings
    from cubeling.app.pipeline.scenario_errors import scenario_errors
    from cubeling.tracking import CubeModel

    loaded = None if personality is None else Personality.load(personality)
    settings = ScenarioSettings(speed_map, turns, loaded, language, asks_model)
    scenario = find_scenario(name)
    model = cube or CubeModel.load(scenario.cube)
    with scenario_errors(scenario):
        return scenario(model, settings)
