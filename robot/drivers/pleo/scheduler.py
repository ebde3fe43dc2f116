"""Decides which command is sent next: the desired state, or actions.

A mood that was replaced before it was sent is never sent, and a mood whose motion was lost is sent
again until it is answered: at worst the motion starts again. A sound, and a motion requested by
`play`, is sent at most once.
"""

from collections import deque
from collections.abc import Iterator

from cubeling.affect import Emotion
from cubeling.affect.words import closest_word
from cubeling.robot.contract.driver import MAX_QUEUED_ACTIONS
from cubeling.robot.drivers.commands import CommandQueue, DesiredState
from cubeling.robot.drivers.pleo import commands, timing
from cubeling.robot.drivers.pleo.commands import Command
from cubeling.robot.drivers.pleo.console import CommandResult
from cubeling.robot.drivers.pleo.device_state import (
    CommandStep,
    DeviceState,
    body_steps,
    sound_steps,
)
from cubeling.robot.drivers.pleo.settings import MotionFile, PleoMood, PleoSettings

STOP_WORD = ""
"""Takes the place of a mood's word for the neutral pose; no mood has an empty word."""


class StepScheduler:
    """The commands for one Pleo, over all its sessions."""

    def __init__(self, settings: PleoSettings) -> None:
        self.state = DesiredState()
        """The emotion or stop that was requested last."""
        self.actions: CommandQueue[CommandStep] = CommandQueue(MAX_QUEUED_ACTIONS)
        """Motions and sounds that wait."""
        self.retries = 0
        """Commands sent again."""
        self.refused = 0
        """Commands answered with an error."""
        self._settings = settings
        self._device = DeviceState()
        self._requested: str | None = None  # a mood, STOP_WORD, or nothing yet
        self._current: str | None = None  # the mood or STOP_WORD of `_steps`
        self._interrupted = False  # whether the current mood must begin again
        self._since = float("-inf")  # when the current mood began
        self._steps: deque[CommandStep] = deque()
        self._pending: CommandStep | None = None
        self._body_refused = False
        self._tries = 0
        self._repeat_at: float | None = None  # when the body steps are due again
        self._action_ends = float("-inf")

    def express(self, emotion: Emotion) -> None:
        """Request the mood that is closest to an emotion."""
        self.state.commanded = emotion
        word = self._requested = closest_word(tuple(self._settings.moods), emotion)
        if word is not None and word == self._current:
            self.state.follow(word, emotion, sent=True)

    def stop(self) -> None:
        """Request the neutral pose, before and instead of everything that waits."""
        self.actions.drop_all()
        acting = self._pending is not None and self._pending.part == "action"
        if self._current == STOP_WORD and (acting or self._action_ends > self._since):
            self._interrupted = True  # an action came between: take the pose again
        self.state.commanded, self._requested = None, STOP_WORD

    def play(self, motion: MotionFile | None, sound: str) -> bool:
        """Request a motion, or else a sound, once; return False if too many wait already."""
        timeout = self._settings.play_within
        if motion is not None:
            command = commands.motion_play(motion.file, timeout)
            return self.actions.add(CommandStep(command, "action", motion.length))
        return self.actions.add(CommandStep(commands.sound_play(sound, timeout), "action"))

    def end_session(self) -> None:
        """Drop waiting and pending actions; the desired state is sent again later."""
        self.actions.dropped += self._pending is not None and self._pending.part == "action"
        self.actions.drop_all()
        self._pending = self._current = self._repeat_at = None
        self.state.forget()
        self._since = self._action_ends = float("-inf")
        self._steps.clear()
        self._device = DeviceState()

    def record_start(self, command: Command, sent: float) -> None:
        """Record a command with which a session began."""
        self._device.record_send(command, sent)

    def next(self, now: float) -> Command | None:
        """Return the command to send at time `now` [s], if one is due."""
        step = self._next_step(now)
        if step is None:
            return None
        self._pending = step
        if step.part == "body":
            self._repeat_at = None
            self.state.begin(self._current)
        if step.length:
            self._device.forget_angles()
        if step.part in ("action", "body"):
            self.state.stopped = False
        self._device.record_send(step.command, now)
        return step.command

    def complete(self, result: CommandResult) -> bool:
        """Process the result of the last command; return whether a new mood or stop is taken."""
        step, self._pending = self._pending, None
        if step is None:
            return False
        if result.outcome != "answered":
            self._device = DeviceState()
            self._recover(step)
            return False
        if result.answer.error is not None:
            self.refused += 1
            self._device.record_refusal(step.command)
            self._body_refused |= step.part == "body"
        if step.part == "action" and step.length:
            self._resume_after(result.sent + step.length)
        if step.part == "body" and not any(later.part == "body" for later in self._steps):
            return self._complete_body(result.sent)
        return False

    def _next_step(self, now: float) -> CommandStep | None:
        if self._requested != self._current and self._steps:
            self._steps.clear()
            self._interrupted = True
        if self._mood_due(now):
            self._begin_mood(now)
        if self._steps:
            may_send = self._device.may_send(self._steps[0].command, now)
            return self._steps.popleft() if may_send else None
        if now < self._action_ends:
            return None
        if self.actions:
            return self.actions.popleft()
        repeat_due = self._repeat_at is not None and now >= self._repeat_at
        if repeat_due and self._current == self._requested:
            self._body_refused = False
            self._steps.extend(self._body_steps())
            return self._steps.popleft()
        return None

    def _mood_due(self, now: float) -> bool:
        """Return whether another mood, or an interrupted one, must begin now."""
        if self._requested is None or (self._requested == self._current and not self._interrupted):
            return False
        return self._requested == STOP_WORD or now - self._since >= self._settings.mood_every

    def _begin_mood(self, now: float) -> None:
        self._current, self._since = self._requested, now
        self.state.sent = self.state.commanded
        self._interrupted, self._body_refused = False, False
        self._tries, self._repeat_at = 1, None
        self._action_ends = float("-inf")
        timeout = self._settings.play_within
        self._steps = deque([*self._body_steps(), *sound_steps(self._mood, self._device, timeout)])

    @property
    def _mood(self) -> PleoMood | None:
        """The current mood; None for the neutral pose of a stop, or for nothing."""
        return self._settings.moods.get(self._current or STOP_WORD)

    def _body_steps(self) -> Iterator[CommandStep]:
        return body_steps(self._mood, self._device, self._settings.play_within)

    def _recover(self, step: CommandStep) -> None:
        """Handle a command that the console may or may not have executed."""
        if step.part == "action":
            self.actions.dropped += 1
        elif step.part != "sound":
            self.retries += 1
            self.state.forget()
            sounds = [later for later in self._steps if later.part == "sound"]
            self._steps = deque([*self._body_steps(), *sounds])
            self._body_refused = False

    def _resume_after(self, ends: float) -> None:
        """Let the mood return when the motion of an action ends [s]."""
        self._action_ends = ends
        mood = self._mood
        if mood is not None and (mood.loop or mood.motion is None):
            self._repeat_at = ends

    def _complete_body(self, sent: float) -> bool:
        """Process the last body step of a mood; return whether a new mood or stop is taken."""
        mood, refused = self._mood, self._body_refused
        new = not refused and not (self.state.stopped if mood is None else self.state.shown)
        if refused:
            self.state.forget()
        elif mood is None:
            self.state.confirm(None, stopped=True)
        else:
            self.state.confirm(self.state.sent, self._current)
        if mood is not None and mood.motion is not None and mood.loop:
            self._repeat_at = sent + mood.round
        elif refused and self._tries < timing.MAX_REFUSED_TRIES:
            self._tries += 1
            self._repeat_at = sent + timing.REFUSED_RETRY_DELAY_S
        return new
