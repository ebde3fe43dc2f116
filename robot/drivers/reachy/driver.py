"""The driver: moods become targets for head, body and antennas, at the robot's own pace.

It speaks lines of JSON with `ReachyLine`, which calls the SDK: so it has no clock, thread or port,
what went to and fro can be recorded, and a robot that hangs hangs only there. There is one target
on its way at a time: a program that sets targets as fast as it can makes the robot jerk.
"""

import json
from collections import deque
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from affect import Emotion
from affect.words import closest_word
from robot.contract.catalogue import Catalogue
from robot.contract.driver import MAX_QUEUED_ACTIONS
from robot.contract.motions import Array, SineMotion
from robot.contract.telemetry import LinkCounts, LinkState, Telemetry
from robot.drivers.lines import LineReader
from robot.drivers.reachy import moves
from robot.protocol import messages as m

TARGET_EVERY = 0.040
"""Time between two targets [s]; the robot's own loop runs at 50 Hz."""

TARGET_WITHIN = 0.5
"""A target that is not taken after this long is given up [s]."""

DEGRADED_AFTER = 0.5
"""Silence after which the link is called degraded [s]; the state is told every 0.1 s."""

LOST_AFTER = 2.0
"""Silence after which it is called lost [s]."""

GAP_MAX = 0.2
"""Most time that one target makes up for [s]: no jump after this computer has slept."""

LINE_MAX = 4096
"""Longest line that is listened to [bytes]."""


@dataclass
class _Flight:
    """The target that is on its way."""

    number: int
    emotion: Emotion | None
    neutral: bool  # whether it is the pose of a stop
    sent: float


