"""A character that performs blocks, frame by frame, with its voice."""

from collections import deque
from dataclasses import dataclass

from cubeling.app.behaving.voice import LineSource
from cubeling.app.pipeline.table.spoken_line import SpokenLine
from cubeling.app.show.blocks import BehaviourOptions, BlockDirector, command_of
from cubeling.characters import Animator, Character, ComingAct, PosedCharacter, RootDelta
from cubeling.characters.behaviour import Feedback, RealizedFrame, Saying
from cubeling.characters.speech import Utterance

MAX_RECENT_LETTERS = 20_000
"""Letters of the lines whose sound is kept, besides the last one."""


@dataclass(frozen=True, eq=False)
class BehaviourFrame:
    """What a player shows and reports for one frame."""

    posed: PosedCharacter
    """The character with its pose and its place on the table."""

    realized: RealizedFrame
    """What it does in this frame for the active behaviours."""

    feedback: tuple[Feedback, ...]
    """What has happened since the last frame."""


class BehaviourPlayer:
    """Performs blocks with a character.

    Parameters
    ----------
    character
        Who performs.
    lines
        What its voice says; the caller closes it.
    options
        How.
    """

    def __init__(
        self, character: Character, lines: LineSource, options: BehaviourOptions | None = None
    ) -> None:
        options = options or BehaviourOptions()
        self.emotion = options.emotion
        """What it feels throughout."""
        self._lines = lines
        self._animator = Animator(character, place=RootDelta(), seed=options.seed)
        self._recent: deque[SpokenLine] = deque()
        self.director = BlockDirector(character, self._utterance, options)
        """What takes the blocks."""

    def update(self, now: float) -> BehaviourFrame:
        """Advance to a time [s] and return the frame."""
        realized, feedback = self.director.update(now)
        coming = self.director.coming(now)
        return BehaviourFrame(self._perform(realized, coming), realized, feedback)

    def settle(self, seconds: float, rate: float) -> None:
        """Stand for a time before time 0, in frames of a rate [Hz]: eyes find the viewer."""
        for number in range(-round(seconds * rate), 0):
            self._perform(RealizedFrame(number / rate))

    def _perform(self, realized: RealizedFrame, coming: ComingAct | None = None) -> PosedCharacter:
        command = command_of(realized, self.emotion, self.director.who, coming)
        posed = self._animator.update(command)
        self.director.move(posed)
        return posed

    def line_of(self, saying: Saying) -> SpokenLine | None:
        """Return the sound of something that is being said."""
        return next((e for e in self._recent if e.utterance is saying.utterance), None)

    def _utterance(self, text: str, language: str) -> Utterance | None:
        line = self._lines.line(text, language)
        if line is None:
            return None
        if line not in self._recent:
            self._recent.append(line)
            letters = sum(len(each.utterance.text) for each in self._recent)
            while letters > MAX_RECENT_LETTERS and len(self._recent) > 1:
                letters -= len(self._recent.popleft().utterance.text)
        return line.utterance
