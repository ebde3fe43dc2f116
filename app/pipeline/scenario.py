"""The interface of a scenario."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from cubeling.affect import Emotion, Personality
from cubeling.app.errors import AppError
from cubeling.app.pipeline.choices import check_speed_map, check_turns
from cubeling.app.pipeline.table.acts import Act
from cubeling.app.pipeline.table.props import Thing
from cubeling.app.pipeline.table.situation import Situation
from cubeling.app.pipeline.table.spoken_line import LEAD, Lines, SpokenLine
from cubeling.app.pipeline.table.stage_sounds import PlayedSound, SoundClip, SoundSource
from cubeling.characters import Character, CharacterCommand, RootDelta, meanings_of
from cubeling.characters.rendering import FloorPath
from cubeling.tracking import CubeControls, CubeModel

# Few scenarios are dialogues: what that takes is loaded for those.
if TYPE_CHECKING:
    from cubeling.characters.behaviour import DialogueScript


@dataclass(frozen=True)
class ModelQuestion:
    """Something said to a character that a language model may have an answer to."""

    number: int
    """Counts the questions of a scenario from 1."""

    text: str
    """What the player has said."""


@dataclass(frozen=True)
class ModelAnswer:
    """What a language model answers."""

    number: int
    """That of the question."""

    text: str
    """What the character says, with tags; "" if there is no answer."""


@dataclass(frozen=True)
class Inputs:
    """What the player asked for in a frame, besides what the cube tells."""

    clear: bool = False
    """Whether the player asked to start over: forget the path, the mood …"""

    scenario: str = ""
    """Name of the scenario that the player asked for, "" for the present one."""

    line: SpokenLine | None = None
    """What the character begins to say in this frame; None for nothing new. With several, the first
    one; a scenario is told of its own character's."""

    inside: bool = False
    """Whether the player asked to open the cube, with the character in it, or to close it."""

    typed: str = ""
    """What the player says to the character: a line that is complete; "" for nothing."""

    hush: bool = False
    """Whether the player interrupts the character, as by beginning to type."""

    answer: ModelAnswer | None = None
    """What a language model has answered; None for nothing new."""

    lines_of_others: Lines = field(default_factory=dict)
    """What the rest of the cast wants to say from this frame on, by their names."""

    acts: tuple[Act, ...] = ()
    """What the characters are told to do by somebody beside the player; a scenario is told of none,
    as each of the cast does it whatever its scenario decides."""

    marks: tuple[str, ...] = ()
    """Names of the marks that others set in this frame, see `Mark.of`: they are recorded as events,
    as those of the player are."""

    sounds: Mapping[str, SoundClip] = field(default_factory=dict)
    """Sounds that the scenario has asked for, by their names; see `Outcome.asked_sounds`."""

    @property
    def lines(self) -> Lines:
        """What all of the cast want to say from this frame on."""
        own = {} if self.line is None else {LEAD: self.line}
        return {**own, **self.lines_of_others}

    def with_lines(self, lines: Lines) -> "Inputs":
        """Return the same with what the cast wants to say."""
        others = {name: line for name, line in lines.items() if name != LEAD}
        return replace(self, line=lines.get(LEAD), lines_of_others=others)

    @property
    def events(self) -> tuple[str, ...]:
        """What happens besides gestures; personalities say what it means to the robot."""
        return () if self.line is None else ("spoken",)


OVER_EVENT = "over"
"""What has happened when a scenario has come to its end."""


@dataclass(frozen=True)
class Reply:
    """Something that a character wants to say: a voice speaks it, and it begins in a later frame.

    It takes the place of what was to be said before.
    """

    text: str
    """What is said; tags name gestures."""

    language: str
    """Code of its language; "" for the one in which the character speaks."""

    is_answer: bool = False
    """Whether a language model has answered it, or it only fills the time until then."""


@dataclass(frozen=True)
class EmotionTarget:
    """The emotion that character, virtual robot and robot show."""

    emotion: Emotion
    """The emotion, with a word of the personality's label set."""

    timestamp: float
    """Time of the frame [s]."""


@dataclass(frozen=True)
class Outcome:
    """The decision of a scenario for one frame."""

    command: CharacterCommand
    """What the animator receives."""

    emotion: EmotionTarget
    """What the robot shows, and the character's face and posture too."""

    hint: str
    """What the player can do now, or has just said, in one short sentence."""

    icon: str = "idle"
    """The current action or gait: the title of its card, which shows its icon if it has one."""

    floor: tuple[FloorPath, ...] = field(default=())
    """Paths that are painted on the table."""

    events: tuple[str, ...] = ()
    """What has just happened, such as "reached": the character may say something about it."""

    things: tuple[Thing, ...] = ()
    """Small things on the table, or in the character's hands."""

    reply: Reply | None = None
    """What it wants to say now; None for nothing new."""

    hush: bool = False
    """Whether what is being said, or was to be said, is cut off now."""

    keeps_line: bool = False
    """Whether the line that came with this frame is kept, to begin when `line` gives it."""

    line: SpokenLine | None = None
    """What it begins to say now, of the lines that were kept; None for nothing new."""

    asked_sounds: tuple[str, ...] = ()
    """Names of sounds of a `SoundingScenario` that it lacks: a later frame has them."""

    sounds: tuple[PlayedSound, ...] = ()
    """Sounds that go on now, besides those of the characters."""

    question: ModelQuestion | None = None
    """What a language model is asked now; None for nothing new."""

    thinks: bool = False
    """Whether the character looks aside, as who thinks before speaking."""


