"""Foot trajectories of a gait, without foot sliding.

A foot is fixed in the world for its whole stance: heel strike, flat, then roll-off over the ball.
In the swing it follows a smooth curve in the frame of the root, which moves along an arc of
constant speed and yaw rate. So in a turn the outer foot takes longer steps.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.skeleton import rotations
from tools.authoring.modelling.curves import smoothstep
from tools.authoring.modelling.shapes import Array

MAX_SPIN_RAD = 5.0
"""Pitch that a foot which leaves fast would gain in the time of its swing [rad]: an ankle that
points the toes gives way."""


@dataclass(frozen=True)
class GroundArc:
    """An arc over the ground, from the origin along +z."""

    speed: float
    """Along the arc [m/s]."""

    yaw_rate: float
    """Counter-clockwise seen from above [rad/s]."""

    def at(self, time: Array) -> tuple[Array, Array]:
        """Return x, z, (…, 2) [m], and yaw, (…,) [rad], at times [s]."""
        yaw = self.yaw_rate * time
        chord = self.speed * time * np.sinc(yaw / 2 / np.pi)
        return np.stack([chord * np.sin(yaw / 2), chord * np.cos(yaw / 2)], axis=-1), yaw

    def seen(self, at: Array, seer: Array) -> tuple[Array, Array]:
        """Return the root at times `at`, relative to the root at times `seer`."""
        return self.at(at - seer)


@dataclass(frozen=True)
class Footfalls:
    """Timing and shape of the steps."""

    cycle: float
    """Duration of two steps [s]."""

    stance: float
    """Share of the cycle in stance; below 0.5 there is a flight phase."""

    width: float
    """Distance of a foot from the path [m]."""

    ahead: float
    """Distance of a foot ahead of the root at mid-stance [m]."""

    heel_strike: float
    """Pitch of the foot at landing, toes up [rad]."""

    toe_off: float
    """Pitch of the foot at toe-off, heel up [rad]."""

    lift: float
    """Height of the swing above a straight curve [m]."""

    toe_out: float = 0.1
    """Outward angle of the feet [rad]."""

    rise_from: float = 0.5
    """Share of the stance after which the heel rises."""

    retract: float = 0.5
    """Retraction: share of its speed that a foot loses before landing, 0…1."""

    rise_fall: tuple[float, float] = (2.0, 3.0)
    """Powers with which a swing rises at first and falls in the end."""


@dataclass(frozen=True)
class FootDimensions:
    """Dimensions of a flat foot, from the ground under its ankle."""

    ankle: float
    """Height of the ankle [m]."""

    heel: float
    """z of the point under the heel on which it lands, negative [m]."""

    ball: tuple[float, float]
    """y and z of the joint of the toes [m]."""

    toes: float
    """Length of the toes ahead of their joint [m]."""

    def ball_height(self, ankle: Array, pitch: Array) -> Array:
        """Return the height of the joint of the toes for a height and pitch of the ankle [m]."""
        return ankle + np.cos(pitch) * (self.ball[0] - self.ankle) - np.sin(pitch) * self.ball[1]


@dataclass(frozen=True)
class FootMotion:
    """One foot over the cycle, in the frame of the root."""

    ankle: Array
    """(frames, 3) [m]."""

    facing: Array
    """(frames, 4)."""

    toe: Array
    """Bend of the toes, positive upwards, (frames,) [rad]."""

    down: NDArray[np.bool_]
    """Whether the foot is planted, (frames,)."""


def foot_motion(
    path: GroundArc, steps: Footfalls, foot: FootDimensions, side: float, phase: Array
) -> FootMotion:
    """Return the motion of a foot over the cycle.

    Parameters
    ----------
    side : +1 for the left foot, which strikes at phase 0; −1 for the right, at phase 0.5
    phase : (frames,), 0…1
    """
    own = (phase + (0.0 if side > 0 else 0.5)) % 1.0
    own = np.where(np.isclose(own, 1.0), 0.0, own)
    stance_time = steps.stance * steps.cycle
    swing_time = steps.cycle - stance_time
    since = own * steps.cycle  # time since heel strike
    ankle, yaw, pitch, toe = _planted(path, steps, foot, side, np.minimum(since, stance_time))
    u = np.clip((since - stance_time) / swing_time, 0.0, 1.0)
    off, strike = np.array([stance_time]), np.array([0.0])
    ends = [_planted(path, steps, foot, side, t) for t in (off, strike)]
    tiny = 1e-4
    before = _planted(path, steps, foot, side, off - tiny)
    after = _planted(path, steps, foot, side, strike + tiny)
    leave = (ends[0][0] - before[0]) / tiny * swing_time
    land = (after[0] - ends[1][0]) / tiny * swing_time * (1.0 - steps.retract)
    swing = _hermite(u[:, None], ends[0][0], ends[1][0], leave, land)
    rise, fall = steps.rise_fall
    top = rise / (rise + fall)
    swing[:, 1] += steps.lift * (u / top) ** rise * ((1 - u) / (1 - top)) ** fall
    spin = np.minimum((ends[0][2] - before[2]) / tiny * swing_time, MAX_SPIN_RAD)
    swing_pitch = _hermite(u, ends[0][2], ends[1][2], spin, 0)
    ease = smoothstep(u)
    swing_yaw = ends[0][1] + (ends[1][1] - ends[0][1]) * ease
    room = foot.ball_height(swing[:, 1], swing_pitch) - foot.ball[0]
    peel = swing_pitch - np.arcsin(
        np.clip(room / foot.toes, -1.0, 1.0)
    )  # keeps the tip above ground
    swing_toe = np.maximum(ends[0][3] * np.clip(1 - 3 * u, 0, 1) ** 2, peel)
    up = u > 0
    ankle = np.where(up[:, None], swing, ankle)
    yaw, pitch, toe = (
        np.where(up, a, b) for a, b in ((swing_yaw, yaw), (swing_pitch, pitch), (swing_toe, toe))
    )
    facing = rotations.multiply(rotations.about("y", yaw), rotations.about("x", pitch))
    return FootMotion(ankle, facing, toe, ~up)


def _planted(
    path: GroundArc, steps: Footfalls, foot: FootDimensions, side: float, since: Array
) -> tuple[Array, Array, Array, Array]:
    """Return ankle, yaw, pitch and toe bend of a planted foot, relative to the moving root."""
    duration = steps.stance * steps.cycle
    place, yaw = path.seen(np.full_like(since, duration / 2), since)
    toe_out = side * steps.toe_out
    part = since / duration
    strike = steps.heel_strike * (1 - smoothstep(part / 0.18))
    rise = steps.toe_off * np.clip((part - steps.rise_from) / (1 - steps.rise_from), 0, 1) ** 2
    # Over the heel first, then flat, then over the ball.
    y, z = _about_pivot(foot.ankle, 0.0, 0.0, foot.heel, -strike)
    ball_y, ball_z = _about_pivot(foot.ankle, 0.0, *foot.ball, rise)
    y, z = np.where(rise > 0, ball_y, y), np.where(rise > 0, ball_z, z)
    forward = np.stack([np.sin(yaw), np.cos(yaw)], axis=-1)
    left = np.stack([np.cos(yaw), -np.sin(yaw)], axis=-1)
    toes = np.stack([np.sin(yaw + toe_out), np.cos(yaw + toe_out)], axis=-1)
    ground = place + side * steps.width * left + steps.ahead * forward + z[..., None] * toes
    ankle = np.stack([ground[..., 0], y, ground[..., 1]], axis=-1)
    return ankle, yaw + toe_out, rise - strike, rise


def _about_pivot(
    y: float, z: float, pivot_y: float, pivot_z: float, pitch: Array
) -> tuple[Array, Array]:
    """Return y and z rotated about the x axis through a pivot."""
    c, s = np.cos(pitch), np.sin(pitch)
    dy, dz = y - pivot_y, z - pivot_z
    return pivot_y + c * dy - s * dz, pivot_z + s * dy + c * dz


def _hermite(u: Array, start: Array, end: Array, leave: Array, land: Array | float) -> Array:
    """Return the cubic from start to end with these slopes over u = 0…1."""
    u2, u3 = u * u, u * u * u
    mixed = (2 * u3 - 3 * u2 + 1) * start + (3 * u2 - 2 * u3) * end
    return np.asarray(mixed + (u3 - 2 * u2 + u) * leave + (u3 - u2) * land)
