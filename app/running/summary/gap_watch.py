"""Notes what is missing while a session goes on, and when: the camera, the robot."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from cubeling.app.pipeline.step import RobotView
from cubeling.app.running.opened_session import OpenedSession
from cubeling.app.running.summary.gaps import Gap
from cubeling.app.running.summary.summary import Summary

Say = Callable[[str], None]
"""Tells the user something in one line, at once."""

MAX_LINES = 20
"""Lines that are said of one part; a camera that stutters for hours is summed up at the end."""

ABSENT = "lost", "connecting"
"""States of the link to a robot that does not answer."""


@dataclass
class _Part:
    """A part that may be missing."""

    name: str
    """ "camera", "robot" or the name of a further robot, as events and lines name it."""

    gap: Gap | None = None
    """The present gap, whose length is not known yet; None while the part is there."""

    lines: int = 0
    """How many lines were said of it."""

    answered: bool = False
    """Whether it has been there once: before its first answer, a robot is not missing."""


class GapWatch:
    """Notes when camera and robot are lost and come back: in summary, recording and lines.

    Parameters
    ----------
    session, summary
        The session, and where its figures are collected.
    say
        Called with each line.
    clock
        Returns the computer's time [s].
    """

    def __init__(
        self,
        session: OpenedSession,
        summary: Summary,
        say: Say,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._session, self._summary, self._say, self._clock = session, summary, say, clock
        self._camera = _Part("camera")
        self._robots: dict[str, _Part] = {}
        self._began = 0.0  # when the camera's gap began, by the computer's clock

    def camera_lost(self, problem: str) -> None:
        """Begin a gap of the camera at the last frame; within one, do nothing."""
        if self._camera.gap is None:
            self._began = self._clock()
        patience = self._session.options.patience_s
        self._begin(
            self._camera, self._summary.last, f"{problem} (the session waits {patience:g} s for it)"
        )

    def camera_back(self, timestamp: float) -> None:
        """End the gap of the camera, if there is one, at a frame [s]."""
        self._end(self._camera, timestamp)

    def watch_robot(self, robot: RobotView, timestamp: float) -> None:
        """Begin or end gaps of the robots, by their states at a frame [s]."""
        self._watch("robot", robot, timestamp)
        if robot.second is not None:
            self._watch(robot.second.name, robot.second, timestamp)

    def _watch(self, name: str, robot: RobotView, timestamp: float) -> None:
        part = self._robots.setdefault(name, _Part(name))
        if robot.link not in ABSENT:
            part.answered = True
            self._end(part, timestamp)
        elif part.answered:
            self._begin(part, timestamp, "it does not answer")

    def close(self) -> None:
        """Complete the gaps that last until the end of the session."""
        if self._camera.gap is not None:  # no frame tells the time
            now = self._camera.gap.start + self._clock() - self._began
            self._summary.gaps.append(self._camera.gap.until(now, back=False))
        for part in self._robots.values():
            if part.gap is not None:
                self._summary.gaps.append(part.gap.until(self._summary.last, back=False))
            part.gap = None
        self._camera.gap = None

    def _begin(self, part: _Part, timestamp: float, problem: str) -> None:
        if part.gap is not None:
            return
        part.gap = Gap(part.name, timestamp, self._summary.duration)
        self._note(
            part, f"{part.name} lost", timestamp, f"after {part.gap.played:.1f} s: {problem}"
        )

    def _end(self, part: _Part, timestamp: float) -> None:
        if part.gap is None:
            return
        gap, part.gap = part.gap.until(timestamp), None
        self._summary.gaps.append(gap)
        self._note(part, f"{part.name} back", timestamp, f"after {gap.seconds:.1f} s")

    def _note(self, part: _Part, event: str, timestamp: float, more: str) -> None:
        self._session.happen(event, timestamp)
        part.lines += 1
        if part.lines <= MAX_LINES:
            self._say(f"{event} {more}")
        elif part.lines == MAX_LINES + 1:
            self._say(f"{part.name}: further gaps are in the summary")
