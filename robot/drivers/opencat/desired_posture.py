"""The desired state of a board: a mood with its posture and pose, or the posture for a stop."""

from collections import deque

from cubeling.affect import Emotion
from cubeling.affect.words import closest_word
from cubeling.robot.drivers.commands import DesiredState
from cubeling.robot.drivers.opencat import tokens
from cubeling.robot.drivers.opencat.echo import BoardCommand
from cubeling.robot.drivers.opencat.settings import ModelBehaviour, OpenCatMood

POSTURE_TIMEOUT_S = 5.0
"""Longest time of a posture [s]; a joint moves from end to end in less than 2 s."""

POSE_TIMEOUT_S = 4.0
"""Longest time of a pose [s]."""

MAX_REFUSALS = 2
"""Refusals after which a posture is given up: the first may be due to a wrong bit."""


class DesiredPosture(DesiredState):
    """The mood or stop that was requested last, and which of its commands are due."""

    def __init__(self, behaviour: ModelBehaviour) -> None:
        super().__init__()
        self.number = 0
        """Number of the desired state; 0 while there is none."""
        self._behaviour = behaviour
        self._word: str | None = None  # the requested mood; None for a stop
        self._due: deque[BoardCommand] = deque()
        self._sent_number = 0  # number of the desired state that was sent last
        self._refusals = 0
        self._repeat = False  # whether everything is due again after the next echo

    @property
    def requested_mood(self) -> OpenCatMood | None:
        """The requested mood; None for a stop."""
        return self._behaviour.moods[self._word] if self.number and self._word else None

    @property
    def shown_mood(self) -> OpenCatMood | None:
        """The requested mood if the robot shows it."""
        return self.requested_mood if self.shown == self._word else None

    @property
    def due(self) -> BoardCommand | None:
        """The next command; it remains due until its echo."""
        return self._due[0] if self._due else None

    def express(self, emotion: Emotion) -> bool:
        """Request an emotion; return whether the desired mood changes."""
        self.commanded = emotion
        word = self._closest(emotion)
        if self.number and word == self._word:
            self.follow(word, emotion, sent=self._sent_number == self.number)
            return False
        self._request(word)
        return True

    def stop(self) -> None:
        """Request the posture for a stop."""
        self.commanded = None
        self._request(None)

    def set_behaviour(self, behaviour: ModelBehaviour) -> None:
        """Use the behaviour of another model for the same request."""
        self._behaviour = behaviour
        if self.commanded is not None:
            self._word = self._closest(self.commanded)
        self.lose()

    def send(self) -> BoardCommand | None:
        """Return the due command; the caller sends it."""
        command = self.due
        if command is not None:
            self._sent_number, self.sent = self.number, self.commanded
            self.begin(command.word)
        return command

    def complete(self, command: BoardCommand) -> bool:
        """Process the echo of a posture or pose; return whether a new mood or stop is taken."""
        current = command.order == self.number
        if current:
            self._refusals = 0
            if self._due and self._due[0].line == command.line:
                self._due.popleft()
        if self._due if current else not command.whole:
            return False
        new = not (self.stopped if command.word is None else self.shown)
        if command.word is None:
            self.confirm(None, stopped=current)
        else:  # also for a mood that was replaced while it was pending
            self.confirm(self.sent, command.word)
        if self._repeat:
            self.repeat()
        return new

    def refuse(self, command: BoardCommand) -> None:
        """Process a refused posture: it is tried again, and then given up."""
        self.forget()
        if command.order != self.number:
            return
        self._refusals += 1
        if self._refusals >= MAX_REFUSALS:
            self._due.clear()

    def repeat(self) -> None:
        """Make every command of the desired state due: another skill has displaced it."""
        self._repeat = False
        self._due.clear()
        mood = self.requested_mood
        if mood is not None:
            self._due.append(self._posture(mood.posture, whole=not mood.pose))
            if mood.pose:
                self._due.append(self._pose(mood))
        elif self.number:
            self._due.append(self._posture(self._behaviour.stop, whole=True))

    def disturb(self) -> None:
        """Record that the robot moved by itself: it got up after a fall, for example."""
        self.forget()
        if self._due:
            self._repeat = True
        else:
            self.repeat()

    def let_go(self) -> None:
        """Record that the servos are off: nothing is shown, and nothing is due."""
        self.forget()
        self._due.clear()

    def lose(self) -> None:
        """Record that the robot may have lost its posture: every command is due again."""
        self.forget()
        self._refusals = 0
        self.repeat()

    def _request(self, word: str | None) -> None:
        self._word = word
        self.number += 1
        self._refusals = 0
        self.stopped = False
        self.repeat()

    def _closest(self, emotion: Emotion) -> str:
        return closest_word(tuple(self._behaviour.moods), emotion) or "neutral"

    def _posture(self, name: str, whole: bool) -> BoardCommand:
        line = tokens.skill(name)
        return BoardCommand(
            "posture", line, name, POSTURE_TIMEOUT_S, self._word, self.number, whole
        )

    def _pose(self, mood: OpenCatMood) -> BoardCommand:
        line = tokens.pose(mood.pose)
        return BoardCommand("pose", line, "", POSE_TIMEOUT_S, self._word, self.number, whole=True)
