"""The screens that show finished pictures: this one shows none; others are files or a window."""

from typing import Protocol

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import RobotView, Step
from cubeling.app.ui.notice import Notice
from cubeling.app.ui.playback.requests import SessionRequest
from cubeling.app.ui.playback.status import SessionStatus


class Screen(Protocol):
    """Shows one picture a frame. Whoever opens it closes it; a second `close` does nothing."""

    attended: bool
    """Whether someone sits in front of it: it then stays open at the end of a recording."""

    def show(self, step: Step, robot: RobotView) -> Inputs:
        """Show a step, and return what the player asks of the scenario."""

    def preview(self, step: Step, robot: RobotView) -> None:
        """Show a step on the way to the one that is sought, and process events."""

    def wait(self, notice: Notice | None) -> None:
        """Process events while no frame comes, and show a notice if there is one.

        The next `show` returns keys that are pressed in the meantime.
        """

    def take_requests(self) -> tuple[SessionRequest, ...]:
        """Return what the player has asked of the session since the last call."""

    def report(self, status: SessionStatus) -> None:
        """Show a state of the session, from the next picture on."""

    def notify(self, words: str) -> None:
        """Show a notice for some seconds: one short line."""

    @property
    def closed(self) -> bool:
        """Whether the player has closed it."""

    def close(self) -> None:
        """Close it; a second call does nothing."""


class NullScreen:
    """Shows nothing, and nobody asks anything: for benchmarks and what is drawn for nobody."""

    attended = False
    closed = False

    def show(self, step: Step, robot: RobotView) -> Inputs:
        """Return what nobody asks for."""
        return Inputs()

    def preview(self, step: Step, robot: RobotView) -> None:
        """Do nothing: nobody looks."""

    def wait(self, notice: Notice | None) -> None:
        """Do nothing: nobody looks."""

    def take_requests(self) -> tuple[SessionRequest, ...]:
        """Return nothing, as nobody asks."""
        return ()

    def report(self, status: SessionStatus) -> None:
        """Do nothing: nobody looks."""

    def notify(self, words: str) -> None:
        """Do nothing: nobody looks."""

    def close(self) -> None:
        """Do nothing: nothing was opened."""
