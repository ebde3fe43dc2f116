"""The screens that show finished pictures: this one shows none; others are files or a window."""

from typing import Protocol

from app.pipeline.scenario import Inputs
from app.pipeline.step import RobotView, Step
from app.ui.notice import Notice


class Screen(Protocol):
    """Shows one picture a frame. Whoever opens it closes it; a second `close` does nothing."""

    def show(self, step: Step, robot: RobotView) -> Inputs:
        """Show a step, and return the player's inputs."""

    def wait(self, notice: Notice | None) -> None:
        """Process events while no frame comes, and show a notice if there is one.

        The next `show` returns keys that are pressed in the meantime.
        """

    @property
    def closed(self) -> bool:
        """Whether the player has closed it."""

    def close(self) -> None:
        """Close it."""


class NullScreen:
    """Shows nothing: for benchmarks and for recordings without pictures."""

    closed = False

    def show(self, step: Step, robot: RobotView) -> Inputs:
        """Do nothing."""
        return Inputs()

    def wait(self, notice: Notice | None) -> None:
        """Do nothing."""

    def close(self) -> None:
        """Do nothing."""
