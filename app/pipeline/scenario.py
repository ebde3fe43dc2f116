"""What every scenario is, and the table of those there are."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

from affect import Emotion, Personality
from app.errors import AppError
from characters import CharacterCommand, PosedCharacter, RootDelta
from characters.rendering import FloorPath
from tracking import CubeControls, CubeModel


@dataclass(frozen=True)
class Inputs:
    """What enters a frame beside the camera's picture."""

    clear: bool = False
    """Whether the player asked to start over: forget the path, the mood …"""

    actions: tuple[str, ...] = ()
    """What the character on the table can be asked to do beside walking."""


@dataclass(frozen=True)
class EmotionTarget:
    """The emotion that character, virtual robot and robot show."""

    emotion: Emotion
    """The emotion, with a word of the personality's label set."""

    timestamp: float
    """Time of the frame [s]."""


@dataclass(frozen=True)
class Outcome:
    """What a scenario wants of one frame."""

    command: CharacterCommand
    """To the animator."""

    emotion: EmotionTarget
    """To the robot; face and bearing of the character show it too."""

    hint: str
    """One short sentence for the player: what to do now."""

    icon: str = "idle"
    """Name of the icon that stands for what is going on."""

    floor: tuple[FloorPath, ...] = field(default=())
    """What is painted on the table."""


class Scenario(Protocol):
    """A way to play. Its state advances by `update`, once a frame; it reads no clock."""

    name: str
    """How it is called on the command line."""

    cube: str
    """Name of the cube that it is made for."""

    character: str
    """Name of the bundled character that plays it."""

    personality: str
    """Name of the bundled personality that it is played with."""

    start: RootDelta
    """Where the character first stands on the table [m], and which way it looks [rad]."""

    def update(
        self, controls: CubeControls, character: PosedCharacter | None, inputs: Inputs
    ) -> Outcome:
        """Decide on one frame.

        Parameters
        ----------
        controls
            What the hand does with the cube in this frame.
        character
            The character as it stood after the frame before, None in the first.
        inputs
            What else the player asked for.
        """
        ...


SPEED_MAPS = ("corrected", "legacy")
"""Names of AvatAR's Speed maps: corrected, and as printed in the thesis."""


@dataclass(frozen=True)
class ScenarioSettings:
    """What a person may choose about a scenario.

    Raises
    ------
    AppError
        There is no speed map of that name, or `turns` is not positive.
    """

    speed_map: str = "corrected"
    """One of `SPEED_MAPS`."""

    turns: float = 2.0
    """Full turns of the cube from the least to the greatest intensity."""

    personality: Personality | None = None
    """Who feels; None for the scenario's own."""

    def __post_init__(self) -> None:
        if self.speed_map not in SPEED_MAPS:
            raise AppError(
                f"no speed map is called '{self.speed_map}': choose one of {', '.join(SPEED_MAPS)}"
            )
        if not 0.1 <= self.turns <= 20:
            raise AppError(f"the turns from end to end must be from 0.1 to 20, not {self.turns:g}")


@dataclass(frozen=True)
class ScenarioKind:
    """A scenario as it is registered."""

    cube: str
    """Name of the bundled cube that it is made for."""

    make: Callable[[CubeModel, ScenarioSettings], Scenario]
    """Makes it for the cube in the player's hand."""


SCENARIOS: dict[str, ScenarioKind] = {}
"""The scenarios by name; `app.scenarios` registers those that come with the program."""


def scenario_cube(name: str) -> str:
    """Return the name of the bundled cube that a scenario is made for."""
    if name not in SCENARIOS:
        raise AppError(f"no scenario is called '{name}': choose one of {', '.join(SCENARIOS)}")
    return SCENARIOS[name].cube


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
        One of `SCENARIOS`.
    cube
        The cube in the player's hand; the scenario's own bundled one where it is None.
    speed_map, turns
        See `ScenarioSettings`.
    personality
        A bundled personality or the .toml file of one; the scenario's own where it is None.

    Raises
    ------
    AppError
        There is no scenario of that name, or a setting is wrong.
    AffectError
        The personality is not there or not usable.
    """
    who = None if personality is None else Personality.load(personality)
    settings = ScenarioSettings(speed_map, turns, who)
    model = cube or CubeModel.load(scenario_cube(name))
    return SCENARIOS[name].make(model, settings)
