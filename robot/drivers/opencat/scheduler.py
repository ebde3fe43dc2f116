"""Decides which command is sent next: the desired state, actions, gestures or rest.

The desired state is taken again after whatever displaced it: a gesture, a reboot, a fall. All other
commands are sent at most once. Skills keep their dwell time, and an idle robot is let lie down.
"""

from cubeling.affect import Emotion
from cubeling.robot.contract.driver import MAX_QUEUED_ACTIONS
from cubeling.robot.drivers.commands import CommandQueue
from cubeling.robot.drivers.opencat import tokens
from cubeling.robot.drivers.opencat.desired_posture import POSTURE_TIMEOUT_S, DesiredPosture
from cubeling.robot.drivers.opencat.echo import BoardCommand
from cubeling.robot.drivers.opencat.settings import ModelBehaviour, OpenCatSettings

GESTURE_TIMEOUT_S = 15.0
"""Longest time of a skill [s]; an earlier question would interrupt it on new boards."""

MELODY_TIMEOUT_S = 3.0
"""Longest time from the last note of a melody to its echo [s]."""

REST_COMMAND = BoardCommand("rest", tokens.REST, "", POSTURE_TIMEOUT_S)
"""The command to lie down and switch the servos off."""


class SkillScheduler:
    """The commands for one board, over all its sessions."""

    def __init__(self, settings: OpenCatSettings, behaviour: ModelBehaviour) -> None:
        self.desired = DesiredPosture(behaviour)
        """The mood or stop that was requested last."""
        self.actions: CommandQueue[str] = CommandQueue(MAX_QUEUED_ACTIONS)
        """Motions and sounds that wait, by name."""
        self.refused = 0
        """Skills that the board does not know."""
        self.retries = 0
        """Commands sent again because no echo came."""
        self.limp = False
        """Whether the servos are off, according to the echoes."""
        self.resting = False
        """Whether the servos stay off until the next request."""
        self._settings, self._behaviour = settings, behaviour
        self._melody: str | None = None
        self._gesture_index = 0
        self._gesture_at: float | None = None  # None until the mood is shown
        self._skill_from = 0.0
        self._requested = True  # whether there was a request since `next`
        self._idle_since = 0.0

    def express(self, emotion: Emotion) -> None:
        """Request an emotion. Nothing is sent while the robot's word for it is the same."""
        if self.desired.express(emotion):
            mood = self.desired.requested_mood
            self._melody = mood.sound if mood else None
            self._restart_gestures()

    def stop(self) -> None:
        """Request the posture for a stop, before and instead of everything that waits."""
        self.actions.drop_all()
        self._melody = None
        self.desired.stop()
        self._restart_gestures()

    def play(self, name: str) -> bool:
        """Request a skill or a melody once; return False if too many wait already."""
        taken = self.actions.add(name)
        self._requested |= taken
        return taken

    def set_behaviour(self, behaviour: ModelBehaviour) -> None:
        """Use the behaviour of another model."""
        if behaviour is not self._behaviour:
            self._behaviour = behaviour
            self.actions.drop_all()
            self._melody = None
            self.desired.set_behaviour(behaviour)

    def next(self, now: float) -> BoardCommand | None:
        """Return the command for time `now` [s], if one is due; the caller sends it."""
        if self._requested:
            self._requested, self._idle_since = False, now
            if self.resting:
                self.resting = False
                self.desired.lose()
        if self.resting:
            return None
        if not self.limp and 0 < self._settings.rest_after <= now - self._idle_since:
            self.resting = True
            return REST_COMMAND
        if self.desired.due is not None:
            waits = self.desired.due.kind == "posture" and now < self._skill_from
            return None if waits else self.desired.send()
        if self._melody is not None:
            name, self._melody = self._melody, None
            return self._play_melody(name)
        if self.actions:
            return self._next_action(now)
        return self._next_gesture(now)

    def complete(self, command: BoardCommand, refused: bool, now: float) -> bool:
        """Process the echo of a command; return whether a new mood or stop is taken."""
        self._end_skill(command, now)
        if refused:
            self.refused += 1
            if command.kind == "posture":
                self.desired.refuse(command)
            return False
        if command.kind != "melody":
            self.limp = command.kind == "rest"
        if command.kind == "rest":
            self.desired.let_go()
        elif command.kind in ("posture", "pose"):
            new = self.desired.complete(command)
            mood = self.desired.shown_mood
            if mood is not None and self._gesture_at is None:
                self._gesture_at = now + mood.gesture_every
            return new
        elif command.kind == "gesture":
            self.desired.repeat()
        return False

    def give_up(self, command: BoardCommand, now: float) -> None:
        """Process a command without an echo: the desired state remains due, an action is gone."""
        self._end_skill(command, now)
        if command.kind == "gesture":
            self.desired.repeat()
        elif command.kind == "rest":
            self.resting = self.limp  # otherwise it is due again at once
            self.retries += 1
        elif command.kind in ("posture", "pose"):
            self.retries += command.order == self.desired.number

    def disturb(self) -> None:
        """Record that the robot moved by itself."""
        if not self.resting:
            self.desired.disturb()

    def _restart_gestures(self) -> None:
        self._requested = True
        self._gesture_index, self._gesture_at = 0, None

    def _end_skill(self, command: BoardCommand, now: float) -> None:
        if command.kind in ("posture", "gesture"):
            self._skill_from = now + self._settings.dwell

    def _next_action(self, now: float) -> BoardCommand | None:
        if self.actions[0] in self._behaviour.sounds:
            return self._play_melody(self.actions.popleft())
        return self._play_skill(self.actions.popleft()) if now >= self._skill_from else None

    def _next_gesture(self, now: float) -> BoardCommand | None:
        mood = self.desired.shown_mood
        if mood is None or not mood.gestures or not mood.gesture_every:
            return None
        if self._gesture_at is None or now < max(self._gesture_at, self._skill_from):
            return None
        self._gesture_at = now + mood.gesture_every
        name = mood.gestures[self._gesture_index % len(mood.gestures)]
        self._gesture_index = (self._gesture_index + 1) % len(mood.gestures)
        return self._play_skill(name)

    def _play_skill(self, name: str) -> BoardCommand:
        self.desired.stopped = False  # until its posture is taken again
        return BoardCommand("gesture", tokens.skill(name), name, GESTURE_TIMEOUT_S)

    def _play_melody(self, name: str) -> BoardCommand:
        notes = self._behaviour.sounds[name]
        timeout = sum(1.0 / value for _, value in notes) + MELODY_TIMEOUT_S
        return BoardCommand("melody", tokens.melody(notes), name, timeout)
