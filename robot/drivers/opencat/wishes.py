"""What is sent next: the mood that is held, what is played once, gestures, and rest.

The *standing order*, a mood or a stop, is a state: only the latest counts, and it is taken again
after whatever displaced it: a gesture, a reboot, a fall. Everything else is an event and is sent at
most once. Skills keep their distance, and a robot of which nobody wants anything is let lie down.
"""

from collections import deque
from collections.abc import Iterator
from itertools import cycle

from robot.drivers.opencat import tokens
from robot.drivers.opencat.exchange import Command
from robot.drivers.opencat.settings import Behaviour, Mood, Settings
from robot.emotion import Emotion
from robot.feeling.words import closest_word

POSTURE_WITHIN = 5.0
"""A posture takes at most so long [s]; a joint that goes from end to end needs under 2 s."""

GESTURE_WITHIN = 15.0
"""A skill takes at most so long [s]; a question asked earlier would break it off on new boards."""

POSE_WITHIN = 4.0
"""A pose takes at most so long [s]."""

MELODY_WITHIN = 3.0
"""A melody is echoed at most so long after its last note [s]."""

ACTIONS_MAX = 4
"""Motions and sounds that may wait to be sent; more are refused."""

REFUSED_TRIES = 2
"""An order that a board did not know is sent so often: the first time may have been a wrong bit."""


