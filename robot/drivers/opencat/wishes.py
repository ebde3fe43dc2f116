"""What is sent next: the standing order, what is played once, gestures, and rest.

The standing order is a state, and is taken again after whatever displaced it: a gesture, a reboot,
a fall. Everything else is an event and is sent at most once. Skills keep their distance, and a
robot of which nobody wants anything is let lie down.
"""

from collections import deque

from affect import Emotion
from robot.contract.driver import MAX_QUEUED_ACTIONS
from robot.drivers.opencat import tokens
from robot.drivers.opencat.exchange import Command
from robot.drivers.opencat.order import POSTURE_WITHIN, StandingOrder
from robot.drivers.opencat.settings import Behaviour, Settings

GESTURE_WITHIN = 15.0
"""A skill takes at most so long [s]; a question asked earlier would break it off on new boards."""

MELODY_WITHIN = 3.0
"""A melody is echoed at most so long after its last note [s]."""

REST = Command("rest", tokens.REST, "", POSTURE_WITHIN)
"""The command to lie down and let go of the servos."""


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
        self.order = StandingOrder(behaviour)
        """The mood that is held, or the stop."""
        self.dropped = 0
        """Motions and sounds given up before they were sent."""
        self.refused = 0
        """Skills that the board does not know."""
        self.repeats = 0
        """Commands sent again because no echo came."""
        self.limp = False
        """Whether the servos have no power, as far as echoes tell."""
        self.resting = False
        """Whether the robot is to lie without power until something new is wanted."""
        self._settings, self._behaviour = settings, behaviour
        self._melody: str | None = None
        self._actions: deque[str] = deque()
        self._turn = 0  # which of the mood's gestures is next
        self._gesture_at: float | None = None  # None until the mood is held
        self._skill_from = 0.0
        self._touched = True  # whether the owner wanted something new since `next`
        self._idle_since = 0.0

    # --- What the owner asks for ---------------------------------------------------------------

    def express(self, emotion: Emotion) -> None:
        """Order a mood. Nothing is sent where the robot's word for it stays the same."""
        if self.order.express(emotion):
            mood = self.order.ordered
            self._melody = mood.sound if mood else None
            self._begin_order()

    def stop(self) -> None:
        """Order the posture for a stop, before and instead of everything that waits."""
        self.drop_actions()
        self._melody = None
        self.order.stop()
        self._begin_order()

    def play(self, name: str) -> bool:
        """Ask for a skill or a melody once; False if too many wait already."""
        if len(self._actions) >= MAX_QUEUED_ACTIONS:
            return False
        self._actions.append(name)
        self._touched = True
        return True

    def drop_actions(self) -> None:
        """Give up every motion and sound that waits."""
        self.dropped += len(self._actions)
        self._actions.clear()

    def behave(self, behaviour: Behaviour) -> None:
        """Become another model."""
        if behaviour is not self._behaviour:
            self._behaviour = behaviour
            self.drop_actions()
            self._melody = None
            self.order.behave(behaviour)

    # --- What is sent --------------------------------------------------------------------------

    def next(self, now: float) -> Command | None:
        """Return what is to be sent at time `now` [s]; whoever calls this sends it."""
        if self._touched:
            self._touched, self._idle_since = False, now
            if self.resting:
                self.resting = False
                self.order.lose()
        if self.resting:
            return None
        if not self.limp and 0 < self._settings.rest_after <= now - self._idle_since:
            self.resting = True
            return REST
        if self.order.due is not None:
            waits = self.order.due.kind == "posture" and now < self._skill_from
            return None if waits else self.order.send()
        if self._melody is not None:
            name, self._melody = self._melody, None
            return self._beep(name)
        if self._actions:
            return self._action(now)
        return self._gesture(now)

    # --- What became of it ---------------------------------------------------------------------

    def landed(self, command: Command, refused: bool, now: float) -> bool:
        """Take note that the board has echoed a command; return whether a mood or stop is new."""
        self._end_of_skill(command, now)
        if refused:
            self.refused += 1
            if command.kind == "posture":
                self.order.was_refused(command)
            return False
        if command.kind != "melody":
            self.limp = command.kind == "rest"
        if command.kind == "rest":
            self.order.let_go()
        elif command.kind in ("posture", "pose"):
            new = self.order.landed(command)
            mood = self.order.held
            if mood is not None and self._gesture_at is None:
                self._gesture_at = now + mood.gesture_every
            return new
        elif command.kind == "gesture":
            self.order.hold_again()
        return False

    def given_up(self, command: Command, now: float) -> None:
        """Take note that a command was not echoed: an order stays due, an event is gone."""
        self._end_of_skill(command, now)
        if command.kind == "gesture":
            self.order.hold_again()
        elif command.kind == "rest":
            self.resting = self.limp  # if it has not let go yet, it is due again at once
            self.repeats += 1
        elif command.kind in ("posture", "pose"):
            self.repeats += command.order == self.order.number

    def disturb(self) -> None:
        """Take note that the robot did something by itself."""
        if not self.resting:
            self.order.disturb()

    # --- Small things --------------------------------------------------------------------------

    def _begin_order(self) -> None:
        self._touched = True
        self._turn, self._gesture_at = 0, None

    def _end_of_skill(self, command: Command, now: float) -> None:
        if command.kind in ("posture", "gesture"):
            self._skill_from = now + self._settings.dwell

    def _action(self, now: float) -> Command | None:
        name = self._actions[0]
        if name in self._behaviour.sounds:
            return self._beep(self._actions.popleft())
        return self._skill(self._actions.popleft()) if now >= self._skill_from else None

    def _gesture(self, now: float) -> Command | None:
        mood = self.order.held
        if mood is None or not mood.gestures or not mood.gesture_every:
            return None
        if self._gesture_at is None or now < max(self._gesture_at, self._skill_from):
            return None
        self._gesture_at = now + mood.gesture_every
        name = mood.gestures[self._turn % len(mood.gestures)]
        self._turn = (self._turn + 1) % len(mood.gestures)
        return self._skill(name)

    def _skill(self, name: str) -> Command:
        self.order.stopped = False  # until its posture is taken again
        return Command("gesture", tokens.skill(name), name, GESTURE_WITHIN)

    def _beep(self, name: str) -> Command:
        notes = self._behaviour.sounds[name]
        within = sum(1.0 / value for _, value in notes) + MELODY_WITHIN
        return Command("melody", tokens.melody(notes), name, within)
