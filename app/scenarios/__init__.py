"""The bundled scenarios, one file each, and what a scenario of one's own is made of."""

from app.pipeline.registry import (
    ENTRY_POINT_GROUP,
    SCENARIOS,
    find_scenario,
    make_scenario,
    scenario_cube,
    scenario_names,
)
from app.pipeline.scenario import EmotionTarget, Inputs, Outcome, Scenario, ScenarioSettings
from app.scenarios.companion import Companion
from app.scenarios.follow import Follow
from app.scenarios.mood import MoodController
from app.scenarios.presence import Presence
from app.scenarios.reach import Reach
from app.scenarios.sketch import Sketch

_BUNDLED: tuple[type[Scenario], ...] = (Follow, Sketch, Companion, Reach)
SCENARIOS |= {scenario.name: scenario for scenario in _BUNDLED}

__all__ = [
    "ENTRY_POINT_GROUP",
    "SCENARIOS",
    "Companion",
    "EmotionTarget",
    "Follow",
    "Inputs",
    "MoodController",
    "Outcome",
    "Presence",
    "Reach",
    "Scenario",
    "ScenarioSettings",
    "Sketch",
    "find_scenario",
    "make_scenario",
    "scenario_cube",
    "scenario_names",
]
