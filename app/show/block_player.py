"""Blocks of BML in play: one of the cast performs them, with lines that enter as all lines do."""

from dataclasses import replace

import numpy as np

from cubeling.app.pipeline.scenario import Outcome, Reply
from cubeling.app.pipeline.table.situation import Situation
from cubeling.app.pipeline.table.spoken_line import SpokenLine
from cubeling.app.show.blocks import BlockDirector, block_of, command_of
from cubeling.app.show.script import ShowCue
from cubeling.app.show.stage_state import StageState
from cubeling.characters import Character
from cubeling.characters.behaviour import BmlWarning, Saying
from cubeling.characters.speech import Utterance


class BlockLines:
    """What a voice says for blocks: it is asked for one line after the other.

    `language` is that of speeches that name none.
    """

    def __init__(self, language: str) -> None:
        self._language = language
        self._lines: dict[tuple[str, str], SpokenLine | None] = {}
        self._asked: tuple[str, str] | None = None

    def utterance_of(self, text: str, language: str) -> Utterance | None:
        """Return what is said, in a language ("" for the usual one); None until it has come."""
        line = self._lines.setdefault((text, language or self._language), None)
        return None if line is None else line.utterance

    def line_of(self, saying: Saying) -> SpokenLine | None:
        """Return the sound of something that is being said."""
        came = (line for line in self._lines.values() if line is not None)
        return next((line for line in came if line.utterance is saying.utterance), None)

    @property
    def waits(self) -> bool:
        """Whether the next line that comes is one of these."""
        return self._asked is not None

    def take(self, line: SpokenLine) -> None:
        """Take the line that was asked for."""
        if self._asked is not None:
            self._lines[self._asked], self._asked = line, None

    def next_reply(self) -> Reply | None:
        """Return what the voice is asked for now; None for nothing, or while it is at work."""
        missing = (each for each, line in self._lines.items() if line is None)
        if self.waits or (asked := next(missing, None)) is None:
            return None
        self._asked = asked
        return Reply(*asked)

    def give_way(self) -> None:
        """Ask later again: the voice is asked for something else instead."""
        self._asked = None


class BlockPlayer:
    """Performs the blocks of one of the cast.

    Parameters
    ----------
    character
        Its body.
    language
        The language of speeches that name none.
    """

    def __init__(self, character: Character, language: str) -> None:
        self.character = character
        """Its body."""
        self.lines = BlockLines(language)
        """What it says."""
        self._director = BlockDirector(character, self.lines.utterance_of)
        self._begun: list[tuple[ShowCue, str]] = []
        self._saying: Saying | None = None
        self._warning = ""

    def begin(self, cue: ShowCue) -> None:
        """Begin the block of a cue."""
        block = block_of(cue.text)
        block = replace(block, id=block.id or f"line {cue.line}")
        self._director.accept(block)
        self._begun.append((cue, block.id))
        self._warning = ""

    def stop(self, name: str) -> None:
        """End the block of the cue with an id."""
        for cue, block in self._begun:
            if cue.id == name:
                self._director.cut_off(block)

    def update(
        self, outcome: Outcome, situation: Situation, line: SpokenLine | None, stage: StageState
    ) -> Outcome:
        """Return a decision for one frame with what the blocks add to it.

        `line` is what the voice says, whether or not it was asked for a block.
        """
        now, director = outcome.command.timestamp, self._director
        keeps = line is not None and self.lines.waits
        if line is not None and keeps:
            self.lines.take(line)
        if situation.character is not None:
            director.move(situation.character)
        if situation.cube is not None:
            director.who.surroundings.places["cube"] = np.array(situation.cube[:3, 3])
        realized, feedback = director.update(now)
        warnings = [each.description for each in feedback if isinstance(each, BmlWarning)]
        self._warning = (*warnings, self._warning)[0]
        for cue, block in self._begun:
            end = director.realizer.end_of(block)
            stage.expect(cue, now if end is None else end)
        self._begun = [
            each for each in self._begun if director.realizer.end_of(each[1]) is not None
        ]
        asked = command_of(realized, None, director.who)
        soon = (each for each in (outcome.command.coming, director.coming(now)) if each is not None)
        goes = realized.going is not None or realized.facing is not None
        command = replace(
            outcome.command,
            behaviour=asked.behaviour,
            coming=min(soon, key=lambda each: each.start, default=None),
            locomotion=asked.locomotion if goes else outcome.command.locomotion,
        )
        before, self._saying = self._saying, realized.sayings[-1] if realized.sayings else None
        begins, broken = None, False
        if self._saying is not None and (before is None or before.key != self._saying.key):
            begins = self.lines.line_of(self._saying)
        elif self._saying is None and before is not None:
            broken = now < before.start + before.utterance.duration
        return replace(
            outcome,
            command=command,
            hint=self._warning or outcome.hint,
            keeps_line=keeps,
            line=begins,
            hush=outcome.hush or broken,
        )
