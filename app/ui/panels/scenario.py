"""The settings of the scenario, which can be changed while it is played."""

from affect.personality_file import bundled
from app.pipeline.attention import LOOK_CHOICES
from app.pipeline.scenario import SPEED_MAP_NAMES
from app.scenarios import find_scenario
from app.session import SessionOptions
from app.ui.panels.content import Choice, Fact, Note, Panel, Slider, Widget
from app.ui.panels.monitor import SessionMonitor

MIN_TURNS, MAX_TURNS = 0.5, 6.0
"""Range of the slider for the turns from the least to the greatest intensity."""


def content(monitor: SessionMonitor) -> tuple[Widget, ...]:
    """Return the settings that the scenario has."""
    options = monitor.options
    scenario = find_scenario(options.scenario)
    free = not monitor.fixed
    widgets: list[Widget] = [Fact("Scenario", options.scenario)]
    for setting in (*getattr(scenario, "adjustable", ()), "look"):
        widgets.append(_WIDGETS[setting](options, free))
    if not free:
        widgets.append(Note("A recording holds one setting: it is fixed until the session ends."))
    return tuple(widgets)


def _turns(options: SessionOptions, free: bool) -> Widget:
    return Slider("turns", "Turns from end to end", options.turns, MIN_TURNS, MAX_TURNS, free)


def _speed_map(options: SessionOptions, free: bool) -> Widget:
    return Choice("speed_map", "Speed map", options.speed_map, SPEED_MAP_NAMES, free)


def _personality(options: SessionOptions, free: bool) -> Widget:
    own = find_scenario(options.scenario).personality
    present = options.personality or own
    choices = tuple(dict.fromkeys((*bundled(), present)))
    return Choice("personality", "Personality", present, choices, free)


def _look(options: SessionOptions, free: bool) -> Widget:
    return Choice("look", "Eyes follow", options.look, LOOK_CHOICES, free)


_WIDGETS = {
    "turns": _turns,
    "speed_map": _speed_map,
    "personality": _personality,
    "look": _look,
}
"""How each setting is changed."""

SCENARIO = Panel("scenario", "Scenario", 296.0, content)
