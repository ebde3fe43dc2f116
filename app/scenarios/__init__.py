"""The ways to play, by name."""

from collections.abc import Callable

from app.errors import AppError
from app.scenarios.attention import LOOKS, Attention
from app.scenarios.base import EmotionTarget, Inputs, Outcome, Scenario
from app.scenarios.companion import Companion
from app.scenarios.follow import Follow
from app.scenarios.sketch import Sketch
from app.scenarios.speed import MAPS
from robot import Personality
from tracking import CubeModel

__all__ = [
    "CUBES",
    "LOOKS",
    "Attention",
    "Companion",
    "EmotionTarget",
    "Follow",
    "Inputs",
    "Outcome",
    "Scenario",
    "Sketch",
    "make_scenario",
    "scenario_cube",
]

CUBES: dict[str, str] = {
    "follow": Follow.cube,
    "sketch": Sketch.cube,
    "companion": Companion.cube,
}
"""Every scenario with the bundled cube that it is made for."""


def scenario_cube(name: str) -> str:
    """Return the name of the bundled cube that a scenario is made for."""
    if name not in CUBES:
        raise AppError(f"no scenario is called '{name}': choose one of {', '.join(CUBES)}")
    return CUBES[name]


def make_scenario(
    name: str,
    cube: CubeModel | None = None,
    *,
    speed_map: str = "corrected",
    turns: float = 2.0,
    personality: str | None = None,
) -> Scenario:
    """Make a scenario by name.

    Parameters
    ----------
    name
        "follow", "sketch" or "companion".
    cube
        The cube in the player's hand; the scenario's own bundled one where it is None.
    speed_map
        "corrected", or "legacy" for the map as printed in the thesis.
    turns
        Full turns from the least to the greatest intensity.
    personality
        A bundled personality or the .toml file of one; the scenario's own where it is None.

    Raises
    ------
    AppError
        There is no scenario, or no speed map, of that name; or `turns` is not positive.
    RobotError
        The personality is not there or not usable.
    """
    if speed_map not in MAPS:
        raise AppError(f"no speed map is called '{speed_map}': choose one of {', '.join(MAPS)}")
    if not 0.1 <= turns <= 20:
        raise AppError(f"the turns from end to end must be from 0.1 to 20, not {turns:g}")
    model = cube or CubeModel.load(scenario_cube(name))
    who = None if personality is None else Personality.load(personality)
    makers: dict[str, Callable[[], Scenario]] = {
        "follow": lambda: Follow(speed_map, who),
        "sketch": lambda: Sketch(speed_map, who),
        "companion": lambda: Companion(model, turns, who),
    }
    return makers[name]()
