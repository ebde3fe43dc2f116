"""The second and third arrow: where the cube is, and what the hand does with it."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CubeState:
    """Where the cube is in one frame."""

    visible: bool
    """Whether the cube was found in this frame and its pose is trusted."""

    camera_from_cube: Array | None
    """Pose of the cube in the camera frame, (4, 4) [m]; None where it is not known."""

    velocity: Array
    """Of the cube's origin [m/s], then of its rotation [rad/s], both along camera axes, (6,)."""

    covariance: Array
    """Of a small shift [m] then a small turn [rad] along camera axes, applied on the left
    (p ↦ turn · (p − origin) + origin + shift, where origin is the cube's), (6, 6)."""

    source: Literal["markers", "image", "predicted"]
    """What the pose rests on."""

    faces: tuple[str, ...]
    """Names of the faces whose markers were used."""

    reprojection_error: float
    """Root mean square distance of the corners from where the pose puts them [px]; NaN if none."""

    timestamp: float
    """That of the frame [s]."""

    refused: str = ""
    """Why a pose was not trusted; "" where none was refused.

    "ambiguous": a single face that may lean either way; "blurred": its edges should be seen and are
    not; "jump": no hand moves so fast, a second frame must say so too; "unproved": too small or too
    hidden to tell; "unsure": seen, but the pose may be off by a centimetre or a few degrees.
    """

    @property
    def verdict(self) -> str:
        """In a word: "trusted", why it was refused, or "unseen"."""
        return "trusted" if self.visible else self.refused or "unseen"


@dataclass(frozen=True)
class CubeControls:
    """What the hand does with the cube."""

    visible: bool
    """Whether the cube is seen now. Where it is not, the other fields keep their last values,
    but for the events `placed` and `shaken`, which are False."""

    top_face: str | None
    """Name of the face that looks up; None before the table is known."""

    heading: float
    """Direction of the cube's forward side about the table's up axis [rad], −π…π.

    0 where that side looks against the camera's view, wherever the cube stands on the table;
    positive turns are clockwise seen from above.
    The forward side is `front`, or `bottom` when `front` is up, `top` when `back` is up.
    """

    camera_angle: float
    """Angle on the table between the forward side and the camera's view, reversed [rad], 0…π:
    AvatAR's angle between camera and cube (Fernández-Baena 2015, section 5.2.4)."""

    turns: float
    """Whole and part turns about the table's up axis since the cube was placed, unwrapped;
    positive clockwise seen from above, as a knob."""

    resting: bool
    """Whether a face lies on the table and the cube does not travel; it may turn on the spot."""

    placed: bool
    """True in the one frame in which the cube came to rest after it was lifted or tipped to another
    face, and in the first frame in which it rests at all."""

    lifted: bool
    """Whether the cube is off the table or tipped on its way to another face."""

    shaken: bool
    """True in the one frame in which a shake was recognised."""

    position: Array | None
    """Where the cube's centre stands on the table, (x, z) [m]; None before the table is known."""

    timestamp: float
    """That of the frame [s]."""

    camera_from_table: Array | None = None
    """The table's frame, (4, 4) [m]: origin on the table where the cube first rested, +y up,
    +z horizontally towards the camera; None before the table is known."""

    placements: int = 0
    """How often the cube has been placed so far."""
