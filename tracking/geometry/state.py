"""The second and third value of the pipeline: where the cube is, and what the hand does with it."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from cubeling.tracking.geometry.arrays import Array


@dataclass(frozen=True)
class CubeState:
    """Where the cube is in one frame."""

    visible: bool
    """Whether the cube was found in this frame and its pose is trusted."""

    camera_from_cube: Array | None
    """Pose of the cube in the camera frame, (4, 4) [m]; None where it is not known."""

    velocity: Array
    """Velocity of the origin [m/s] and angular velocity [rad/s], along camera axes, (6,)."""

    covariance: Array
    """Of a translation [m] and a rotation vector [rad] about the cube's origin, along camera axes,
    (6, 6)."""

    source: Literal["markers", "image", "predicted"]
    """What the pose is measured on."""

    faces: tuple[str, ...]
    """Names of the faces whose markers were used."""

    reprojection_error: float
    """Root mean square residual of corners or edges at this pose [px]; NaN if none was measured."""

    timestamp: float
    """That of the frame [s]."""

    refused: str = ""
    """Why a pose was not trusted; "" where none was refused.

    "ambiguous": a single face that may tilt either way; "blurred": its edges should be visible and
    are not; "jump": no hand is so fast, and a second frame must confirm it; "unproved": too small
    or too hidden to tell; "unsure": the pose may be off by a centimetre or a few degrees; "flat":
    markers lie in one plane, as on the sheet before it is folded; "searching": the search takes
    more than one frame, and goes on; "failed": it ended in an error of the program, see
    `CubeTracker.give_up`.
    """

    focal_scale: float = 1.0
    """Focal length through which the pose was found, as a multiple of that of the camera's
    intrinsics: other than 1 where those were guessed, and play has measured it."""

    focal_shift: Array = field(default_factory=lambda: np.zeros(6))
    """Pose delta by one standard deviation of the focal length, (6,): the part of `covariance` that
    all frames have in common."""

    @property
    def verdict(self) -> str:
        """One word: "trusted", why the pose was refused, or "unseen"."""
        return "trusted" if self.visible else self.refused or "unseen"


@dataclass(frozen=True)
class CubeControls:
    """What the hand does with the cube."""

    visible: bool
    """Whether the cube is seen now. Where it is not, the other fields keep their last values,
    except the events: `placed` is False and `gestures` is empty."""

    top_face: str | None
    """Name of the face that points up; None before the table is known."""

    heading: float
    """Direction of the cube's forward side about the table's up axis [rad], −π…π.

    0 where that side faces against the viewing direction, wherever the cube stands on the table;
    positive turns are clockwise seen from above.
    The forward side is `front`, or `bottom` when `front` is up, `top` when `back` is up.
    """

    camera_angle: float
    """Angle on the table between the forward side and the reversed viewing direction [rad], 0…π:
    AvatAR's angle between camera and cube (Fernández-Baena 2015, section 5.2.4)."""

    turns: float
    """Turns about the table's up axis since the cube was placed, unwrapped; positive clockwise seen
    from above, like a knob."""

    resting: bool
    """Whether a face lies on the table and the cube does not slide; it may turn on the spot."""

    placed: bool
    """True in the one frame in which the cube comes to rest after it was lifted or tipped to
    another face, and in the first frame in which it rests at all."""

    lifted: bool
    """Whether the cube is off the table or tipped on its way to another face."""

    position: Array | None
    """Position of the cube's centre on the table, (x, z) [m]; None before the table is known."""

    timestamp: float
    """That of the frame [s]."""

    camera_from_table: Array | None = None
    """The table's frame, (4, 4) [m]: origin on the table where the cube first rested, +y up,
    +z horizontally towards the camera; None before the table is known."""

    placements: int = 0
    """How often the cube has been placed so far."""

    gestures: tuple[str, ...] = ()
    """Gestures that are recognised in this one frame, by name: "shaken" and any others that
    `cubeling.tracking.gestures.detectors` registers."""

    @property
    def shaken(self) -> bool:
        """True in the one frame in which a shake is recognised."""
        return "shaken" in self.gestures
