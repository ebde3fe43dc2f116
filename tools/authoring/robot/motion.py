"""Movements that the robot's clips share: tail, neck, blinks and stomps."""

import numpy as np

from tools.authoring.modelling.curves import Array, delayed, keys
from tools.authoring.modelling.quadruped import DEGREE, FRAME_RATE_HZ, AnimationTracks, swing_tail
from tools.authoring.robot.rig import NECK, TAIL

LEVELS = ("head", "legs", "tail")
"""Names of the intensities −1, 0 and 1, after the part of the body that joins in."""
BODY = ("hips", "spine1", "chest")
NECK_BEND_SHARES = (0.40, 0.33, 0.27)
"""Shares of the neck's joints in a bend."""


def tail(
    anim: AnimationTracks, up: Array, left: Array, tip: float = 1.5, drag: float = 1.0
) -> None:
    """Swing the tail; see `swing_tail`."""
    swing_tail(anim, TAIL, up, left, tip, 4.6, drag, (0.6, 0.55))


def neck(anim: AnimationTracks, up: Array, left: Array | float = 0.0, drag: float = 0.014) -> None:
    """Bend the neck [rad]; each joint is delayed against the one below it."""
    aside = np.broadcast_to(left, anim.frames)
    for number, (joint, share) in enumerate(zip(NECK, NECK_BEND_SHARES, strict=True)):
        late = drag * number
        anim.turn(joint, up=share * delayed(up, late), left=share * delayed(aside, late))


def face_ahead(anim: AnimationTracks, up: Array | float) -> None:
    """Set the pitch of the head from straight ahead [rad], compensating body and neck.

    Call it after all other movements: the robot faces the viewer to whom it shows a mood.
    """
    below = [anim.turns[joint][:, 0] for joint in (*BODY, *NECK) if joint in anim.turns]
    anim.turn("head", up=up - 0.85 * sum(below, start=np.zeros(anim.frames)))


def blink(frames: int, *starts: float, seconds: float = 0.26) -> Array:
    """Return the closure of the eyes, 0…1, with blinks at phases: fast down, slower up."""
    length = seconds * FRAME_RATE_HZ / frames
    shut = np.zeros(frames)
    for start in starts:
        lid = keys(frames, (0, 0), (0.4 * length, 1), (0.55 * length, 1), (length, 0), (0.99, 0))
        shut = np.maximum(shut, delayed(lid, start))
    return shut


def stomp_curve(frames: int, start: float, top: float, down: float) -> Array:
    """Return the height of a stomping foot, 0…1: slow up, a hold, and fast down."""
    hold = 0.5 * (top + down) + 0.01
    return keys(frames, (start, 0), (top, 1), (hold, 0.92), (down, 0), (start + 0.985, 0))


def turn_eyes(anim: AnimationTracks, left: Array, up: Array | float = 0.0) -> None:
    """Turn both eyes in the head [rad]."""
    for eye in ("LeftEye", "RightEye"):
        anim.turn(eye, left=left, up=up)


def keys_deg(frames: int, *poses: tuple[float, float]) -> Array:
    """Return `keys` whose values are in degrees [rad]."""
    return keys(frames, *poses) * DEGREE
