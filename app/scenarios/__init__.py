"""The ways to play, a file each; a new one is registered here."""

from app.pipeline.scenario import SCENARIOS, ScenarioKind, make_scenario, scenario_cube
from app.scenarios.companion import Companion
from app.scenarios.follow import Follow
from app.scenarios.sketch import Sketch

SCENARIOS |= {
    "follow": ScenarioKind(Follow.cube, lambda _, s: Follow(s.speed_map, s.personality)),
    "sketch": ScenarioKind(Sketch.cube, lambda _, s: Sketch(s.speed_map, s.personality)),
    "companion": ScenarioKind(
        Companion.cube, lambda cube, s: Companion(cube, s.turns, s.personality)
    ),
}

__all__ = ["SCENARIOS", "Companion", "Follow", "Sketch", "make_scenario", "scenario_cube"]
