"""The driver: moods become targets of head, body and antennas, at a rate that the robot can follow.

It exchanges lines of JSON with `ReachyPort`, so that the lines can be recorded, and a robot that
hangs delays only that port's thread. More than one pending target would make the robot jerk.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from cubeling.affect import Emotion
from cubeling.affect.words import closest_word
from cubeling.robot.contract.catalogue import Catalogue
from cubeling.robot.contract.driver import MAX_QUEUED_ACTIONS, Driver, DriverKind
from cubeling.robot.contract.motions import Array, SineMotion
from cubeling.robot.contract.port import SendBuffer
from cubeling.robot.contract.telemetry import LinkCounts, LinkState, Telemetry
from cubeling.robot.drivers.commands import CommandQueue, DesiredState
from cubeling.robot.drivers.lines import LineReader
from cubeling.robot.drivers.reachy import motions
from cubeling.robot.drivers.reachy.port import open_reachy
from cubeling.robot.errors import RobotError
from cubeling.robot.protocol import messages as m

TARGET_INTERVAL_S = 0.040
"""Time between two targets [s]; the robot's own loop runs at 50 Hz."""

TARGET_TIMEOUT_S = 0.5
"""Time after which a target without an acknowledgement is given up [s]."""

DEGRADED_AFTER_S = 0.5
"""Silence after which the link is degraded [s]; the state arrives every 0.1 s."""

LOST_AFTER_S = 2.0
"""Silence after which the link is lost [s]."""

MAX_TIME_STEP_S = 0.2
"""Longest time that one target accounts for [s]: no jump after this computer has slept."""

MAX_LINE_BYTES = 4096
"""Longest line that is read [bytes]."""


@dataclass
class PendingTarget:
    """The target that waits for its acknowledgement."""

    number: int
    """Sequence number that the acknowledgement repeats."""

    emotion: Emotion | None
    """The emotion that it belongs to."""

    stopped: bool
    """Whether it is the pose of a stop."""

    sent: float
    """Time of the send [s]."""


