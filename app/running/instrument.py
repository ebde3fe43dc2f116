"""Other programs and devices that follow a session while it plays, and may ask for something."""

from collections.abc import Sequence

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import RobotView, Step
from cubeling.characters import Character
from cubeling.robot import Closeable


class Instrument(Closeable):
    """What follows a session: players on a network, OSC, VMC, LSL. Whoever opens it closes it.

    No call waits for the other side: what it does not take is dropped. Each kind overrides what
    it needs.
    """

    speaks = False
    """Whether it may ask a character to say something."""

    robot: RobotView | None = None
    """The robot as it was with the last frame; None before the first."""

    def begin(self, cast: Sequence[Character]) -> None:
        """Prepare for the characters of a session that begins; raises one line for the user."""

    def follow(self, step: Step, cast: Sequence[Character], taken: float) -> Inputs:
        """Publish a step, and return what was asked for since the one before.

        Parameters
        ----------
        step
            What has happened.
        cast
            Its characters.
        taken
            When its frame was taken, by `time.monotonic` [s]; in a replay, when it was due.
        """
        return Inputs()

    def happen(self, event: str, taken: float) -> None:
        """Publish that something has happened, in the words of a recording's events."""

    def close(self) -> None:
        """Let go of the other side; a second call does nothing."""
