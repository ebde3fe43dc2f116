"""What is sent to Pleo next: a mood or a stop, which are states, and actions, which are events.

Of moods and stops only the latest counts. What was superseded before it was sent is never sent,
and a mood whose motion was lost on its way is sent again until it is answered: that begins the
motion anew, at worst. A sound, and a motion asked for by `play`, is sent once and never again.
"""

from collections import deque
from collections.abc import Iterator

from affect import Emotion
from affect.words import closest_word
from robot.contract.driver import MAX_QUEUED_ACTIONS
from robot.drivers.pleo import commands, timing
from robot.drivers.pleo.commands import Command
from robot.drivers.pleo.console import Landing
from robot.drivers.pleo.known import Known
from robot.drivers.pleo.settings import Clip, Mood, Settings
from robot.drivers.pleo.steps import Step, body_steps, sound_steps

STOP = ""
"""Stands for the neutral pose where else a mood's name stands; no mood has an empty name."""


class Wishes:
    """What is wanted of one Pleo, over all its sessions.

    Parameters
    ----------
    settings
        What stands for each mood.
    """

    def __init__(self, settings: Settings) -> None:
        self.commanded: Emotion | None = None
        """The emotion that was last asked for; None before, and after a stop."""
        self.acknowledged: Emotion | None = None
        """What was last felt of the mood that the console last took without an error; None before,
        and once it may have lost it: at a lost answer, for it may have restarted, or an error."""
        self.stopped = False
        """Whether the console has taken the neutral pose of a `stop`, and nothing since."""
        self.retries = 0
        """Commands sent again."""
        self.refused = 0
        """Commands answered with an error text."""
        self.dropped = 0
        """Actions given up before they were answered."""
        self._settings = settings
        self._known = Known()
        self._wanted: str | None = None  # a mood, STOP, or nothing yet
        self._doing: str | None = None  # what the last program is for
        self._feeling: Emotion | None = None  # and which emotion
        self._taken: str | None = None  # the mood acknowledged, while nothing displaces it
        self._cut = False  # whether it was broken off, so that it must begin anew
        self._since = float("-inf")  # when it began
        self._steps: deque[Step] = deque()
        self._flight: Step | None = None
        self._flawed = False  # whether its body's part was refused
        self._tries = 0
        self._repeat_at: float | None = None  # when its body's part is due again
        self._actions: deque[Step] = deque()
        self._action_ends = float("-inf")

    # --- What is asked for ---------------------------------------------------------------------

    def express(self, emotion: Emotion) -> None:
        """Want the mood that is closest."""
        self.commanded = emotion
        self._wanted = closest_word(tuple(self._settings.moods), emotion)
        if self._wanted == self._doing:  # it would be the very same command
            self._feeling = emotion
            if self._taken == self._doing:
                self.acknowledged = emotion

    def stop(self) -> None:
        """Want the neutral pose, before and instead of everything that waits."""
        self._drop_actions()
        acting = self._flight is not None and self._flight.part == "action"
        if self._doing == STOP and (acting or self._action_ends > self._since):
            self._cut = True  # an action came between: take the pose again
        self.commanded, self._wanted = None, STOP

    def play(self, motion: Clip | None, sound: str) -> bool:
        """Want a motion, or else a sound, once; False if too many wait already."""
        if len(self._actions) >= MAX_QUEUED_ACTIONS:
            return False
        within = self._settings.play_within
        if motion is not None:
            command = commands.motion_play(motion.file, within)
            self._actions.append(Step(command, "action", motion.length))
        else:
            self._actions.append(Step(commands.sound_play(sound, within), "action"))
        return True

    def break_off(self) -> None:
        """Lose the session: actions are dropped, and what is wanted will be sent anew."""
        if self._flight is not None and self._flight.part == "action":
            self.dropped += 1
        self._drop_actions()
        self._flight = self._doing = self._repeat_at = None
        self._lose()
        self._since = self._action_ends = float("-inf")
        self._steps.clear()
        self._known = Known()

    def began(self, command: Command, sent: float) -> None:
        """Hear of a command with which a session began."""
        self._known.sent(command, sent)

    # --- What is sent --------------------------------------------------------------------------

    def next(self, now: float) -> Command | None:
        """Return the command to be sent at time `now` [s], if one is due."""
        step = self._next(now)
        if step is None:
            return None
        self._flight = step
        if step.part == "body":
            self._repeat_at = None
            if self._taken != self._doing:
                self._taken = None  # it is given up now; what was acknowledged stays the last
        if step.length:
            self._known.motion_played()
        if step.part in ("action", "body"):
            self.stopped = False
        self._known.sent(step.command, now)
        return step.command

    def land(self, landing: Landing) -> bool:
        """Hear that the last command has ended, and how; return whether a mood or stop is new."""
        step, self._flight = self._flight, None
        if step is None:
            return False
        if landing.outcome != "answered":
            self._known = Known()
            self._recover(step)
            return False
        if landing.answer.error is not None:
            self.refused += 1
            self._known.refused(step.command)
            self._flawed |= step.part == "body"
        if step.part == "action" and step.length:
            self._acted(landing.sent + step.length)
        if step.part == "body" and not any(one.part == "body" for one in self._steps):
            return self._shown(landing.sent)
        return False

    def _next(self, now: float) -> Step | None:
        if self._wanted != self._doing and self._steps:
            self._steps.clear()
            self._cut = True
        if self._is_due(now):
            self._begin(now)
        if self._steps:
            free = self._known.free(self._steps[0].command, now)
            return self._steps.popleft() if free else None
        if now < self._action_ends:
            return None
        if self._actions:
            return self._actions.popleft()
        if self._repeat_at is not None and now >= self._repeat_at and self._doing == self._wanted:
            self._flawed = False
            self._steps.extend(self._showing())
            return self._steps.popleft()
        return None

    def _is_due(self, now: float) -> bool:
        """Whether another mood, or the same one broken off, is to begin now."""
        if self._wanted is None or (self._wanted == self._doing and not self._cut):
            return False
        return self._wanted == STOP or now - self._since >= self._settings.mood_every

    def _begin(self, now: float) -> None:
        """Begin the program for what is wanted."""
        self._doing, self._feeling, self._since = self._wanted, self.commanded, now
        self._cut, self._flawed, self._tries, self._repeat_at = False, False, 1, None
        self._action_ends = float("-inf")
        within = self._settings.play_within
        self._steps = deque([*self._showing(), *sound_steps(self._mood, self._known, within)])

    @property
    def _mood(self) -> Mood | None:
        """The mood that is being shown; None for the neutral pose of a stop, or for nothing."""
        return self._settings.moods.get(self._doing or STOP)

    def _showing(self) -> Iterator[Step]:
        return body_steps(self._mood, self._known, self._settings.play_within)

    # --- What came of it -----------------------------------------------------------------------

    def _recover(self, step: Step) -> None:
        """Decide what becomes of a command that may have been taken or not."""
        if step.part == "action":
            self.dropped += 1
        elif step.part != "sound":
            self.retries += 1
            self._lose()
            sounds = [one for one in self._steps if one.part == "sound"]
            self._steps = deque([*self._showing(), *sounds])
            self._flawed = False

    def _acted(self, ends: float) -> None:
        """Write down until when an action's motion lasts, after which the mood returns."""
        self._action_ends = ends
        mood = self._mood
        if mood is not None and (mood.loop or mood.motion is None):
            self._repeat_at = ends

    def _shown(self, sent: float) -> bool:
        """Write down what the console has taken, after the last command of the body's part."""
        mood = self._mood
        new = not self._flawed and (not self.stopped if mood is None else not self._taken)
        self._lose()
        if mood is not None and not self._flawed:
            self.acknowledged, self._taken = self._feeling, self._doing
        self.stopped = mood is None and not self._flawed
        if mood is not None and mood.motion is not None and mood.loop:
            self._repeat_at = sent + mood.round
        elif self._flawed and self._tries < timing.REFUSED_MAX:
            self._tries += 1
            self._repeat_at = sent + timing.REFUSED_AGAIN
        return new

    def _lose(self) -> None:
        """Write down that nothing is known to be held."""
        self.acknowledged, self._taken, self.stopped = None, None, False

    def _drop_actions(self) -> None:
        self.dropped += len(self._actions)
        self._actions.clear()