class ReachyDriver(SendBuffer):
    """Drives a Reachy Mini; a `Driver`."""

    def __init__(self) -> None:
        super().__init__()
        self.joint_mover = None
        """Single joints are not turned by this driver."""
        self.catalogue: Catalogue | None = None
        """What the robot has; None until the daemon has answered."""
        self.reader = LineReader(MAX_LINE_BYTES)
        """Splits the received lines."""
        self._open = self._closed = False
        self._state = DesiredState()
        self._actions: CommandQueue[SineMotion] = CommandQueue(MAX_QUEUED_ACTIONS)
        self._mood = motions.MOODS[0]
        self._still = False  # whether a stop was requested last
        self._playing: SineMotion | None = None
        self._motion_time = 0.0
        self._angles = np.zeros(len(motions.JOINTS))
        self._pending: PendingTarget | None = None
        self._number = 0
        self._last_target: float | None = None
        self._last_received: float | None = None
        self._reported_angles: list[float] = []
        self._limp = False
        self._sent = self._received = self._skipped = self._sessions = 0

    def express(self, emotion: Emotion) -> None:
        """Request an emotion; only the latest counts."""
        words = tuple(motion.name for motion in motions.MOODS)
        word = closest_word(words, emotion) or words[0]
        mood = motions.MOODS[words.index(word)]
        if mood is not self._mood and self._playing is None:
            self._motion_time = 0.0
        self._mood, self._state.commanded, self._still = mood, emotion, False

    def play(self, item: int, index: int) -> bool:
        """Request a motion once; return False if too many wait already."""
        if self.state(self._last_received or 0.0) not in ("ready", "degraded"):
            self._actions.dropped += 1
            return True
        if item != m.ITEM_MOTION:
            return True  # it has no sounds
        taken = self._actions.add(motions.MOTIONS[index])
        self._still &= not taken
        return taken

    def stop(self) -> None:
        """Request the neutral pose, before and instead of everything that waits."""
        self._drop_actions()
        self._state.commanded, self._mood, self._still = None, motions.MOODS[0], True

    def port_opened(self, now: float) -> None:
        """Start a session with nothing commanded and no telemetry."""
        self._open, self._last_received, self._pending = True, None, None
        self._last_target = None
        self.reader.clear()

    def port_lost(self) -> None:
        """Send nothing until `port_opened`."""
        self._open, self._last_received = False, None
        self._state.forget()
        self._drop_actions()
        self._out.clear()

    def close(self) -> None:
        """End the session: the robot returns to the pose in which it was found."""
        if self._open and not self._closed:
            self._send({"bye": True})
        self._closed = True

    def receive(self, data: bytes, now: float) -> None:
        """Process received bytes at time `now` [s]."""
        for line in self.reader.feed(data):
            message = _decode(line)
            if message is None:
                self._skipped += 1
            elif self._open and not self._closed:
                self._received += 1
                self._last_received = now
                self._process(message)

    def tick(self, now: float) -> None:
        """Do what is due at time `now` [s]: send the next target."""
        if self.state(now) not in ("ready", "degraded"):
            return
        if self._pending is not None and now - self._pending.sent >= TARGET_TIMEOUT_S:
            self._pending = None
        due = self._last_target is None or now - self._last_target >= TARGET_INTERVAL_S
        if self._pending is None and due:
            self._send_target(now)

    def state(self, now: float) -> LinkState:
        """Return the state of the link at time `now` [s]; see `LinkState`."""
        if self._closed:
            return "closed"
        if self.catalogue is None:
            return "connecting"
        silence = None if self._last_received is None else now - self._last_received
        if not self._open or silence is None or silence >= LOST_AFTER_S:
            return "lost"
        return "degraded" if silence >= DEGRADED_AFTER_S else "ready"

    def telemetry(self, now: float) -> Telemetry:
        """Return everything that is known at time `now` [s]; the robot does not report its mood."""
        playing = self._playing or (None if self._still else self._mood)
        angles = zip(motions.JOINTS, self._reported_angles, strict=False)
        state = self.state(now)
        return Telemetry(
            state=state,
            commanded=self._state.commanded,
            acknowledged=None if state == "lost" else self._state.acknowledged,
            stopped=self._state.stopped and state != "lost",
            limp=self._limp,
            joints=MappingProxyType(dict(angles)),
            motion=playing.name if self._sessions and playing is not None else None,
            silence=None if self._last_received is None else now - self._last_received,
            counts=LinkCounts(
                frames_sent=self._sent,
                frames_received=self._received,
                crc_errors=self.reader.too_long,
                skipped=self._skipped,
                dropped=self._actions.dropped,
                sessions=self._sessions,
            ),
        )

    def _process(self, message: dict[str, Any]) -> None:
        if "hello" in message:
            self.catalogue = motions.catalogue(str(message["hello"])[:16])
            self._sessions += 1
            self._angles = _angles_of(message)
        pending = self._pending
        if "taken" in message and pending is not None and message["taken"] == pending.number:
            self._state.confirm(pending.emotion, stopped=pending.stopped)
            self._pending = None
        if "joints" in message:
            self._reported_angles = _angles_of(message).tolist()
            self._limp = message.get("limp") is True

    def _send_target(self, now: float) -> None:
        last = now if self._last_target is None else self._last_target
        elapsed = min(now - last, MAX_TIME_STEP_S)
        self._last_target = now
        wanted = self._wanted_angles(elapsed)
        self._angles = motions.step_towards(self._angles, wanted, elapsed)
        self._number += 1
        stopped = self._still and self._playing is None and not self._angles.any()
        self._pending = PendingTarget(self._number, self._state.commanded, stopped, now)
        angles = [round(float(angle), 4) for angle in self._angles]
        self._send({"target": angles, "number": self._number})

    def _wanted_angles(self, elapsed: float) -> Array:
        """Advance the motion by a time [s]; return its angles, (joints,) [rad]."""
        self._motion_time += elapsed
        if self._playing is not None and self._motion_time >= self._playing.period:
            self._playing, self._motion_time = None, 0.0
        if self._playing is None and self._actions:
            self._playing, self._motion_time = self._actions.popleft(), 0.0
        if self._still and self._playing is None:
            return np.zeros(len(motions.JOINTS))
        return (self._playing or self._mood).angles(self._motion_time, motions.JOINTS)

    def _drop_actions(self) -> None:
        self._actions.drop_all()
        self._playing = None

    def _send(self, message: dict[str, Any]) -> None:
        self._out += json.dumps(message, separators=(",", ":")).encode() + b"\n"
        self._sent += 1


def _decode(line: str) -> dict[str, Any] | None:
    """Return the message of a line; None if it has none."""
    try:
        message = json.loads(line)
    except (ValueError, RecursionError):
        return None
    return message if isinstance(message, dict) else None


def _angles_of(message: dict[str, Any]) -> Array:
    """Return the joint angles of a message, zero where they are missing, (joints,) [rad]."""
    values = message.get("joints")
    angles = np.zeros(len(motions.JOINTS))
    for index, angle in enumerate(values[: len(angles)] if isinstance(values, list) else ()):
        if isinstance(angle, int | float) and abs(angle) < 10:  # refuses NaN too
            angles[index] = angle
    return angles


def _make(host: int, settings: Path | None) -> Driver:
    if settings is not None:
        raise RobotError(f"{settings}: Reachy Mini's driver has no settings; leave them out")
    return ReachyDriver()


REACHY = DriverKind(_make, 0, 10.0, open_reachy)  # no serial port; getting up takes seconds
"""The protocol "reachy", over the network."""
