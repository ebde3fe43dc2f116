"""Sessions that nobody watches and that end: with the last line that is typed, or by themselves."""

from collections.abc import Iterable
from dataclasses import replace

from cubeling.app.pipeline.scenario import OVER_EVENT, Inputs
from cubeling.app.pipeline.step import RobotView, Step
from cubeling.app.ui.notice import Notice
from cubeling.app.ui.playback.requests import SessionRequest
from cubeling.app.ui.playback.status import SessionStatus
from cubeling.app.ui.screen import Screen

PAUSE_S = 1.2
"""From the end of what the character says to the next line [s]."""

END_S = 2.0
"""From the end of the last reply to the end of the session [s]."""


class TypedLines:
    """A `Screen` in front of which lines are typed; after the last reply it is closed.

    The times are those of the frames, so that the same lines give the same session.

    Parameters
    ----------
    screen
        Where the steps go; the caller closes it.
    lines
        What is typed. Empty ones are left out; they are read one by one, as from a terminal. None
        to type nothing, and to end when the scenario is over.
    """

    def __init__(self, screen: Screen, lines: Iterable[str] | None) -> None:
        self._screen = screen
        self._ends = lines is not None
        self._lines = (line.strip() for line in lines or () if line.strip())
        self._next: str | None = ""
        self._quiet_since: float | None = None
        self._over = False
        self.attended = screen.attended

    def show(self, step: Step, robot: RobotView) -> Inputs:
        """Show a step, and return the next line if it is time."""
        inputs = self._screen.show(step, robot)
        now = step.frame.timestamp
        speeches = [each.command.speech for each in step.cast]
        talks = any(speech is not None and now < speech.end for speech in speeches)
        talks |= any(each.outcome.reply is not None for each in step.cast)
        if talks or self._quiet_since is None or not step.posed.visible:
            self._quiet_since = now
        quiet = now - self._quiet_since
        if self._next == "" and quiet >= PAUSE_S:
            self._next = next(self._lines, None)
        if self._next:
            said, self._next, self._quiet_since = self._next, "", now
            return replace(inputs, typed=said)
        if self._ends:
            self._over = self._next is None and quiet >= END_S
        else:
            self._over = OVER_EVENT in step.outcome.events
        return inputs

    def preview(self, step: Step, robot: RobotView) -> None:
        """Show a step on the way to another one."""
        self._screen.preview(step, robot)

    def wait(self, notice: Notice | None) -> None:
        """Process events while no frame comes."""
        self._screen.wait(notice)

    def take_requests(self) -> tuple[SessionRequest, ...]:
        """Return what the player has asked of the session."""
        return self._screen.take_requests()

    def report(self, status: SessionStatus) -> None:
        """Show a state of the session."""
        self._screen.report(status)

    def notify(self, words: str) -> None:
        """Show a notice for some seconds: one short line."""
        self._screen.notify(words)

    @property
    def closed(self) -> bool:
        """Whether all is said, or the screen is closed."""
        return self._over or self._screen.closed

    def close(self) -> None:
        """Close the screen; a second call does nothing."""
        self._screen.close()