class ReachyDriver:
    """Drives a Reachy Mini; see `robot.contract.driver.Driver`."""

    def __init__(self) -> None:
        self.catalogue: Catalogue | None = None
        """What the robot has; None until the daemon has answered."""
        self._open = self._closed = False
        self._commanded: Emotion | None = None
        self._acknowledged: Emotion | None = None
        self._mood = moves.MOODS[0]
        self._still = self._stopped = False  # whether it is to be so, and whether it is
        self._playing: SineMotion | None = None
        self._waiting: deque[SineMotion] = deque()
        self._motion_time = 0.0
        self._angles = np.zeros(len(moves.JOINTS))
        self._flight: _Flight | None = None
        self._number = 0
        self._targeted: float | None = None
        self._heard: float | None = None
        self._said: dict[str, Any] = {}
        self.reader = LineReader(LINE_MAX)
        self._out = bytearray()
        self._counts = {"frames_sent": 0, "frames_received": 0, "skipped": 0, "dropped": 0}
        self._sessions = 0

    # --- What the owner asks for -----------------------------------------------------------------

    def express(self, emotion: Emotion) -> None:
        """Ask for an emotion; only the latest counts."""
        words = tuple(motion.name for motion in moves.MOODS)
        word = closest_word(words, emotion) or words[0]
        mood = moves.MOODS[words.index(word)]
        if mood is not self._mood and self._playing is None:
            self._motion_time = 0.0
        self._mood, self._commanded, self._still = mood, emotion, False

    def play(self, item: int, index: int) -> bool:
        """Ask for a motion once; False if too many wait."""
        if self.state(self._heard or 0.0) not in ("ready", "degraded"):
            self._counts["dropped"] += 1
            return True
        if len(self._waiting) >= MAX_QUEUED_ACTIONS:
            return False
        if item == m.ITEM_MOTION:
            self._waiting.append(moves.MOTIONS[index])
            self._still = False
        return True

    def stop(self) -> None:
        """Ask for the neutral pose."""
        self._drop_actions()
        self._commanded, self._mood, self._still = None, moves.MOODS[0], True

    def port_opened(self, now: float) -> None:
        """Begin, or begin again."""
        self._open, self._heard, self._flight = True, None, None
        self._targeted = None
        self.reader.clear()

    def port_lost(self) -> None:
        """Send nothing until the port is back."""
        self._open, self._acknowledged, self._stopped = False, None, False
        self._heard = None
        self._drop_actions()
        self._out.clear()

    def close(self) -> None:
        """Say goodbye: the robot goes back to where it was found, asleep or awake."""
        if self._open and not self._closed:
            self._say({"bye": True})
        self._closed = True

    # --- What the line and the clock bring -------------------------------------------------------

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the line at time `now` [s]."""
        for line in self.reader.feed(data):
            said = _understood(line)
            if said is None:
                self._counts["skipped"] += 1
            elif self._open and not self._closed:
                self._counts["frames_received"] += 1
                self._heard = now
                self._take(said)

    def tick(self, now: float) -> None:
        """Do what is due at time `now` [s]."""
        if self.state(now) not in ("ready", "degraded"):
            return
        if self._flight is not None and now - self._flight.sent >= TARGET_WITHIN:
            self._flight = None
        due = self._targeted is None or now - self._targeted >= TARGET_EVERY
        if self._flight is None and due:
            self._target(now)

    def bytes_to_send(self) -> bytes:
        """Return what is to be written to the line, once."""
        data = bytes(self._out)
        self._out.clear()
        return data

    # --- What is known ---------------------------------------------------------------------------

    def state(self, now: float) -> LinkState:
        """Return the state of the link at time `now` [s]; see `LinkState`."""
        if self._closed:
            return "closed"
        if self.catalogue is None:
            return "connecting"
        if not self._open or self._heard is None or now - self._heard >= LOST_AFTER:
            return "lost"
        return "degraded" if now - self._heard >= DEGRADED_AFTER else "ready"

    def telemetry(self, now: float) -> Telemetry:
        """Return all that is known; the robot does not know what it shows."""
        joints = self._said.get("joints", [])
        playing = self._playing or (None if self._still else self._mood)
        known = self._sessions > 0
        state = self.state(now)
        return Telemetry(
            state=state,
            commanded=self._commanded,
            acknowledged=None if state == "lost" else self._acknowledged,
            stopped=self._stopped and state != "lost",
            limp=bool(self._said.get("limp", False)),
            joints=MappingProxyType(dict(zip(moves.JOINTS, joints, strict=False))),
            motion=playing.name if known and playing is not None else None,
            silence=None if self._heard is None else now - self._heard,
            counts=LinkCounts(
                crc_errors=self.reader.too_long, sessions=self._sessions, **self._counts
            ),
        )

    # --- Small things ----------------------------------------------------------------------------

    def _take(self, said: dict[str, Any]) -> None:
        if "hello" in said:
            self.catalogue = moves.catalogue(str(said["hello"])[:16])
            self._sessions += 1
            self._angles = _angles_of(said)
        if "taken" in said and self._flight is not None and said["taken"] == self._flight.number:
            self._acknowledged, self._stopped = self._flight.emotion, self._flight.neutral
            self._flight = None
        if "joints" in said:
            self._said = {"joints": _angles_of(said).tolist(), "limp": said.get("limp") is True}

    def _target(self, now: float) -> None:
        elapsed = 0.0 if self._targeted is None else min(now - self._targeted, GAP_MAX)
        self._targeted = now
        self._angles = moves.toward(self._angles, self._wanted(elapsed), elapsed)
        self._number += 1
        neutral = self._still and self._playing is None and not self._angles.any()
        self._flight = _Flight(self._number, self._commanded, neutral, now)
        angles = [round(float(angle), 4) for angle in self._angles]
        self._say({"target": angles, "number": self._number})

    def _wanted(self, elapsed: float) -> Array:
        """Return the angles of the motion that is on, and let it go on."""
        self._motion_time += elapsed
        if self._playing is not None and self._motion_time >= self._playing.period:
            self._playing, self._motion_time = None, 0.0
        if self._playing is None and self._waiting:
            self._playing, self._motion_time = self._waiting.popleft(), 0.0
        if self._still and self._playing is None:
            return np.zeros(len(moves.JOINTS))
        return (self._playing or self._mood).angles(self._motion_time, moves.JOINTS)

    def _drop_actions(self) -> None:
        self._counts["dropped"] += len(self._waiting)
        self._waiting.clear()
        self._playing = None

    def _say(self, what: dict[str, Any]) -> None:
        self._out += json.dumps(what, separators=(",", ":")).encode() + b"\n"
        self._counts["frames_sent"] += 1


def _understood(line: str) -> dict[str, Any] | None:
    """Return what a line says; None if it says nothing."""
    try:
        said = json.loads(line)
    except (ValueError, RecursionError):
        return None
    return said if isinstance(said, dict) else None


def _angles_of(said: dict[str, Any]) -> Array:
    """Return the angles that a line names, zero for those that it does not, (joints,) [rad]."""
    named = said.get("joints")
    angles = np.zeros(len(moves.JOINTS))
    for index, angle in enumerate(named[: len(angles)] if isinstance(named, list) else ()):
        if isinstance(angle, int | float) and abs(angle) < 10:  # refuses NaN too
            angles[index] = angle
    return angles