@dataclass(frozen=True)
class ScenarioSettings:
    """What the user may choose for a scenario; raises AppError if a setting is out of its range."""

    speed_map: str = "corrected"
    """One of `SPEED_MAP_NAMES`."""

    turns: float = 2.0
    """Full turns of the cube from the least to the greatest intensity."""

    personality: Personality | None = None
    """How events change the mood; None for the scenario's own personality."""

    language: str = ""
    """Code of the language in which a dialogue begins; "" for its first one."""

    asks_model: bool = False
    """Whether a language model is asked where a dialogue has no answer of its own."""

    def __post_init__(self) -> None:
        check_speed_map(self.speed_map)
        check_turns(self.turns)


class Scenario(Protocol):
    """A way to play. `update` advances its state once a frame; it reads no clock."""

    name: str
    """Its name on the command line."""

    summary: str
    """What happens in it, for the help of the command line: one line, no full stop."""

    cube: str
    """Name of the bundled cube that it is made for."""

    roles: tuple[str, ...]
    """Roles of faces that it reads: the cube must have them all. () if it reads none."""

    character: str
    """Name of its bundled character."""

    personality: str
    """Name of its bundled personality."""

    start: RootDelta
    """Where the character stands at first on the table [m], and its heading [rad]."""

    has_intensity: bool
    """Whether its actions have an intensity, `ActionIntent.weight`; without it they count fully."""

    def __init__(self, cube: CubeModel, settings: ScenarioSettings) -> None: ...

    def update(self, controls: CubeControls, situation: Situation, inputs: Inputs) -> Outcome:
        """Decide on one frame."""
        ...


@runtime_checkable
class AdjustableScenario(Protocol):
    """A scenario with settings that the player can change while it is played."""

    adjustable: tuple[str, ...]
    """Which fields of `ScenarioSettings` it reads."""

    def adjust(self, settings: ScenarioSettings) -> None:
        """Play on with other settings."""
        ...


@runtime_checkable
class AskingScenario(Protocol):
    """A scenario that knows from the beginning which actions it will ask for."""

    asked: Mapping[str, str]
    """The place that names each action, such as "my.toml: rule[0].do", by the action."""


@runtime_checkable
class ListeningScenario(Protocol):
    """A scenario that answers what is typed."""

    listens: bool
    """Whether what is typed now is for it."""


@runtime_checkable
class PreparingScenario(Protocol):
    """A scenario that asks for lines before their time."""

    prepares: bool
    """Whether the next line that comes is for later, so that it waits for nobody's turn."""


@runtime_checkable
class SoundingScenario(Protocol):
    """A scenario that plays sounds of its own."""

    sounds: Mapping[str, SoundSource]
    """Where they come from, by their names. A replay has them in the recording."""


@runtime_checkable
class CastScenario(Protocol):
    """A scenario with several characters."""

    others: tuple[str, ...]
    """The rest of its cast, unless the player chooses one: bundled characters or files."""


@runtime_checkable
class NamingScenario(Protocol):
    """A scenario that gives its characters names."""

    names: tuple[str, ...]
    """Those of the whole cast, in its order."""


@runtime_checkable
class DressingScenario(Protocol):
    """A scenario that gives its own characters other colours."""

    colours: tuple[Mapping[str, str], ...]
    """For each of the cast, which ones take the place of which; see `with_colours`."""


@runtime_checkable
class FurnishedScenario(Protocol):
    """A scenario that puts things on the table."""

    kept_free: tuple[tuple[float, float], ...]
    """Where they stand, (x, z) [m]: none of the others waits there."""


@runtime_checkable
class CastDirector(Protocol):
    """A scenario that decides for others of the cast, too."""

    def scenario_of(self, number: int, place: RootDelta) -> Scenario | None:
        """Return what one of the others plays, by its number from 1; None to let it watch.

        `place` is where it stands at first. What is said of its `Outcome.events` is in the lines of
        its scenario's name.
        """
        ...


def check_actions(scenario: Scenario, character: str, known: Collection[str]) -> None:
    """Refuse a character that lacks an action which the scenario will ask for.

    Raises
    ------
    AppError
        With the place that names the first such action.
    """
    asked = scenario.asked if isinstance(scenario, AskingScenario) else {}
    for action, place in asked.items():
        if action not in known:
            listed = ", ".join(known) or "none"
            raise AppError(f"{place}: {character} cannot '{action}'; its actions: {listed}")


PERSON = "human"
"""The bundled character that has all gestures."""


@runtime_checkable
class GesturingScenario(Protocol):
    """A scenario that knows from the beginning which gestures its texts will ask for."""

    gestures: Mapping[str, str]
    """The place that names each gesture, such as "my.xml:12", by the gesture."""


@runtime_checkable
class ConversingScenario(ListeningScenario, GesturingScenario, Protocol):
    """A scenario that answers by a script, or may do so later on."""

    conversation: "DialogueScript | None"
    """What it has an answer to; None for nothing."""

    @property
    def language(self) -> str:
        """Code of the language that is spoken now."""
        ...


def check_gestures(scenario: Scenario, character: Character) -> None:
    """Refuse a gesture in the scenario's texts that neither the character nor a person has.

    One that only its body lacks, such as a wave without arms, is left out when it comes.

    Raises
    ------
    AppError
        With the place that names the first such gesture.
    """
    asked = scenario.gestures if isinstance(scenario, GesturingScenario) else {}
    missing = asked.keys() - meanings_of(character, asked).keys()
    if missing:
        missing -= meanings_of(Character.load(PERSON), missing).keys()
    for gesture, place in asked.items():
        if gesture in missing:
            raise AppError(
                f"{place}: {character.name} has no gesture '{gesture}'; "
                "cubeling gesture library lists them"
            )


def missing_roles(scenario: type[Scenario], cube: CubeModel) -> list[str]:
    """Return the roles that a scenario reads and no face of a cube has."""
    roles = {face.role for face in cube.faces}
    return [role for role in scenario.roles if role not in roles]
