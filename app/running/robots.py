"""The robot at the end of the line: a real one, a simulated one on a real port, or none."""

from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Self

from affect import Emotion
from affect.words import closest_word
from app.pipeline.scenario import EmotionTarget
from app.pipeline.step import RobotView
from robot import Robot, RobotError, SimulatedPort, SteppedRobot, connect
from robot.contract.closeable import Closeable

OnBytes = Callable[[str, bytes, float], None]
Clock = Callable[[], float]

REMEMBERED = 1000
"""So many emotions are remembered with their words; a robot takes none that is older [frames]."""


class RobotLine(Closeable):
    """Hands the emotions of a session to a robot and tells how it is.

    `open` it before the session, `close` it after; a second `close` does nothing. Nothing here
    waits for the robot once it is connected.
    """

    def __init__(self) -> None:
        self._closing = ExitStack()
        self._robot: Robot | None = None
        self._target: EmotionTarget | None = None
        self._asked: dict[Emotion, str] = {}
        self._real = False
        self._steps: Steps | None = None

    @classmethod
    def open(
        cls,
        url: str,
        clock: Clock,
        on_bytes: OnBytes | None = None,
        settings: Path | None = None,
        *,
        stepped: bool = False,
    ) -> Self:
        """Connect.

        Parameters
        ----------
        url
            "none"; "sim" for a simulated robot behind a pseudo-terminal of this computer; or any
            URL that `robot.connect` takes: "pleo:/dev/ttyACM0", "sim:opencat".
        clock
            The session's time [s].
        on_bytes
            Called with ("tx" | "rx", bytes, time) for everything on the wire.
        settings
            A TOML file for the robot's driver, or None.
        stepped
            Whether a simulated robot lives by the frames' time, for a session that is drawn faster
            or slower than life: its bytes are then the same every time.

        Raises
        ------
        RobotError
            The port does not open or nobody answers.
        """
        line = cls()
        if url == "none":
            return line
        try:
            line._real = url != "sim" and not url.startswith("sim:")
            if stepped and not line._real:
                line._steps = Steps(url, clock, on_bytes, settings)
                line._robot = line._closing.enter_context(line._steps.robot)
                return line
            if url == "sim":
                url = line._closing.enter_context(SimulatedPort(clock=clock)).url
            robot = connect(url, clock=clock, on_bytes=on_bytes, settings=settings)
            line._robot = line._closing.enter_context(robot)
        except BaseException:
            line.close()
            raise
        return line

    def feel(self, target: EmotionTarget) -> None:
        """Ask the robot to feel; returns at once."""
        self._target = target
        self._asked.pop(target.emotion, None)  # so that the latest are last
        self._asked[target.emotion] = target.label
        if len(self._asked) > REMEMBERED:
            del self._asked[next(iter(self._asked))]
        if self._steps is not None:
            self._steps.reach(target.timestamp)
        if self._robot is not None:
            self._robot.express(target.emotion, target.label)

    def view(self) -> RobotView:
        """Return what the robot says of itself, or what it was asked where there is none."""
        if self._robot is None:
            mood = 0.0 if self._target is None else self._target.emotion.valence
            return RobotView(
                "none", mood, "neutral" if self._target is None else self._target.label
            )
        telemetry = self._robot.telemetry
        # Pleo and OpenCat do not tell what they show; what they took is then the nearest truth.
        shown = telemetry.observed or telemetry.acknowledged or Emotion(0.0, 0.0)
        label = telemetry.label or self._word_for(shown)
        return RobotView(telemetry.state, shown.valence, label, self._real)

    def _word_for(self, emotion: Emotion) -> str:
        """Return the mood that a robot shows for what it took: chosen as its driver chooses it."""
        assert self._robot is not None
        try:
            moods = self._robot.catalogue.moods
        except RobotError:  # it has not introduced itself yet
            return emotion.label
        return closest_word(moods, emotion, self._asked.get(emotion)) or emotion.label

    def check(self) -> None:
        """Raise `RobotError` if the robot cannot be reached now."""
        if self._robot is not None:
            self._robot.check()

    def close(self) -> None:
        """Let the robot go."""
        self._closing.close()
        self._robot = None


class Steps:
    """Keeps a simulated robot's time in step with the frames.

    Parameters
    ----------
    url
        "sim", or what `SteppedRobot` takes.
    clock
        The session's time, in which `on_bytes` is told [s].
    on_bytes, settings
        See `RobotLine.open`. What the robot says before the first frame is told with it.
    """

    def __init__(
        self, url: str, clock: Clock, on_bytes: OnBytes | None, settings: Path | None
    ) -> None:
        self._clock = clock
        self._on_bytes = on_bytes
        self._early: list[tuple[str, bytes, float]] = []
        self._shift = 0.0
        self._frame: float | None = None
        url = "sim:cubeling" if url == "sim" else url
        self.robot = SteppedRobot(url, on_bytes=self._tell, settings=settings)
        """The robot."""

    def reach(self, timestamp: float) -> None:
        """Let the robot live until the frame with this time [s]."""
        if self._frame is None:
            self._frame = timestamp
            self._shift = self._clock() - self.robot.now
            for direction, data, time in self._early:
                self._tell(direction, data, time)
        self.robot.advance(max(0.0, timestamp - self._frame))
        self._frame = timestamp

    def _tell(self, direction: str, data: bytes, time: float) -> None:
        if self._frame is None:
            self._early.append((direction, data, time))
        elif self._on_bytes is not None:
            self._on_bytes(direction, data, time + self._shift)
