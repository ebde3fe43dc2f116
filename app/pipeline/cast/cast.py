"""A cast: the characters on the table, frame by frame."""

from collections.abc import Sequence
from dataclasses import replace

from cubeling.app.pipeline.cast.member import CastMember
from cubeling.app.pipeline.scenario import Inputs, Outcome
from cubeling.app.pipeline.step import Performance, ReplayInputs
from cubeling.app.pipeline.table.attention import ALONE, Company
from cubeling.app.pipeline.table.situation import SeenCube
from cubeling.characters import CharacterCommand, Obstacle, TableView


class Cast:
    """Characters that see each other: one character is the case of one.

    The first is the one that the cube leads. Each sees those before it as they are now, and those
    after it as they were in the previous frame: so who comes later makes way.
    """

    def __init__(self, members: Sequence[CastMember]) -> None:
        self.members = tuple(members)

    @property
    def lead(self) -> CastMember:
        """The member that the cube leads."""
        return self.members[0]

    def decide(self, seen: Sequence[SeenCube], inputs: Inputs) -> list[Outcome]:
        """Let each scenario decide; `seen` are the cubes of the players."""
        return [
            member.decide(seen[member.player], told)
            for member, told in zip(self.members, self._told(inputs), strict=True)
        ]

    def perform(
        self,
        seen: Sequence[SeenCube],
        decisions: Sequence[Outcome],
        inputs: Inputs,
        things: tuple[Obstacle, ...],
        view: TableView | None,
        recorded: ReplayInputs,
    ) -> list[CharacterCommand]:
        """Advance to the time of a frame, and return the commands; see `CastMember.command`.

        `things` are in the way of all, and so is each of the others. The first takes a recorded
        command or pose, if there is one.
        """
        commands = []
        for number, (member, told) in enumerate(zip(self.members, self._told(inputs), strict=True)):
            beside = () if len(self.members) == 1 else self._bodies(number)
            command = member.command(
                seen[member.player],
                decisions[number],
                told,
                (*things, *beside),
                view,
                self._company(number),
            )
            pose = None
            if number == 0:
                command = recorded.command or command
                pose = recorded.pose_for(member.character)
            member.perform(command, pose)
            commands.append(command)
        return commands

    def performances(
        self, commands: Sequence[CharacterCommand], decisions: Sequence[Outcome]
    ) -> tuple[Performance, ...]:
        """Return what all but the first do in a frame, after `perform`."""
        return tuple(
            member.performance(command, decision)
            for member, command, decision in zip(self.members, commands, decisions, strict=True)
        )[1:]

    def _bodies(self, number: int) -> tuple[Obstacle, ...]:
        """Return the others as they are in the way of one of the members."""
        bodies = (each.obstacle for at, each in enumerate(self.members) if at != number)
        return tuple(each for each in bodies if each is not None)

    def _told(self, inputs: Inputs) -> list[Inputs]:
        """Return what each member is told of the inputs: the first one says the lines."""
        return [inputs, *[replace(inputs, line=None)] * (len(self.members) - 1)]

    def _company(self, number: int) -> Company:
        """Return the others as one of the members sees them."""
        others = [
            each
            for at, each in enumerate(self.members)
            if at != number and each.posed is not None and each.posed.visible
        ]
        if not others:
            return ALONE
        speaking = [each.face for each in others if each.speaking.line is not None]
        return Company(tuple(each.face for each in others), speaking[0] if speaking else None)
