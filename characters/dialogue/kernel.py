"""The kernel of a dialogue: parallel state machines, of which one at a time takes a step.

Egges, "Real-time animation of interactive virtual humans", 2006, section 5.1. Where that leaves a
choice: words do not count case, accents and signs; what was said is answered by the first
transition that uses it, and forgotten if there is none; steps follow each other at once as long as
one is possible, and at most `MAX_STEPS` of them; choices are drawn from a seed.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import groupby
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from cubeling.characters.dialogue.checking import SAID_SLOT
from cubeling.characters.dialogue.patterns import FILLED, Heard, fill
from cubeling.characters.dialogue.script import DialogueScript, Localized, Unit, UnitTransition
from cubeling.characters.dialogue.vocabulary import (
    CORE_VOCABULARY,
    MAX_LINE_CHARS,
    DialogueMoment,
    Slots,
    TurnDraft,
    Vocabulary,
)
from cubeling.characters.speech.speech import Utterance

INTERVAL_S = 0.1
"""Time between two looks at conditions while nobody says anything [s]."""

MAX_STEPS = 16
"""Most steps of one turn."""

MAX_WAITING = 8
"""Texts that wait for an answer; of more, the oldest are forgotten."""

MAX_PROFILE = 200
"""Most slots that are remembered."""

NO_FEELINGS: Mapping[str, float] = MappingProxyType({})


@dataclass(frozen=True)
class DialogueTurn:
    """What a character does in one turn of a dialogue."""

    text: str
    """What it says, with tags; "" for nothing."""

    language: str
    """Code of the language of the text."""

    influences: tuple[tuple[str, float], ...]
    """Emotions that it feels, of the 24, with their strength, 0…1."""

    acts: tuple[tuple[str, str], ...]
    """What else it does: actions of the program, with what the script says there."""

    heard: str
    """What it answers; "" for nothing."""

    is_question: bool = False
    """Whether the script has an answer to that only which fits anything: see `Dialogue.answer`."""


@dataclass
class DialogueState:
    """All that changes in a dialogue: plain values, which a checkpoint copies."""

    states: dict[str, str]
    """The state of each unit by name."""

    language: str
    """The language that is spoken."""

    entered: dict[str, int] = field(default_factory=dict)
    """The turn in which each unit came to its state."""

    turns: int = 0
    """How often a unit has said or answered something."""

    last: str = ""
    """The unit that took the last step."""

    choices: int = 0
    """How many choices were drawn."""

    unused: dict[tuple[int, str], tuple[int, ...]] = field(default_factory=dict)
    """The texts of each action, by its line and the language, that were not said yet."""

    recent: tuple[str, ...] = ()
    """The last two texts that were said."""

    quotes: bool = False
    """Whether the last text quotes the one before, which stays the one to remember."""

    profile: dict[str, str] = field(default_factory=dict)
    """What is remembered, by slot."""

    waiting: list[Heard] = field(default_factory=list)
    """What was said and is to be answered."""

    asked: Heard | None = None
    """What somebody else is asked for an answer to; None for nothing."""

    due: float = 0.0
    """When conditions are looked at next [s]."""

    quiet_since: float | None = None
    """Since when nobody has said anything [s]; None before the first update."""


class _Step(NamedTuple):
    unit: Unit
    transition: UnitTransition
    slots: Slots


class Dialogue:
    """A dialogue by a script. It reads no clock, and the same inputs give the same turns.

    Parameters
    ----------
    script
        What can be said.
    language
        One of its languages; "" for the first.
    seed
        Of all choices.
    vocabulary
        That with which the script was read.
    """

    def __init__(
        self,
        script: DialogueScript,
        *,
        language: str = "",
        seed: int = 0,
        vocabulary: Vocabulary = CORE_VOCABULARY,
    ) -> None:
        self.script = script
        language = language if language in script.languages else script.languages[0]
        self.state = DialogueState({unit.name: unit.start for unit in script.units}, language)
        """All that changes."""
        self._seed, self._vocabulary = seed, vocabulary
        units = sorted(script.units, key=lambda unit: -unit.priority)
        self._groups = [list(group) for _, group in groupby(units, lambda unit: unit.priority)]

    def hear(self, text: str, *, typed: bool = True) -> None:
        """Take what was said; `typed` is whether a person said it, and it is no word of the cube.

        The next update answers it.
        """
        waiting = self.state.waiting
        waiting.append(Heard.of(text, typed=typed))
        del waiting[:-MAX_WAITING]
        if typed:
            self.state.asked = None  # who says something else does not wait for that answer

    def answer(self, text: str, now: float) -> DialogueTurn:
        """Return the turn in which a text answers what was asked in one before."""
        state = self.state
        heard, state.asked = state.asked, None
        state.turns += 1
        state.recent, state.quotes = (*state.recent, text)[-2:], False
        state.quiet_since = now
        return DialogueTurn(text, state.language, (), (), "" if heard is None else heard.text)

    def take_back(self) -> None:
        """Let the script answer what was asked: nobody else did."""
        if self.state.asked is not None:
            self.state.waiting.insert(0, self.state.asked)
            self.state.asked = None

    def remember_said(self, text: str) -> None:
        """Remember what was heard of the last reply: all of it, or as far as it came."""
        if not self.state.quotes:
            self.state.profile[SAID_SLOT] = text[:MAX_LINE_CHARS]

    def update(
        self,
        now: float,
        *,
        busy: bool = False,
        feelings: Mapping[str, float] = NO_FEELINGS,
        world: Any = None,
        asks: bool = False,
    ) -> DialogueTurn | None:
        """Advance to a time and return what is done; None for nothing.

        Parameters
        ----------
        now
            The time [s].
        busy
            Whether the character still says something: then it only answers.
        feelings
            Intensities of the 24 emotions, 0…1.
        world
            What the program's own conditions are asked of.
        asks
            Whether somebody else may know an answer where the script has one for anything only.
            The turn is a question then, and `answer` or `take_back` follows.
        """
        state = self.state
        if busy or state.quiet_since is None:
            state.quiet_since = now
        heard = state.waiting.pop(0) if state.waiting else None
        if heard is None and (busy or now < state.due):
            return None
        state.due = now + INTERVAL_S
        language, spelled = self._understand(heard)
        draft = TurnDraft(state.language, state.profile, self._choose_text)
        answered = ""
        for _ in range(MAX_STEPS):
            quiet = now - state.quiet_since
            moment = DialogueMoment(
                heard, language, spelled, feelings, state.profile, quiet, False, world
            )
            step = self._choose(moment, only_answers=busy and not answered)
            if step is None and answered == "" and state.waiting:
                heard = state.waiting.pop(0)  # nobody answers the one before
                language, spelled = self._understand(heard)
                continue
            if step is None:
                break
            is_vague = step.unit.fallback or step.transition.is_open
            if asks and is_vague and step.transition.hears and heard is not None and heard.typed:
                state.asked, state.language = heard, language
                return DialogueTurn("", language, (), (), heard.text, is_question=True)
            if step.transition.hears and heard is not None:
                state.language = draft.language = language
                answered, heard = heard.text, None
            self._take(step, draft)
            state.quiet_since = now
        if not (draft.texts or draft.influences or draft.acts or answered):
            return None
        return DialogueTurn(
            " ".join(draft.texts),
            draft.language,
            tuple(draft.influences),
            tuple(draft.acts),
            answered,
        )

    def _understand(self, heard: Heard | None) -> tuple[str, tuple[str, ...]]:
        """Return the language of what was said, and its words as the script spells them."""
        language, spelling = self.state.language, self.script.spelling
        if heard is None or not heard.typed:
            return language, ()
        language = spelling.language_of(heard.plain, language)
        return language, spelling.correct(heard.plain, language)

    def _choose(self, moment: DialogueMoment, *, only_answers: bool) -> _Step | None:
        """Choose the unit that takes a step, and the step; None if none can."""
        state = self.state
        passed = replace(moment, passed_over=True)
        for group in (
            [u for u in self.script.units if u.strong and u.name == state.last],
            *self._groups,
        ):
            able = []
            for unit in group:
                if moment.heard is None and unit.states[state.states[unit.name]].only_hears:
                    continue
                is_passed = state.turns > state.entered.get(unit.name, state.turns)
                steps = self._steps(
                    unit, passed if is_passed else moment, only_answers=only_answers
                )
                if steps:
                    able.append(steps)
            if able:
                steps = able[self._draw(len(able))]
                return steps[self._draw(len(steps))]
        return None

    def _steps(self, unit: Unit, moment: DialogueMoment, *, only_answers: bool) -> list[_Step]:
        """Return the steps that a unit can take."""
        steps = []
        kinds = self._vocabulary.conditions
        for transition in unit.states[self.state.states[unit.name]].transitions:
            if moment.heard is None if transition.hears else only_answers:
                continue
            slots: Slots = {}
            for each in transition.conditions:
                found = kinds[each.kind].holds(moment, each.argument)
                if found is None:
                    break
                slots.update(found)
            else:
                if not self._repeats(unit, transition, moment.language):
                    steps.append(_Step(unit, transition, slots))
        return steps

    def _repeats(self, unit: Unit, transition: UnitTransition, language: str) -> bool:
        """Return whether a transition could only lead to what was said twice running.

        What follows without waiting counts: no input is taken for an answer that cannot be given.
        """
        recent = self.state.recent
        if len(recent) < 2 or recent[0] != recent[1]:
            return False
        profile = self.state.profile
        for each in transition.actions:
            if each.kind == "say":
                texts = each.argument.of(language)
                return all(fill(text, profile) == recent[0] for text in texts)
        state = unit.states[unit.after(transition.target)]
        following = [each for each in state.transitions if not each.waits]
        return bool(following) and all(self._repeats(unit, each, language) for each in following)

    def _take(self, step: _Step, draft: TurnDraft) -> None:
        """Take a step: remember, act, and go to its state."""
        state, (unit, transition, slots) = self.state, step
        state.profile.update(slots)
        for each in transition.actions:
            draft.line = each.line
            self._vocabulary.actions[each.kind].perform(draft, each.argument)
        while len(state.profile) > MAX_PROFILE:
            del state.profile[next(iter(state.profile))]
        if transition.hears or any(each.kind == "say" for each in transition.actions):
            state.turns += 1
        state.states[unit.name] = unit.after(transition.target)
        state.entered[unit.name] = state.turns
        state.last = unit.name

    def _choose_text(self, texts: Localized[str], line: int) -> str:
        """Choose a text, each once before any comes again, and never the one just said."""
        state = self.state
        found = texts.of(state.language)
        choices = [fill(text, state.profile) for text in found]
        key = line, state.language
        # Actions of one line share what is unused, and one of them may have more texts.
        unused = [number for number in state.unused.get(key, ()) if number < len(choices)]
        unused = unused or list(range(len(choices)))
        last = state.recent[-1:] or ("",)
        fresh = [number for number in unused if choices[number] != last[0]]
        if not fresh:
            fresh = [n for n, text in enumerate(choices) if text != last[0]] or unused
        number = fresh[self._draw(len(fresh))]
        state.unused[key] = tuple(each for each in unused if each != number)
        state.recent = (*state.recent, choices[number])[-2:]
        quoted = (slot[1].lower() for slot in FILLED.finditer(found[number]))
        state.quotes = SAID_SLOT in quoted
        return choices[number]

    def _draw(self, count: int) -> int:
        """Draw one of so many choices."""
        if count == 1:
            return 0
        self.state.choices += 1
        return int(np.random.default_rng([self._seed, self.state.choices]).integers(count))


def heard_of(utterance: Utterance, seconds: float) -> str:
    """Return what was heard of an utterance until a time from its start [s].

    A word that has begun was heard. What was cut off ends in "…".
    """
    if seconds >= utterance.duration:
        return utterance.text
    begun = [word for word in utterance.words if word.start < seconds]
    if not begun:
        return ""
    end = begun[-1].offset + len(begun[-1].text)
    return (
        utterance.text[:end] + "…" if end < len(utterance.text.rstrip(" .!?")) else utterance.text
    )
