"""What buttons a wizard's desk has: those of a file, else all that character and robot can do."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cubeling.affect import WORD_PLACES, Emotion
from cubeling.app.errors import AppError
from cubeling.app.pipeline.step import RobotView
from cubeling.app.pipeline.table.acts import MAX_PLACE_M
from cubeling.characters import Animator, Character, known_gestures
from cubeling.toml_file import TomlTable, read, toml_kind

WIZARD_FILE = toml_kind("wizard", AppError, "cubeling.app.running.wizard.plan:read_wizard_plan")
"""The buttons of a wizard's desk."""

USUAL_EMOTIONS = (
    *("neutral", "happy", "excited", "relaxed", "surprised", "sad", "afraid", "angry", "disgusted"),
)
"""Those of the known words that have buttons where nobody says which."""

USUAL_TEXTS = ("Hello!", "Yes.", "No.", "Well done!", "Try again.", "Thank you, goodbye!")

MAX_ENTRIES = 256
"""Most buttons of a kind."""


@dataclass(frozen=True)
class WizardPlace:
    """A place on the table with a name."""

    name: str
    x_cm: float
    """To the right of the middle, as the player sees it [cm]."""

    z_cm: float
    """Towards the player [cm]."""

    def __post_init__(self) -> None:
        if max(abs(self.x_cm), abs(self.z_cm)) > 100 * MAX_PLACE_M:
            raise AppError(f"the place '{self.name}' is off the table: at most {MAX_PLACE_M:g} m")


@dataclass(frozen=True)
class WizardPlan:
    """The buttons of a wizard's desk; a list that is left out has all that there is."""

    cues: tuple[str, ...] = ()
    """What the wizard answers. The name of an event, as "placed" or "shaken", is a cue whenever it
    happens; any other one has a button."""

    say: tuple[str, ...] | None = None
    """Texts; tags name gestures."""

    gestures: tuple[str, ...] | None = None
    actions: tuple[str, ...] | None = None
    emotions: tuple[str, ...] | None = None
    """Words, such as "happy"."""

    robot: tuple[str, ...] | None = None
    """Motions and sounds of the robot, by the names of its catalogue."""

    place: tuple[WizardPlace, ...] = ()

    def __post_init__(self) -> None:
        for word in self.emotions or ():
            if word not in WORD_PLACES:
                raise AppError(f"no emotion is called '{word}': choose {', '.join(WORD_PLACES)}")

    def buttons(self, character: Character) -> list[dict[str, Any]]:
        """Return the groups of buttons for a character, as the page takes them."""
        words = USUAL_EMOTIONS if self.emotions is None else self.emotions
        groups = (
            ("say", USUAL_TEXTS if self.say is None else self.say),
            ("action", _or(self.actions, lambda: Animator(character).actions)),
            ("gesture", _or(self.gestures, lambda: known_gestures(character))),
            ("emotion", tuple(word for word in words if word in WORD_PLACES)),
        )
        return [{"kind": kind, "names": names} for kind, names in groups]

    def robot_buttons(self, robot: RobotView | None) -> tuple[str, ...]:
        """Return what the robot can play; () as long as nobody knows."""
        catalogue = None if robot is None else robot.catalogue
        if catalogue is None:
            return ()
        own = (*catalogue.motions, *catalogue.sounds)
        return own if self.robot is None else tuple(each for each in self.robot if each in own)


def _or(given: tuple[str, ...] | None, usual: Any) -> tuple[str, ...]:
    return usual() if given is None else given


def emotion_of(word: str) -> Emotion | None:
    """Return the emotion of a word; None for "", which releases."""
    return Emotion(*WORD_PLACES[word], word=word) if word in WORD_PLACES else None


def read_wizard_plan(path: Path) -> WizardPlan:
    """Read the buttons of a desk from a file; raises AppError."""
    content = read(path, WIZARD_FILE)
    return TomlTable(content, str(path), "", AppError, MAX_ENTRIES).fill(WizardPlan)
