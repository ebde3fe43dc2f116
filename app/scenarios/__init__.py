"""The ways to play, one file each; a new one is registered here."""

from app.pipeline.scenario import SCENARIOS, Scenario, make_scenario, scenario_cube
from app.scenarios.companion import Companion
from app.scenarios.follow import Follow
from app.scenarios.sketch import Sketch

_BUNDLED: tuple[type[Scenario], ...] = (Follow, Sketch, Companion)
SCENARIOS |= {scenario.name: scenario for scenario in _BUNDLED}

__all__ = ["SCENARIOS", "Companion", "Follow", "Sketch", "make_scenario", "scenario_cube"]
