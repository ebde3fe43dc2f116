"""What is done with the object of Reachy Mini's SDK.

Life of the robot: it is left as it was found. Motors that were off are switched on and the robot
gets up slowly; at the end it lies down again and they are off. From wherever it is found it first
goes to its neutral pose in a second, for a jump out of the sleeping pose harms it.
"""

import contextlib
import importlib
import threading
from collections.abc import Callable
from typing import Any

import numpy as np

CONNECT_WITHIN = 3.0
"""Longest wait for the daemon [s]."""

GET_UP, SETTLE, LIE_DOWN = 2.0, 1.0, 2.0
"""Time for the way from the sleeping to the neutral pose, from any other, and back to sleep [s]."""

NEUTRAL_ANTENNAS = (-0.1745, 0.1745)
"""Right and left, where the SDK has them at rest [rad]: upright they tremble."""


class Hand:
    """What we do with one robot; every call may wait for it, and raise whatever the SDK raises.

    Parameters
    ----------
    mini
        A connected `reachy_mini.ReachyMini`.
    """

    def __init__(self, mini: Any) -> None:
        self._mini = mini
        status = mini.client.get_status(timeout=CONNECT_WITHIN)
        self.version = f"daemon {status.version}"
        """What runs on the robot."""
        self._asleep = self._limp()

    def get_up(self) -> None:
        """Go to the neutral pose, slowly."""
        if self._asleep:
            self._mini.enable_motors()
        self._go(np.eye(4), NEUTRAL_ANTENNAS, GET_UP if self._asleep else SETTLE)

    def turn(self, angles: list[float]) -> None:
        """Set the target: roll, pitch and yaw of the head, yaw of the body, antennas [rad]."""
        roll, pitch, yaw, body, right, left = angles
        self._mini.set_target(
            head=head_pose(roll, pitch, yaw), antennas=[right, left], body_yaw=body
        )

    def state(self) -> dict[str, Any]:
        """Say where it is, in the order of `moves.JOINTS` [rad], and whether motors are off."""
        head, antennas = self._mini.get_current_joint_positions()
        turned = head_angles(self._mini.get_current_head_pose())
        joints = [*turned, head[0], *antennas]
        return {"joints": [round(float(angle), 4) for angle in joints], "limp": self._limp()}

    def check(self) -> None:
        """Raise ConnectionError if the daemon has stopped talking."""
        if not self._mini.client.is_connected():
            raise ConnectionError("nothing heard of the daemon for a second")

    def part(self, sent: Callable[[], None]) -> None:
        """Go back to the neutral pose, and to sleep if it was found so."""
        threading.Timer(0.1, sent).start()  # the request goes out at once; its end may be far
        self._go(np.eye(4), NEUTRAL_ANTENNAS, SETTLE)
        if self._asleep:
            poses = importlib.import_module("reachy_mini.reachy_mini")
            antennas = poses.SLEEP_ANTENNAS_JOINT_POSITIONS
            self._go(poses.SLEEP_HEAD_POSE, antennas, LIE_DOWN)
            self._mini.disable_motors()

    def close(self) -> None:
        """Disconnect."""
        with contextlib.suppress(Exception):
            self._mini.client.disconnect()

    def _go(self, head: Any, antennas: Any, seconds: float) -> None:
        self._mini.goto_target(head, antennas=list(antennas), duration=seconds, body_yaw=0.0)

    def _limp(self) -> bool:
        backend = self._mini.client.get_status(wait=False).backend_status
        mode = getattr(backend, "motor_control_mode", None)
        return mode is not None and getattr(mode, "value", mode) != "enabled"


def head_pose(roll: float, pitch: float, yaw: float) -> Any:
    """Return the head's pose as the SDK has it, (4, 4): yaw after pitch after roll, about its base.

    >>> head_angles(head_pose(0.1, -0.2, 0.3)).round(6).tolist()
    [0.1, -0.2, 0.3]
    """
    (cr, cp, cy), (sr, sp, sy) = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    pose = np.eye(4)
    pose[:3, :3] = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return pose


def head_angles(pose: Any) -> Any:
    """Return roll, pitch and yaw of a head's pose, (3,) [rad]."""
    roll = np.arctan2(pose[2, 1], pose[2, 2])
    pitch = np.arcsin(np.clip(-pose[2, 0], -1.0, 1.0))
    return np.array([roll, pitch, np.arctan2(pose[1, 0], pose[0, 0])])
