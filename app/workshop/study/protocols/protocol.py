"""The protocol of a study: what its participants do, in which order, and what they are asked."""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from cubeling.app.running.wizard.plan import WizardPlan
from cubeling.app.workshop.study.protocols.goals import Goal
from cubeling.app.workshop.study.protocols.questionnaires import Questionnaire

Order = Literal["fixed", "latin", "random"]

Stimulus = Mapping[str, str]
"""The level of each factor."""


@dataclass(frozen=True)
class Instruction:
    """A text that the participant reads, or the experimenter says."""

    name: str
    text: str
    title: str = ""
    """What stands above it; "" for nothing."""


@dataclass(frozen=True)
class StudyTask:
    """Something to reach by playing."""

    name: str
    text: str
    """What the participant is told."""

    scenario: str
    """A scenario, or the file of one beside the protocol."""

    goal: Goal
    limit_s: float = 120.0
    """When it ends at the latest [s]."""

    ends: Literal["goal", "person"] = "goal"
    """Whether it ends as the goal is reached, or when the participant closes the window."""

    then: tuple[str, ...] = ()
    """Questionnaires that follow it."""

    title: str = ""
    """What stands above the text; "" for nothing."""


@dataclass(frozen=True)
class Settings:
    """How a scenario is played under a condition; what is left out is the scenario's own."""

    character: str | None = None
    personality: str | None = None
    controller: str = "tree"
    turns: float = 2.0
    """Full turns of the cube from the least to the greatest intensity."""


def pair_members(pair: str, first_left: bool = True) -> tuple[str, str]:
    """Return the members of a pair "a / b" from left to right.

    >>> pair_members("a / b", first_left=False)
    ('b', 'a')
    """
    first, _, second = pair.partition(" / ")
    return (first, second) if first_left else (second, first)


@dataclass(frozen=True)
class StimulusSet:
    """Pictures, videos or pairs of them that are shown one after the other."""

    name: str
    ask: str
    """The questionnaire about each; "{half} face" takes a part of its name from a factor."""

    stimuli: tuple[Stimulus, ...]
    """Every stimulus of the set, in the order of the file."""

    of: tuple[str, ...] = ()
    """Factors whose levels everybody sees equally often."""

    each: int = 0
    """How many of each combination of these levels a participant sees; 0 for all."""

    pair: str = ""
    """The factor whose levels are pairs, as "a / b", shown side by side; "" for single ones."""

    file: str = ""
    """Where a stimulus is, as "films/{person}-{origin}.mp4"; {member} is each one of a pair. "" for
    what the experimenter shows."""

    def groups(self) -> dict[tuple[str, ...], tuple[Stimulus, ...]]:
        """Return the stimuli by the levels of `of`."""
        key = lambda stimulus: tuple(stimulus[name] for name in self.of)  # noqa: E731
        ordered = sorted(self.stimuli, key=key)
        return {levels: tuple(each) for levels, each in itertools.groupby(ordered, key)}


@dataclass(frozen=True)
class Phase:
    """A part of a participant's time."""

    name: str
    parts: tuple[str, ...]
    """Names of instructions, tasks, questionnaires and sets of stimuli."""

    order: Order = "fixed"
    """The order of its parts."""

    each_condition: bool = False
    """Whether it is gone through once under each condition."""


@dataclass(frozen=True)
class Resume:
    """What happens with a participant who was interrupted."""

    policy: Literal["resume", "restart", "block"] = "resume"
    """Whether they go on, begin again, or are turned away."""

    at: Literal["answer", "phase"] = "answer"
    """Where they go on: after the last answer, or at the beginning of the phase."""

    oldest_h: float = 24.0
    """Up to which age of the last answer [h]; after that, they begin again."""


@dataclass(frozen=True)
class Preregistered:
    """What was laid down before the first participant; the report lists what differs."""

    participants: int = 0
    """How many there are to be; 0 for no number."""

    hypotheses: tuple[str, ...] = ()
    measures: tuple[str, ...] = ()
    """Items and scores that are analysed first."""


@dataclass(frozen=True)
class Protocol:
    """All that a study lays down: what is done, asked and compared."""

    name: str
    title: str
    about: str = ""
    conditions: Mapping[str, Settings] = field(default_factory=dict)
    """What differs, by its name; empty for one condition without a name."""

    design: Literal["within", "between"] = "within"
    """Whether everybody meets all conditions, or one."""

    order: Order = "latin"
    """The order of the conditions."""

    seed: int = 1
    phases: tuple[Phase, ...] = ()
    instructions: Mapping[str, Instruction] = field(default_factory=dict)
    tasks: Mapping[str, StudyTask] = field(default_factory=dict)
    questionnaires: Mapping[str, Questionnaire] = field(default_factory=dict)
    stimuli: Mapping[str, StimulusSet] = field(default_factory=dict)
    resume: Resume = Resume()
    preregistered: Preregistered = Preregistered()
    files: tuple[str, ...] = ()
    """Files beside it that it reads: questionnaires and scenarios."""

    light_patch: bool = False
    """Whether a square in the corner of the window is white while a stimulus is shown, and else
    black: for a light sensor."""

    wizard: WizardPlan | None = None
    """The buttons of a wizard's desk; None for a study without one."""

    printed: str = ""
    """The module with printed tables and simulated participants, of `bundled`; "" for none."""
