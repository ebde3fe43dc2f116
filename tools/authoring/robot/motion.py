"""What the robot's clips have in common: a tail that drags behind, blinks, bounces and stomps."""

import numpy as np

from tools.authoring.modelling.curves import Array, keys, later
from tools.authoring.modelling.quadruped import DEGREE, RATE, Performance, swing_tail
from tools.authoring.robot.rig import NECK, TAIL

LEVELS = ("head", "legs", "tail")
"""What joins in at intensities −1, 0 and 1."""
BODY = ("hips", "spine1", "chest")
BEND = (0.40, 0.33, 0.27)
"""How the joints of the neck share a bend."""


def tail(act: Performance, up: Array, left: Array, tip: float = 1.5, drag: float = 1.0) -> None:
    """Swing the tail; see `swing_tail`."""
    swing_tail(act, TAIL, up, left, tip, 4.6, drag, (0.6, 0.55))


def neck(act: Performance, up: Array, left: Array | float = 0.0, drag: float = 0.014) -> None:
    """Bend the neck as a whole [rad]; each joint comes a little after the one below it."""
    aside = np.broadcast_to(left, act.frames)
    for number, (joint, share) in enumerate(zip(NECK, BEND, strict=True)):
        late = drag * number
        act.turn(joint, up=share * later(up, late), left=share * later(aside, late))


def face_ahead(act: Performance, up: Array | float) -> None:
    """Hold the head so high [rad] from straight ahead, whatever the body under it does.

    To be called when all else is set: a robot that shows a mood looks at whom it shows it to.
    """
    below = [act.turns[joint][:, 0] for joint in (*BODY, *NECK) if joint in act.turns]
    act.turn("head", up=up - 0.85 * sum(below, start=np.zeros(act.frames)))


def blink(frames: int, *starts: float, seconds: float = 0.26) -> Array:
    """Return how shut the eyes are, 0…1, with blinks at phases: quick down, slower up."""
    length = seconds * RATE / frames
    shut = np.zeros(frames)
    for start in starts:
        lid = keys(frames, (0, 0), (0.4 * length, 1), (0.55 * length, 1), (length, 0), (0.99, 0))
        shut = np.maximum(shut, later(lid, start))
    return shut


def raised(frames: int, start: float, top: float, down: float) -> Array:
    """Return how high a foot is, 0…1: up slowly, a hold, and down hard."""
    hold = 0.5 * (top + down) + 0.01
    return keys(frames, (start, 0), (top, 1), (hold, 0.92), (down, 0), (start + 0.985, 0))


def look(act: Performance, left: Array, up: Array | float = 0.0) -> None:
    """Turn both eyes in the head [rad]."""
    for eye in ("LeftEye", "RightEye"):
        act.turn(eye, left=left, up=up)


def degrees(frames: int, *poses: tuple[float, float]) -> Array:
    """Return `keys` whose values are in degrees [rad]."""
    return keys(frames, *poses) * DEGREE
