"""The robot of a session: a real one, a simulated one on a real port, or none."""

import time
from collections.abc import Callable
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Self

from cubeling.affect import NEUTRAL, closest_word
from cubeling.app.pipeline.choices import ROBOT_NAMES
from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.app.pipeline.step import RobotView
from cubeling.robot import (
    Closeable,
    Direction,
    LogLine,
    RobotError,
)

if TYPE_CHECKING:
    from cubeling.robot import Robot, SteppedRobot

OnBytes = Callable[[Direction, bytes, float], None]
"""Called with a direction, bytes and the time of the robot's clock [s] for all on the wire."""

Clock = Callable[[], float]
"""Returns the time of the session [s]."""


def is_real_robot(url: str) -> bool:
    """Return whether a URL, as `RobotLine.open` takes it, names a robot that lives in real time.

    >>> [is_real_robot(url) for url in ("none", "sim", "sim:pleo", "pleo:/dev/ttyACM0")]
    [False, False, False, True]
    """
    return url not in ("none", "sim") and not url.startswith("sim:")


class RobotLine(Closeable):
    """Sends the emotions of a session to a robot, and reads its state.

    `open` it before the session and `close` it after; a second `close` does nothing. Once it is
    connected, no method waits for the robot.
    """

    def __init__(
        self,
        robot: "Robot | None" = None,
        clock: Clock = time.monotonic,
        *,
        name: str = ROBOT_NAMES[0],
        real: bool = False,
        stepped: "SteppedRobot | None" = None,
    ) -> None:
        self.clock = clock
        """The time that `on_bytes` receives [s]."""
        self.name = name
        """What the player reads of it."""
        self._robot = robot
        self._real = real
        self._stepped = stepped
        self._closing = ExitStack()
        self._target: EmotionTarget | None = None

    @classmethod
    def open(
        cls,
        url: str,
        clock: Clock,
        on_bytes: OnBytes | None = None,
        settings: Path | None = None,
        *,
        name: str = ROBOT_NAMES[0],
        stepped: bool = False,
    ) -> Self:
        """Connect; raises RobotError if the port does not open or no robot answers.

        Parameters
        ----------
        url
            "none"; "sim" for a simulated robot behind a pseudo-terminal of this computer; or any
            URL that `cubeling.robot.connect` takes: "pleo:/dev/ttyACM0", "sim:opencat".
        name
            What the player reads of it.
        stepped
            Whether a simulated robot advances with the frames, for a session that is processed
            faster or slower than real time: its bytes are then the same every time.
        """
        if url == "none":
            return cls(clock=clock, name=name)
        from cubeling.robot import SimulatedPort, SteppedRobot, connect

        real = is_real_robot(url)
        with ExitStack() as closing:
            if stepped and not real:
                robot = SteppedRobot(url, on_bytes=on_bytes, settings=settings)
                line = cls(robot, lambda: robot.now, name=name, stepped=robot)
                closing.enter_context(robot)
            else:
                if url == "sim":
                    url = closing.enter_context(SimulatedPort(clock=clock)).url
                connected = connect(url, clock=clock, on_bytes=on_bytes, settings=settings)
                line = cls(closing.enter_context(connected), clock, name=name, real=real)
            line._closing = closing.pop_all()
        return line

    def feel(self, target: EmotionTarget) -> None:
        """Ask the robot to express an emotion; return at once."""
        previous = self._target or target
        self._target = target
        if self._stepped is not None:
            self._stepped.advance(max(0.0, target.timestamp - previous.timestamp))
        if self._robot is not None:
            self._robot.express(target.emotion)

    def play(self, name: str) -> None:
        """Let the robot play a motion or sound once; one that it lacks is left out."""
        if self._robot is not None:
            with suppress(RobotError):
                self._robot.play(name)

    def view(self) -> RobotView:
        """Return what the robot reports, or the requested emotion where there is no robot."""
        if self._robot is None:
            asked = NEUTRAL if self._target is None else self._target.emotion
            return RobotView("none", asked.valence, asked.label, name=self.name)
        telemetry, catalogue = self._robot.telemetry, None
        with suppress(RobotError):  # the handshake is not over yet
            catalogue = self._robot.catalogue
        # Pleo and OpenCat do not report what they show; what they acknowledged is the best guess.
        shown = telemetry.observed or telemetry.acknowledged
        emotion = shown or NEUTRAL
        moods = () if catalogue is None else catalogue.moods
        label = telemetry.label or closest_word(moods, emotion) or emotion.label
        return RobotView(
            telemetry.state,
            emotion.valence,
            label,
            real=self._real,
            shown=shown,
            telemetry=telemetry,
            catalogue=catalogue,
            time=self.clock(),
            name=self.name,
        )

    def log(self) -> tuple[LogLine, ...]:
        """Return the last lines of the robot's log, on the session's clock."""
        return () if self._robot is None else self._robot.telemetry.log

    def check(self) -> None:
        """Raise `RobotError` if the robot cannot be reached now."""
        if self._robot is not None:
            self._robot.check()

    def close(self) -> None:
        """Disconnect; a second call does nothing."""
        self._closing.close()
        self._robot = None
