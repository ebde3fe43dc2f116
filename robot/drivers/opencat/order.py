"""The standing order: the mood that is held, or the stop; only the latest counts."""

from collections import deque

from affect import Emotion
from affect.words import closest_word
from robot.drivers.opencat import tokens
from robot.drivers.opencat.exchange import Command
from robot.drivers.opencat.settings import Behaviour, Mood

POSTURE_WITHIN = 5.0
"""A posture takes at most so long [s]; a joint that goes from end to end needs under 2 s."""

POSE_WITHIN = 4.0
"""A pose takes at most so long [s]."""

REFUSED_TRIES = 2
"""An order that a board did not know is sent so often: the first time may have been a wrong bit."""


class StandingOrder:
    """What the robot is to show until something else is ordered, and how much of it is still due.

    Parameters
    ----------
    behaviour
        What the model does for which mood.
    """

    def __init__(self, behaviour: Behaviour) -> None:
        self.commanded: Emotion | None = None
        """The emotion that was last asked for; None before, and after a stop."""
        self.acknowledged: Emotion | None = None
        """What was last felt of the mood that the robot took last; None before, and once it may
        have lost it, or has said that it does not know the next one."""
        self.stopped = False
        """Whether the robot has taken the posture for a stop, and keeps it."""
        self.number = 0
        """Counts orders; 0 while there is none."""
        self._behaviour = behaviour
        self._word: str | None = None  # the mood ordered; None for a stop
        self._due: deque[Command] = deque()
        self._taken: str | None = None  # the mood acknowledged, while nothing displaces it
        self._sent = 0  # number of the order that was sent last
        self._felt: Emotion | None = None  # and what was last felt of it
        self._refusals = 0
        self._again = False  # whether it is due again once it has landed

    def express(self, emotion: Emotion) -> bool:
        """Order a mood; return whether that is another order than the one that stands."""
        self.commanded = emotion
        word = self._closest(emotion)
        if self.number and word == self._word:  # it would be the very same order
            if self._sent == self.number:
                self._felt = emotion
            if self._taken == word:
                self.acknowledged = emotion
            return False
        self._set(word)
        return True

    def stop(self) -> None:
        """Order the posture for a stop."""
        self.commanded = None
        self._set(None)

    def behave(self, behaviour: Behaviour) -> None:
        """Become another model: the order stays, what is done for it changes."""
        self._behaviour = behaviour
        if self.commanded is not None:
            self._word = self._closest(self.commanded)
        self.lose()

    @property
    def ordered(self) -> Mood | None:
        """The mood ordered."""
        return self._behaviour.moods[self._word] if self.number and self._word else None

    @property
    def held(self) -> Mood | None:
        """The mood ordered, where the robot shows it."""
        return self.ordered if self._taken == self._word else None

    @property
    def due(self) -> Command | None:
        """What is to be sent next; it stays due until it has landed."""
        return self._due[0] if self._due else None

    def send(self) -> Command | None:
        """Return what is due; whoever calls this sends it."""
        command = self.due
        if command is not None:
            self._sent, self._felt = self.number, self.commanded
            if command.word != self._taken:
                self._taken = None  # it is given up now; what was acknowledged stays the last
        return command

    def landed(self, command: Command) -> bool:
        """Take note that a posture or a pose has been echoed; return whether it is a new mood."""
        stands = command.order == self.number
        if stands:
            self._refusals = 0
            if self._due and self._due[0].line == command.line:
                self._due.popleft()
        if self._due if stands else not command.whole:
            return False
        new = not (self.stopped if command.word is None else self._taken)
        self._forget()
        if command.word is None:
            self.stopped = stands
        else:  # displaced while it was on its way, perhaps, and yet taken
            self.acknowledged, self._taken = self._felt, command.word
        if self._again:
            self.hold_again()
        return new

    def was_refused(self, command: Command) -> None:
        """Take note that the board does not know a posture: it is tried again, then left."""
        self._forget()
        if command.order != self.number:
            return
        self._refusals += 1
        if self._refusals >= REFUSED_TRIES:
            self._due.clear()

    def hold_again(self) -> None:
        """Make the whole order due: something has displaced it."""
        self._again = False
        self._due.clear()
        mood = self.ordered
        if mood is not None:
            self._due.append(self._posture(mood.posture, whole=not mood.pose))
            if mood.pose:
                self._due.append(self._pose(mood))
        elif self.number:
            self._due.append(self._posture(self._behaviour.stop, whole=True))

    def disturb(self) -> None:
        """Take note that the robot did something by itself, got up after a fall for example."""
        self._forget()
        if self._due:
            self._again = True
        else:
            self.hold_again()

    def let_go(self) -> None:
        """Take note that the robot lies without power: it shows nothing, and nothing is due."""
        self._forget()
        self._due.clear()

    def lose(self) -> None:
        """Take note that the robot may have lost it: it is due from its beginning."""
        self._forget()
        self._refusals = 0
        self.hold_again()

    def _set(self, word: str | None) -> None:
        self._word = word
        self.number += 1
        self._refusals = 0
        self.stopped = False
        self.hold_again()

    def _forget(self) -> None:
        """Write down that the robot is not known to hold anything."""
        self.acknowledged, self._taken, self.stopped = None, None, False

    def _closest(self, emotion: Emotion) -> str:
        return closest_word(tuple(self._behaviour.moods), emotion) or "neutral"

    def _posture(self, name: str, whole: bool) -> Command:
        line = tokens.skill(name)
        return Command("posture", line, name, POSTURE_WITHIN, self._word, self.number, whole)

    def _pose(self, mood: Mood) -> Command:
        line = tokens.pose(mood.pose)
        return Command("pose", line, "", POSE_WITHIN, self._word, self.number, whole=True)
