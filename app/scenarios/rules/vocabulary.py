"""The conditions and actions that a file may name: one table of each.

What a condition is asked of is a `Moment`, and what an action changes is an `Intent`: neither knows
of rules, so that dialogues can be written in the same words.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from cubeling.app.errors import AppError

if TYPE_CHECKING:  # a file is checked before numpy is loaded
    from cubeling.app.pipeline.scenario import Inputs
    from cubeling.app.pipeline.table.situation import Situation
    from cubeling.tracking import CubeControls

PACES = {"walk": 2.5, "run": 4.5}
"""AvatAR's Speed of each pace, 0…5."""

DESTINATIONS = ("cube", "home")
"""Where a character can be sent."""


@dataclass(frozen=True)
class Moment:
    """What a condition is asked of: one frame."""

    controls: CubeControls
    """What the hand does with the cube."""

    situation: Situation
    """Who and what is on the table."""

    inputs: Inputs
    """What the player asked for."""

    roles: Mapping[str, str]
    """The role of each face of the cube."""

    @property
    def distance_cm(self) -> float:
        """From the character to the cube's centre along the table [cm]; infinite if not known."""
        character, cube = self.situation.character, self.controls.position
        if character is None or cube is None:
            return math.inf
        x, z = character.table_from_character[[0, 2], 3] - cube
        return 100.0 * math.hypot(x, z)


@dataclass
class Intent:
    """What a character is to do; actions fill it in."""

    action: str = "idle"
    """Name of an action of the character."""

    go: str = ""
    """One of `DESTINATIONS`; "" to stay."""

    pace: str = "walk"
    """One of `PACES`."""

    hint: str = ""
    """What the player reads."""

    events: list[str] = field(default_factory=list)
    """What the mood hears of."""


@dataclass(frozen=True)
class RuleCondition:
    """A condition that a file may name."""

    meaning: str
    """When it holds, for the table of all."""

    holds: Callable[[Moment, str], bool]
    """Returns whether it holds, from its argument."""

    argument: str = ""
    """What follows its name: "ROLE", "NUMBER"; "" for nothing."""

    default: str = ""
    """The argument if none is given; "" where one must be."""


@dataclass(frozen=True)
class RuleAction:
    """Something that a file may let the character do."""

    meaning: str
    """What it does, for the table of all."""

    perform: Callable[[Intent, str], None]
    """Adds it to an intent."""

    choices: tuple[str, ...] = ()
    """What may be named; () for any text."""


def _top(moment: Moment, word: str) -> bool:
    face = moment.controls.top_face or ""
    return word in (face, moment.roles.get(face))


CONDITIONS: dict[str, RuleCondition] = {
    "always": RuleCondition(
        "at every moment; with when, once at the beginning", lambda _, __: True
    ),
    "seen": RuleCondition("the camera sees the cube", lambda now, _: now.controls.visible),
    "placed": RuleCondition("the cube is put down", lambda now, _: now.controls.placed),
    "lifted": RuleCondition("the cube is off the table", lambda now, _: now.controls.lifted),
    "resting": RuleCondition("the cube lies on the table", lambda now, _: now.controls.resting),
    "shaken": RuleCondition("the cube is shaken", lambda now, _: now.controls.shaken),
    "gesture": RuleCondition(
        "the hand makes this gesture with the cube",
        lambda now, name: name in now.controls.gestures,
        "NAME",
    ),
    "top": RuleCondition("the face of this role, or of this name, points up", _top, "ROLE"),
    "right": RuleCondition(
        "the cube was turned so far to the right since it was put down",
        lambda now, turns: now.controls.turns >= float(turns),
        "TURNS",
        "0.25",
    ),
    "left": RuleCondition(
        "the cube was turned so far to the left since it was put down",
        lambda now, turns: now.controls.turns <= -float(turns),
        "TURNS",
        "0.25",
    ),
    "near": RuleCondition(
        "the character is nearer to the cube than this",
        lambda now, cm: now.distance_cm < float(cm),
        "CM",
        "15",
    ),
    "far": RuleCondition(
        "the character is farther from the cube than this",
        lambda now, cm: math.inf > now.distance_cm > float(cm),
        "CM",
        "30",
    ),
    "heard": RuleCondition(
        "the character of this name in the cast has ended what it said",
        lambda now, number: now.situation.heard == int(number),
        "WHO",
    ),
    "cleared": RuleCondition("the player presses C", lambda now, _: now.inputs.clear),
}
"""The conditions by name; a new one is a line here."""

MOMENTARY_CONDITIONS = ("placed", "shaken", "gesture", "heard", "cleared")
"""Conditions that hold in a single frame."""

NUMBER_ARGUMENTS = ("TURNS", "CM")
"""Arguments that are numbers."""

ACTIONS: dict[str, RuleAction] = {
    "do": RuleAction(
        "perform an action of the character: wave, cheer, nod, kiss, shout …",
        lambda intent, name: setattr(intent, "action", name),
    ),
    "go": RuleAction(
        "go to the cube, or back to where it stood first",
        lambda intent, place: setattr(intent, "go", place),
        DESTINATIONS,
    ),
    "pace": RuleAction(
        "how it goes there", lambda intent, pace: setattr(intent, "pace", pace), tuple(PACES)
    ),
    "feel": RuleAction(
        "let an event of the personality happen to the mood: shaken, reached, chased, ignored …",
        lambda intent, event: intent.events.append(event),
    ),
    "hint": RuleAction("what the player reads", lambda intent, text: setattr(intent, "hint", text)),
}
"""The actions by the key that names them; a new one is a line here."""


@dataclass(frozen=True)
class Term:
    """A condition with its argument, as a file names it."""

    name: str
    """One of `CONDITIONS`."""

    argument: str = ""
    """Its argument; "" for none. Somebody of the cast is named by the number in it."""

    negated: bool = False
    """Whether it must not hold."""

    @classmethod
    def parse(cls, text: str, cast: Sequence[str] = ()) -> Term:
        """Read a term such as "lifted", "not resting", "top kiss" or "near 10".

        `cast` are the names of all characters.

        >>> Term.parse("not near 10")
        Term(name='near', argument='10', negated=True)
        >>> Term.parse("heard vleo", ["human", "vleo"])
        Term(name='heard', argument='1', negated=False)

        Raises
        ------
        AppError
            There is no such condition, or its argument is missing or of no use.
        """
        words = text.split()
        negated = words[:1] == ["not"]
        name, *rest = words[negated:] or [""]
        if name not in CONDITIONS:
            raise AppError(f"'{text}' is no condition: choose one of {', '.join(CONDITIONS)}")
        condition = CONDITIONS[name]
        argument = " ".join(rest) or condition.default
        if bool(argument) != bool(condition.argument):
            wanted = f"as in '{name} {condition.argument}'" if condition.argument else "nothing"
            raise AppError(f"'{text}': after '{name}' comes {wanted}")
        if condition.argument in NUMBER_ARGUMENTS and not _is_positive(argument):
            raise AppError(f"'{text}': '{argument}' is no number of {condition.argument.lower()}")
        if condition.argument == "WHO":
            if argument not in cast:
                raise AppError(f"'{text}': the cast is {', '.join(cast)}, without '{argument}'")
            argument = str(cast.index(argument))
        return cls(name, argument, negated)

    def holds(self, moment: Moment) -> bool:
        """Return whether it holds at a moment."""
        return CONDITIONS[self.name].holds(moment, self.argument) != self.negated


def _is_positive(text: str) -> bool:
    try:
        return 0.0 < float(text) < math.inf
    except ValueError:
        return False
