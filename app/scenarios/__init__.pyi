from cubeling.app.pipeline.registry import (
    ENTRY_POINT_GROUP as ENTRY_POINT_GROUP,
    SCENARIOS as SCENARIOS,
    check_scenario as check_scenario,
    find_scenario as find_scenario,
    make_scenario as make_scenario,
    scenario_cube as scenario_cube,
    scenario_names as scenario_names,
    scenario_summary as scenario_summary,
)
from cubeling.app.pipeline.scenario import (
    EmotionTarget as EmotionTarget,
    Inputs as Inputs,
    Outcome as Outcome,
    Scenario as Scenario,
    ScenarioSettings as ScenarioSettings,
)
from cubeling.app.pipeline.table.acts import Act as Act
from cubeling.app.pipeline.table.situation import Situation as Situation
from cubeling.app.scenarios.companion import Companion as Companion
from cubeling.app.scenarios.follow import Follow as Follow
from cubeling.app.scenarios.mood import MoodController as MoodController
from cubeling.app.scenarios.presence import Presence as Presence
from cubeling.app.scenarios.reach.scenario import Reach as Reach
from cubeling.app.scenarios.sketch import Sketch as Sketch
