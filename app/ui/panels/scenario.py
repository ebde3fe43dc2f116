"""The settings of the scenario, which can be changed while it is played."""

from collections.abc import Callable
from functools import cache

from cubeling.affect import bundled_names
from cubeling.app.pipeline.choices import LOOK_CHOICES, SPEED_MAP_NAMES
from cubeling.app.scenarios import find_scenario
from cubeling.app.session import SessionOptions
from cubeling.app.ui.panels.content import Choice, Fact, Note, Panel, Slider, Widget
from cubeling.app.ui.panels.monitor import SessionMonitor

PERSONALITIES = bundled_names()
"""The personalities that can be chosen, besides the user's own."""

MIN_TURNS, MAX_TURNS = 0.5, 6.0
"""Range of the slider for the turns from the least to the greatest intensity."""


def content(monitor: SessionMonitor) -> tuple[Widget, ...]:
    """Return the settings that the scenario has."""
    options = monitor.options
    free = not monitor.fixed
    widgets: list[Widget] = [Fact("Scenario", options.scenario)]
    for setting in (*_adjustable(options.scenario), "look"):
        widgets.append(_WIDGETS[setting](options, free))
    if not free:
        widgets.append(Note("A recording holds one setting: it is fixed until the session ends."))
    return tuple(widgets)


@cache
def _adjustable(scenario: str) -> tuple[str, ...]:
    """Return the settings that a scenario reads; it takes milliseconds to find it by its name."""
    return tuple(getattr(find_scenario(scenario), "adjustable", ()))


@cache
def _own_personality(scenario: str) -> str:
    """Return the personality that plays a scenario if the user chooses no other."""
    return find_scenario(scenario).personality


def _turns(options: SessionOptions, free: bool) -> Widget:
    return Slider("turns", "Turns from end to end", options.turns, MIN_TURNS, MAX_TURNS, free)


def _speed_map(options: SessionOptions, free: bool) -> Widget:
    return Choice("speed_map", "Speed map", options.speed_map, SPEED_MAP_NAMES, free)


def _personality(options: SessionOptions, free: bool) -> Widget:
    present = options.personality or _own_personality(options.scenario)
    choices = tuple(dict.fromkeys((*PERSONALITIES, present)))
    return Choice("personality", "Personality", present, choices, free)


def _look(options: SessionOptions, free: bool) -> Widget:
    return Choice("look", "Eyes follow", options.look, LOOK_CHOICES, free)


_WIDGETS: dict[str, Callable[[SessionOptions, bool], Widget]] = {
    "turns": _turns,
    "speed_map": _speed_map,
    "personality": _personality,
    "look": _look,
}
"""How each setting is changed."""

SCENARIO = Panel("scenario", "Scenario", 296.0, content)
