"""A scenario that a file of rules describes."""

from typing import ClassVar

import numpy as np

from cubeling.affect import Personality
from cubeling.app.pipeline.scenario import Inputs, Outcome, Scenario, ScenarioSettings
from cubeling.app.pipeline.table.situation import PLAYER_POSITION, Situation
from cubeling.app.scenarios.mood import MoodController
from cubeling.app.scenarios.presence import Presence
from cubeling.app.scenarios.rules.file import Rule, RuleSet, event_of, read_rules
from cubeling.app.scenarios.rules.vocabulary import ACTIONS, PACES, Intent, Moment
from cubeling.app.scenarios.waiting import Waiting
from cubeling.characters import ActionIntent, CharacterCommand, LocomotionIntent, RootDelta
from cubeling.tracking import CubeControls, CubeModel

HOME = RootDelta(-0.14, 0.0, 0.1)
"""Where the character stands at first: beside the cube, to its left as the player sees it."""

CLEARANCE_M = 0.1
"""How far from the cube's centre a character stops that goes to it [m]."""


class RulesScenario:
    """Acts by the rules of its class, which `rules_scenario` makes of a file.

    A rule with `when` begins to act when its conditions begin to hold, for its time; another one
    that begins meanwhile takes over, of several in one frame the first in the file. While none of
    them acts, the first rule with `while` whose conditions hold does.

    Each of the others for whom there are rules has such a scenario of its own, and watches while
    none of them acts.

    Parameters
    ----------
    cube
        The cube that leads or is watched.
    settings
        The player's.
    who
        The number in the cast of the character for which it decides.
    start
        Where that one stands at first.
    """

    rules: ClassVar[RuleSet]
    """What the file says."""

    name: str
    summary: str
    cube: str
    roles: tuple[str, ...]
    character: str
    others: tuple[str, ...]
    personality: str
    has_intensity = False
    adjustable = ("personality",)

    def __init__(
        self,
        cube: CubeModel,
        settings: ScenarioSettings,
        who: int = 0,
        start: RootDelta = HOME,
    ) -> None:
        self.start, self.asked = start, self.rules.asked(who)
        self._cube, self._settings = cube, settings
        self._own = self.rules.of(who)
        self._waiting = Waiting(start, who) if who else None
        self._roles = {face.name: face.role for face in cube.faces}
        self._mood = MoodController(settings.personality or Personality.load(self.personality))
        self._presence = Presence()
        self._begin()

    def scenario_of(self, number: int, place: RootDelta) -> Scenario | None:
        """Return what one of the others plays; see `CastDirector`."""
        if not self.rules.of(number):
            return None
        return type(self)(self._cube, self._settings, number, place)

    def adjust(self, settings: ScenarioSettings) -> None:
        """Play on with another personality."""
        self._mood.adjust(settings.personality or Personality.load(self.personality))

    def _begin(self) -> None:
        self._since: dict[int, float] = {}  # since when the conditions of a rule hold
        self._done: set[int] = set()  # rules that have acted since their conditions hold
        self._acting: int | None = None
        self._until = 0.0

    def update(self, controls: CubeControls, situation: Situation, inputs: Inputs) -> Outcome:
        """Decide on one frame; see `Scenario.update`."""
        if inputs.clear:
            self._mood.reset()
            self._begin()
        visible = self._presence.update(controls)
        moment = Moment(controls, situation, inputs, self._roles)
        before = self._acting
        if visible:  # nobody is there to act before the table is known
            begun = self._choose(moment)
        else:
            begun, self._acting = False, None
        intent = Intent(hint=self.rules.hint)
        if self._acting is not None:
            for key, text in self.rules.rules[self._acting].actions:
                ACTIONS[key].perform(intent, text)
        events: tuple[str, ...] = ()
        if self._acting is not None and (begun or self._acting != before):
            events = (event_of(self._acting),)
        felt = (*(intent.events if events else ()), *inputs.events)
        command, icon = self._command(intent, moment, visible=visible), intent.action
        if self._waiting is not None:
            waits = self._waiting.update(controls, situation, inputs)
            command, icon = (waits.command, waits.icon) if self._acting is None else (command, icon)
        emotion = self._mood.update(controls, icon if visible else "idle", events=felt)
        hint = intent.hint if controls.visible else "Show me the cube"
        return Outcome(command, emotion, hint, icon, events=events)

    def _command(self, intent: Intent, moment: Moment, *, visible: bool) -> CharacterCommand:
        return CharacterCommand(
            timestamp=moment.controls.timestamp,
            locomotion=way_of(intent, moment, self.start),
            action=ActionIntent(intent.action, 1.0) if not intent.go else None,
            visible=visible,
        )

    def _choose(self, moment: Moment) -> bool:
        """Choose the rule that acts; return whether one with `when` has just begun."""
        now = moment.controls.timestamp
        rules = self.rules.rules
        due = [index for index in self._own if self._is_due(index, rules[index], moment)]
        begun = [each for each in due if not rules[each].lasting and each not in self._done]
        self._done.update(begun)
        if begun:
            self._acting, self._until = begun[0], now + rules[begun[0]].seconds
            return True
        acts_on = self._acting is not None and not rules[self._acting].lasting
        if not (acts_on and now < self._until):
            self._acting = next((each for each in due if rules[each].lasting), None)
        return False

    def _is_due(self, index: int, rule: Rule, moment: Moment) -> bool:
        """Return whether the conditions of a rule have held for long enough."""
        if not all(term.holds(moment) for term in rule.conditions):
            self._since.pop(index, None)
            self._done.discard(index)
            return False
        now = moment.controls.timestamp
        return now - self._since.setdefault(index, now) >= rule.after


def way_of(intent: Intent, moment: Moment, home: RootDelta) -> LocomotionIntent:
    """Return where an intent lets the character go, and that it faces the player when it stands."""
    cube, character = moment.controls.position, moment.situation.character
    if intent.go == "home":
        return LocomotionIntent(
            PACES[intent.pace], np.array([home.x, home.z]), facing=PLAYER_POSITION
        )
    if intent.go == "cube" and cube is not None and character is not None:
        offset = character.table_from_character[[0, 2], 3] - cube
        distance = float(np.linalg.norm(offset))
        place = cube + offset * (min(CLEARANCE_M, distance) / max(distance, 1e-9))
        return LocomotionIntent(PACES[intent.pace], place, facing=PLAYER_POSITION)
    return LocomotionIntent(facing=PLAYER_POSITION)


def rules_scenario(path: str) -> type[RulesScenario]:
    """Return the scenario of a file of rules; raises AppError if it cannot be read."""
    rules = read_rules(path)
    members = {
        "__module__": __name__,
        "__doc__": rules.summary,
        "rules": rules,
        "name": rules.name,
        "summary": rules.summary,
        "cube": rules.cube,
        "roles": rules.roles,
        "character": rules.character,
        "others": rules.others,
        "personality": rules.personality,
    }
    return type("FileScenario", (RulesScenario,), members)