class Wishes:
    """What the owner and the settings want of a robot.

    Parameters
    ----------
    settings
        The rates.
    behaviour
        What the model does for which mood.
    """

    def __init__(self, settings: Settings, behaviour: Behaviour) -> None:
        self.commanded: Emotion | None = None
        """The emotion that was last asked for; None before, and after a stop."""
        self.dropped = 0
        """Motions and sounds given up before they were sent."""
        self.refused = 0
        """Skills that the board does not know."""
        self.repeats = 0
        """Orders sent again because no echo came."""
        self.stopped = False
        """Whether the robot has taken the posture for a stop, and is to keep it."""
        self.limp = False
        """Whether the servos have no power, as far as echoes tell."""
        self._settings, self._behaviour = settings, behaviour
        self._label: str | None = None
        self._word: str | None = None  # the mood ordered; None for a stop
        self._order = 0  # counts orders; 0 while there is none
        self._due: deque[Command] = deque()  # what is left of the standing order
        self._shown: tuple[str, Emotion] | None = None
        self._refusals = 0
        self._disturbed = False
        self._melody: str | None = None
        self._actions: deque[str] = deque()
        self._gestures: Iterator[str] = iter(())
        self._gesture_at: float | None = None
        self._skill_from = 0.0
        self._touched = True  # whether the owner wanted something new since `next`
        self._idle_since = 0.0
        self._resting = False

    # --- What the owner asks for ---------------------------------------------------------------

    def express(self, emotion: Emotion, label: str | None) -> None:
        """Order a mood. Nothing is sent where the robot's word for it stays the same."""
        self.commanded, self._label = emotion, label
        word = closest_word(tuple(self._behaviour.moods), emotion, label) or "neutral"
        if self._order and word == self._word:
            return
        self._melody = self._behaviour.moods[word].sound
        self._set_order(word)

    def stop(self) -> None:
        """Order the posture for a stop, before and instead of everything that waits."""
        self.drop_actions()
        self.commanded = self._label = self._melody = None
        self._set_order(None)

    def play(self, name: str) -> bool:
        """Ask for a skill or a melody once; False if too many wait already."""
        if len(self._actions) >= ACTIONS_MAX:
            return False
        self._actions.append(name)
        self._touched = True
        return True

    def drop_actions(self) -> None:
        """Give up every motion and sound that waits."""
        self.dropped += len(self._actions)
        self._actions.clear()

    @property
    def acknowledged(self) -> Emotion | None:
        """The emotion that the robot has taken and still holds; None if it holds none.

        A new emotion with the same word is taken as soon as it is asked for.
        """
        if self._shown is None:
            return None
        word, emotion = self._shown
        same = word == self._word and self.commanded is not None
        return self.commanded if same else emotion

    def behave(self, behaviour: Behaviour) -> None:
        """Become another model."""
        if behaviour is self._behaviour:
            return
        self._behaviour = behaviour
        self.drop_actions()
        self._melody = None
        if self.commanded is not None:
            self._word = closest_word(tuple(behaviour.moods), self.commanded, self._label)
            self._word = self._word or "neutral"
        self.restate()

    # --- What is sent --------------------------------------------------------------------------

    def next(self, now: float) -> Command | None:
        """Return what is to be sent at time `now` [s]; whoever calls this sends it."""
        if self._touched:
            self._touched, self._idle_since = False, now
            if self._resting:
                self._resting = False
                self.restate()
        if self._resting:
            return None
        if self._rest_is_due(now):
            self._resting = True
            return self.rest()
        if self._due:
            first = self._due[0]
            return first if first.kind != "posture" or now >= self._skill_from else None
        if self._melody is not None:
            name, self._melody = self._melody, None
            return self._beep(name)
        if self._actions:
            if self._actions[0] in self._behaviour.sounds:
                return self._beep(self._actions.popleft())
            return self._skill(self._actions.popleft()) if now >= self._skill_from else None
        return self._gesture(now)

    def rest(self) -> Command:
        """Return the command to lie down and let go of the servos."""
        return Command("rest", tokens.REST, "", POSTURE_WITHIN)

    @property
    def resting(self) -> bool:
        """Whether the robot is to lie without power until something new is wanted."""
        return self._resting

    # --- What became of it ---------------------------------------------------------------------

    def landed(self, command: Command, refused: bool, now: float) -> None:
        """Take note that the board has echoed a command."""
        if command.kind in ("posture", "gesture"):
            self._skill_from = now + self._settings.dwell
        if refused:
            self._was_refused(command)
            return
        if command.kind in ("posture", "gesture", "pose", "rest"):
            self.limp = command.kind == "rest"
        if command.kind == "rest":
            self._shown, self.stopped = None, False
        if command.kind in ("posture", "pose") and command.order == self._order:
            self._refusals = 0
            self._take_off(command)
            if not self._due:
                self._was_shown(command, now)
        if command.kind == "gesture" or (self._disturbed and not self._due):
            self._disturbed = False
            self._hold_again()

    def given_up(self, command: Command, now: float) -> None:
        """Take note that a command was not echoed: an order stays due, an event is gone."""
        if command.kind in ("posture", "gesture"):
            self._skill_from = now + self._settings.dwell
        if command.kind in ("posture", "pose"):
            self.repeats += command.order == self._order
        elif command.kind == "rest":
            self._resting = False  # it is due again at once
            self.repeats += 1
        elif command.kind == "gesture":
            self._hold_again()

    def restate(self) -> None:
        """Take the standing order again, from its beginning: the robot may have lost it."""
        self._shown, self.stopped, self._disturbed = None, False, False
        self._hold_again()

    def disturb(self) -> None:
        """Take note that the robot did something by itself, got up after a fall for example."""
        if self._due:
            self._disturbed = True
        elif not self._resting:
            self._hold_again()

    # --- Small things --------------------------------------------------------------------------

    def _set_order(self, word: str | None) -> None:
        self._word = word
        self._order += 1
        self._refusals = 0
        self.stopped = False
        self._touched = True
        self._gesture_at = None
        self._hold_again()

    def _hold_again(self) -> None:
        """Make the whole standing order due."""
        self._due.clear()
        if not self._order:
            return
        if self._word is None:
            self._due.append(self._posture(self._behaviour.stop))
            return
        mood = self._behaviour.moods[self._word]
        self._due.append(self._posture(mood.posture))
        if mood.pose:
            line = tokens.pose(mood.pose)
            self._due.append(Command("pose", line, "", POSE_WITHIN, self._word, self._order))

    def _posture(self, name: str) -> Command:
        line = tokens.skill(name)
        return Command("posture", line, name, POSTURE_WITHIN, self._word, self._order)

    def _take_off(self, command: Command) -> None:
        if self._due and self._due[0] == command:
            self._due.popleft()

    def _was_shown(self, command: Command, now: float) -> None:
        if command.word is None:
            self.stopped, self._shown = True, None
        elif self.commanded is not None:
            self._shown = command.word, self.commanded
            if self._gesture_at is None:
                mood = self._behaviour.moods[command.word]
                self._gestures = cycle(mood.gestures)
                self._gesture_at = now + mood.gesture_every

    def _was_refused(self, command: Command) -> None:
        self.refused += 1
        if command.kind == "posture" and command.order == self._order:
            self._refusals += 1
            if self._refusals >= REFUSED_TRIES:
                self._shown = None
                self._due.clear()

    def _rest_is_due(self, now: float) -> bool:
        after = self._settings.rest_after
        return not self.limp and 0 < after <= now - self._idle_since

    def _mood(self) -> Mood | None:
        return self._behaviour.moods[self._word] if self._word and self._shown else None

    def _gesture(self, now: float) -> Command | None:
        mood = self._mood()
        if mood is None or not mood.gestures or not mood.gesture_every:
            return None
        if self._gesture_at is None or now < max(self._gesture_at, self._skill_from):
            return None
        self._gesture_at = now + mood.gesture_every
        return self._skill(next(self._gestures))

    def _skill(self, name: str) -> Command:
        return Command("gesture", tokens.skill(name), name, GESTURE_WITHIN)

    def _beep(self, name: str) -> Command:
        notes = self._behaviour.sounds[name]
        within = sum(1.0 / value for _, value in notes) + MELODY_WITHIN
        return Command("melody", tokens.melody(notes), name, within)
