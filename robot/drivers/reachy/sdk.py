"""The calls of Reachy Mini's SDK.

The robot is left as it was found: if its motors are off they are switched on and it gets up slowly,
and at the end it lies down again. From any pose it first moves to its neutral pose within a second,
because a jump out of the sleeping pose harms it.
"""

import contextlib
import importlib
import threading
from collections.abc import Callable
from typing import Any

import numpy as np

CONNECT_TIMEOUT_S = 3.0
"""Longest wait for the daemon [s]."""

GET_UP_S, SETTLE_S, LIE_DOWN_S = 2.0, 1.0, 2.0
"""Time from the sleeping to the neutral pose, from any other pose, and back to sleep [s]."""

NEUTRAL_ANTENNAS_RAD = (-0.1745, 0.1745)
"""Right and left antenna in the SDK's rest pose [rad]: upright they tremble."""


class SdkRobot:
    """One robot through a connected `reachy_mini.ReachyMini`.

    Every call may wait for the robot, and raise any exception of the SDK.
    """

    def __init__(self, mini: Any) -> None:
        self._mini = mini
        status = mini.client.get_status(timeout=CONNECT_TIMEOUT_S)
        self.version = f"daemon {status.version}"
        """The version of its daemon."""
        self._asleep = self._limp()

    def get_up(self) -> None:
        """Move slowly to the neutral pose."""
        if self._asleep:
            self._mini.enable_motors()
        self._move(np.eye(4), NEUTRAL_ANTENNAS_RAD, GET_UP_S if self._asleep else SETTLE_S)

    def set_target(self, angles: list[float]) -> None:
        """Set the target, in the order of `motions.JOINTS` [rad]."""
        roll, pitch, yaw, body, right, left = angles
        self._mini.set_target(
            head=head_pose(roll, pitch, yaw), antennas=[right, left], body_yaw=body
        )

    def state(self) -> dict[str, Any]:
        """Return the angles, in the order of `motions.JOINTS` [rad], and whether motors are off."""
        head, antennas = self._mini.get_current_joint_positions()
        head_pose_angles = head_angles(self._mini.get_current_head_pose())
        joints = [*head_pose_angles, head[0], *antennas]
        return {"joints": [round(float(angle), 4) for angle in joints], "limp": self._limp()}

    def check(self) -> None:
        """Raise ConnectionError if the daemon is silent."""
        if not self._mini.client.is_connected():
            raise ConnectionError("the daemon has been silent for a second")

    def leave(self, sent: Callable[[], None]) -> None:
        """Return to the neutral pose, and to sleep if it was found asleep; call `sent` early."""
        threading.Timer(0.1, sent).start()  # the request is sent at once; it ends much later
        self._move(np.eye(4), NEUTRAL_ANTENNAS_RAD, SETTLE_S)
        if self._asleep:
            poses = importlib.import_module("reachy_mini.reachy_mini")
            antennas = poses.SLEEP_ANTENNAS_JOINT_POSITIONS
            self._move(poses.SLEEP_HEAD_POSE, antennas, LIE_DOWN_S)
            self._mini.disable_motors()

    def close(self) -> None:
        """Disconnect from the daemon; errors are ignored, as it may be gone already."""
        with contextlib.suppress(Exception):
            self._mini.client.disconnect()

    def _move(self, head: Any, antennas: Any, seconds: float) -> None:
        self._mini.goto_target(head, antennas=list(antennas), duration=seconds, body_yaw=0.0)

    def _limp(self) -> bool:
        backend = self._mini.client.get_status(wait=False).backend_status
        mode = getattr(backend, "motor_control_mode", None)
        return mode is not None and getattr(mode, "value", mode) != "enabled"


def head_pose(roll: float, pitch: float, yaw: float) -> Any:
    """Return the head pose of the SDK, (4, 4): yaw after pitch after roll, about its base.

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
    """Return roll, pitch and yaw of a head pose, (3,) [rad]."""
    roll = np.arctan2(pose[2, 1], pose[2, 2])
    pitch = np.arcsin(np.clip(-pose[2, 0], -1.0, 1.0))
    return np.array([roll, pitch, np.arctan2(pose[1, 0], pose[0, 0])])
