"""The bundled scenarios, one file each, and what a scenario of one's own is made of."""

from cubeling.app.pipeline.registry import (
    ENTRY_POINT_GROUP,
    SCENARIOS,
    find_scenario,
    make_scenario,
    scenario_cube,
    scenario_names,
)
from cubeling.app.pipeline.scenario import (
    EmotionTarget,
    Inputs,
    Outcome,
    Scenario,
    ScenarioSettings,
)
from cubeling.app.scenarios.companion import Companion
from cubeling.app.scenarios.follow import Follow
from cubeling.app.scenarios.mood import MoodController
from cubeling.app.scenarios.presence import Presence
from cubeling.app.scenarios.reach import Reach
from cubeling.app.scenarios.sketch import Sketch

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
