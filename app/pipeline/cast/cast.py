"""A cast: the characters on the table, frame by frame."""

import math
from collections.abc import Sequence
from dataclasses import replace

from cubeling.app.pipeline.cast.directing import refusal
from cubeling.app.pipeline.cast.member import CastMember
from cubeling.app.pipeline.cast.turns import Turns
from cubeling.app.pipeline.scenario import Inputs, Outcome, PreparingScenario
from cubeling.app.pipeline.step import Performance, ReplayInputs
from cubeling.app.pipeline.table.acts import Act
from cubeling.app.pipeline.table.attention import ALONE, Company
from cubeling.app.pipeline.table.situation import SeenCube
from cubeling.app.pipeline.table.spoken_line import LEAD
from cubeling.characters import Obstacle, TableView


class Cast:
    """Characters that see each other: one character is the case of one.

    The first is the one that the cube leads. Each sees those before it as they are now, and those
    after it as they were in the previous frame: so who comes later makes way.
    """

    def __init__(self, members: Sequence[CastMember]) -> None:
        self.members = tuple(members)
        self._turns = Turns([each.led for each in self.members])
        self._heard: int | None = None
        self._now = -math.inf

    @property
    def lead(self) -> CastMember:
        """The member that the cube leads."""
        return self.members[0]

    def hear(self, inputs: Inputs, now: float) -> list[Inputs]:
        """Return what each member is told of the inputs at a time [s]: whoever begins, its line."""
        if inputs.clear:
            self._turns.clear()
        others = (inputs.lines_of_others.get(each.name) for each in self.members[1:])
        ends = [each.speaking.end for each in self.members]
        over = (at for at, end in enumerate(ends) if self._now < end <= now)
        self._heard, self._now = next(over, None), now
        lines = (inputs.line, *others)
        early = [_prepares(each) for each in self.members]
        wanted = [None if kept else line for line, kept in zip(lines, early, strict=True)]
        turn = self._turns.update(now, wanted, ends)
        for number in turn.interrupted:
            self.members[number].speaking.stop()
        silent = replace(inputs, line=None, lines_of_others={}, acts=())
        told = [
            replace(silent, line=line if kept else None)
            for line, kept in zip(lines, early, strict=True)
        ]
        if turn.begins is not None:
            told[turn.begins] = replace(silent, line=turn.line)
        for number, member in enumerate(self.members if inputs.acts else ()):
            name = member.name if number else LEAD
            own = tuple(act for act in inputs.acts if act.who == name)
            told[number] = replace(told[number], acts=own)
        return told

    def refusal(self, act: Act) -> str:
        """Return why an act cannot be carried out, in one line; "" if it can."""
        names = (LEAD, *(each.name for each in self.members[1:]))
        if act.who not in names:
            return f"nobody in the cast is called '{act.who:.40}'"
        member = self.members[names.index(act.who)]
        return refusal(act, member.character, member.actions)

    def decide(
        self, seen: Sequence[SeenCube], told: Sequence[Inputs], view: TableView | None = None
    ) -> list[Outcome]:
        """Let each scenario decide; `seen` are the cubes of the players, `told` is of `hear`."""
        return [
            member.decide(seen[member.player], own, self._heard, view)
            for member, own in zip(self.members, told, strict=True)
        ]

    def perform(
        self,
        seen: Sequence[SeenCube],
        decisions: Sequence[Outcome],
        told: Sequence[Inputs],
        things: tuple[Obstacle, ...],
        view: TableView | None,
        recorded: ReplayInputs,
    ) -> tuple[Performance, ...]:
        """Advance to the time of a frame, and return what each does; see `CastMember.command`.

        `things` are in the way of all, and so is each of the others. Recorded commands and poses
        take the place of those that would be computed.
        """
        performances = []
        for number, (member, own) in enumerate(zip(self.members, told, strict=True)):
            beside = () if len(self.members) == 1 else self._bodies(number)
            command = member.command(
                seen[member.player],
                decisions[number],
                own,
                (*things, *beside),
                view,
                self._company(number),
            )
            name = member.name if number else LEAD
            command = recorded.command_of(name) or command
            member.perform(command, recorded.pose_of(name, member.character))
            emotion = recorded.emotion_of(name) or decisions[number].emotion
            outcome = replace(decisions[number], command=command, emotion=emotion)
            performances.append(member.performance(outcome))
        return tuple(performances)

    def _bodies(self, number: int) -> tuple[Obstacle, ...]:
        """Return the others as they are in the way of one of the members."""
        bodies = (each.obstacle for at, each in enumerate(self.members) if at != number)
        return tuple(each for each in bodies if each is not None)

    def _company(self, number: int) -> Company:
        """Return the others as one of the members sees them."""
        others = [
            each
            for at, each in enumerate(self.members)
            if at != number and each.posed is not None and each.posed.visible
        ]
        if not others:
            return ALONE
        speaking = [each for each in others if each.speaking.line is not None]
        last = max(speaking, key=lambda each: each.speaking.end, default=None)
        return Company(
            tuple(each.face for each in others),
            None if last is None else last.face,
            waits=self._turns.waits(number),
        )


def _prepares(member: CastMember) -> bool:
    scenario = member.scenario
    return isinstance(scenario, PreparingScenario) and scenario.prepares
