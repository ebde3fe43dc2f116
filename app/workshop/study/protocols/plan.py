"""What one participant does, step by step: the same for the same protocol, number and seed."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from cubeling.app.workshop.study.protocols.orders import (
    balanced_order,
    block_draw,
    latin_square,
    random_order,
    random_sides,
)
from cubeling.app.workshop.study.protocols.protocol import Order, Phase, Protocol, Stimulus

Kind = Literal["instruction", "task", "question"]


@dataclass(frozen=True)
class PlannedStep:
    """One thing that a participant does: reads, plays, or answers a question."""

    key: str
    """Its name in the log, which no other step of the participant has."""

    kind: Kind
    phase: str
    condition: str
    """The condition; "" for none."""

    part: str
    """The instruction, task, questionnaire or set of stimuli."""

    item: str = ""
    """The item of the questionnaire; "" for what is no question."""

    questionnaire: str = ""
    after: str = ""
    """The task that the questions are about; "" for none."""

    stimulus: Stimulus = field(default_factory=dict)
    """What is shown; empty for nothing."""

    place: int = 0
    """The stimulus' place in the participant's order, from 1."""

    first_left: bool = True
    """Of a pair, whether the first is on the left."""


def plan_of(protocol: Protocol, number: int) -> tuple[PlannedStep, ...]:
    """Return the steps of a participant, by their number from 0."""
    return tuple(_Planner(protocol, number).steps())


def conditions_of(protocol: Protocol, number: int) -> tuple[str, ...]:
    """Return the conditions of a participant, in their order; ("",) where there are none."""
    names = tuple(protocol.conditions) or ("",)
    if protocol.design == "between":
        # In every block of participants, each condition has one.
        block = random_order(names, np.random.default_rng([protocol.seed, number // len(names)]))
        return (block[number % len(names)],)
    return _Planner(protocol, number).ordered(names, protocol.order)


class _Planner:
    """Draws the orders of one participant."""

    def __init__(self, protocol: Protocol, number: int) -> None:
        self._protocol, self._number = protocol, number
        self._rng = np.random.default_rng([protocol.seed, 1_000_003, number])
        self._used = 1  # rows of Latin squares that nest in this one

    def ordered(self, names: Sequence[str], order: Order) -> tuple[str, ...]:
        """Return names in the order of this participant.

        Squares are nested: the rows of the second one change when the first has gone round. With
        one number for both, the orders of conditions and tasks would be confounded.
        """
        if order == "random":
            return random_order(names, self._rng)
        if order == "fixed":
            return tuple(names)
        rows = balanced_order(names, self._number // self._used)
        self._used *= len(latin_square(len(names)))
        return rows

    def steps(self) -> Iterator[PlannedStep]:
        protocol = self._protocol
        conditions = conditions_of(protocol, self._number)
        if protocol.design == "within" and protocol.order == "latin" and protocol.conditions:
            self._used = len(latin_square(len(conditions)))
        for phase in protocol.phases:
            under = conditions if phase.each_condition or protocol.design == "between" else ("",)
            parts = self.ordered(phase.parts, phase.order)
            for condition in under:
                for part in parts:
                    yield from self._part(phase, condition, part)

    def _part(self, phase: Phase, condition: str, part: str) -> Iterator[PlannedStep]:
        protocol, key = self._protocol, "/".join(filter(None, (phase.name, condition, part)))
        if part in protocol.instructions:
            yield PlannedStep(key, "instruction", phase.name, condition, part)
        elif part in protocol.tasks:
            yield PlannedStep(key, "task", phase.name, condition, part)
            for name in protocol.tasks[part].then:
                yield from self._questions(f"{key}/{name}", phase, condition, name, after=part)
        elif part in protocol.questionnaires:
            yield from self._questions(key, phase, condition, part)
        else:
            yield from self._stimuli(key, phase, condition, part)

    def _questions(
        self, key: str, phase: Phase, condition: str, name: str, after: str = ""
    ) -> Iterator[PlannedStep]:
        for item in self._protocol.questionnaires[name].item:
            yield PlannedStep(
                f"{key}/{item.name}",
                "question",
                phase.name,
                condition,
                name,
                item.name,
                name,
                after,
            )

    def _stimuli(self, key: str, phase: Phase, condition: str, part: str) -> Iterator[PlannedStep]:
        shown = self._protocol.stimuli[part]
        groups, chosen = shown.groups(), list(shown.stimuli)
        if shown.each:
            drawn = block_draw(groups, shown.each, self._number, self._protocol.seed)
            chosen = [stimulus for group in drawn.values() for stimulus in group]
        ordered = random_order(chosen, self._rng)
        sides = random_sides(len(ordered), self._rng) if shown.pair else (True,) * len(ordered)
        for place, (stimulus, first_left) in enumerate(zip(ordered, sides, strict=True), 1):
            name = shown.ask.format_map(stimulus)
            for item in self._protocol.questionnaires[name].item:
                yield PlannedStep(
                    f"{key}/{place}/{item.name}",
                    "question",
                    phase.name,
                    condition,
                    part,
                    item.name,
                    name,
                    "",
                    stimulus,
                    place,
                    first_left,
                )
