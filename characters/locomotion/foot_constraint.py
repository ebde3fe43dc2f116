"""Foot constraints: a foot that has landed stays in place until it lifts.

The heel or the ball is held in the world, and so is the heading. When the foot lifts, its offset
from the motion decays from its present velocity: inertialization (Bollo, GDC 2018) for a foot. A
foot whose offset becomes too large takes a quick step.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

from cubeling.characters.motion.inertialization import quintic_decay

# Lengths are in body heights.
_MAX_LANDING_HEIGHT = 0.014
_MAX_OFFSET, _MAX_TWIST_RAD = 0.05, math.radians(40)  # a held foot is released beyond these
_MAX_STANDING_OFFSET, _MAX_STANDING_TWIST_RAD = 0.025, math.radians(20)  # while standing
# How much lower than the ball the heel must be to be held: if it is held already, and if not.
_HEEL_MARGIN_HELD, _HEEL_MARGIN_NEW = 0.003, 0.006
_QUICK_STEP_S = 0.22
# Height of a quick step: at most, for each unit of its length, and at least.
_MAX_STEP_HEIGHT, _STEP_HEIGHT_PER_LENGTH, _MIN_STEP_HEIGHT = 0.025, 0.35, 6e-4
# A lifting foot is raised so high once it is so far from where it stood; …
_LIFT_HEIGHT, _LIFT_DISTANCE = 0.009, 0.02
_LIFT_FADE_START, _LIFT_FADE_END = 0.06, 0.14  # … this fades out between these distances
# A foot that is faster than the first of these speeds comes no nearer to the ground than this
# height, from the second speed on: a swinging foot does not brush the ground before it lands.
_BRUSHING_SPEEDS, _CLEARANCE = (0.5, 1.5), 0.008
_CLEARING_S = 0.08  # from when it is let go until that holds
_OFFSET_DECAY_S = 0.2
# A quick step may land early within this part of its end, if it is so near.
_EARLY_LANDING_SHARE, _EARLY_LANDING_DISTANCE = 0.35, 0.012
_MAX_DECAY_SPEED = 3.0  # [body heights/s, rad/s]: limit of the initial velocity of a decay


class FootPoints(NamedTuple):
    """The points of a foot that touch the ground, in the world, in the motion [m]."""

    heel: tuple[float, float, float]
    """Point below the heel."""

    ball: tuple[float, float, float]
    """Joint of the toes; its height is relative to that of a standing foot."""

    @property
    def heading(self) -> float:
        """Angle about +y from +z [rad]."""
        return math.atan2(self.ball[0] - self.heel[0], self.ball[2] - self.heel[2])

    @property
    def height(self) -> float:
        """Height of the lower point above the ground."""
        return min(self.heel[1], self.ball[1])


@dataclass
class FootOffset:
    """Difference between the shown foot and the motion: its ball is moved, and it is turned."""

    x: float = 0.0
    """[m]."""

    z: float = 0.0
    """[m]."""

    yaw: float = 0.0
    """About the ball [rad]."""

    y: float = 0.0
    """[m]."""

    def shown_point(self, points: FootPoints, heel: bool) -> tuple[float, float]:
        """Return x, z of the shown heel or ball of a foot."""
        ball = points.ball[0] + self.x, points.ball[2] + self.z
        if not heel:
            return ball
        x, z = rotate_yaw(
            points.heel[0] - points.ball[0], points.heel[2] - points.ball[2], self.yaw
        )
        return ball[0] + x, ball[1] + z

    @property
    def length(self) -> float:
        """How far the ball is shown from where the motion has it, over the ground [m]."""
        return math.hypot(self.x, self.z)


class FootConstraint:
    """State of one foot: held, or moving; advanced once a frame.

    A foot that `rolls` has its toes where it rolls onto the ball, so one of its points is on the
    ground while it is held. Others may stand on what is in front of the toes, and are only raised.
    """

    def __init__(self, body_height: float, rolls: bool = True) -> None:
        self._rolls = rolls
        self.held = False
        self.offset = FootOffset()
        """The present offset."""
        self.step_time_left = 0.0
        """Rest of a quick step [s]."""
        self.out_of_reach = False
        """Whether the leg is too short to hold the foot."""
        self.anchor = (0.0, 0.0, 0.0)
        """x, z [m] and heading [rad] of the held point, in the world."""
        self._body_height = body_height
        self._heel = False
        self._last_stand = (0.0, 0.0)
        self._step_length = 0.0
        self._raised = 0.0  # height of the offset as last shown
        self._before: FootPoints | None = None  # in the motion, one frame ago
        self._speed = 0.0  # of the ball in the motion [body heights/s]
        self._least_speed = 0.0  # of ball or heel
        self._shown = [0.0] * 4  # x, z, yaw, y of the offset
        self._velocity = [0.0] * 4
        self._last_height = 0.0  # y of the offset one frame ago
        # The decaying offset: initial value and velocity, age and length.
        self._old, self._old_velocity = [0.0] * 4, [0.0] * 4
        self._age, self._decay_time = _OFFSET_DECAY_S, _OFFSET_DECAY_S

    def advance(self, points: FootPoints, elapsed: float) -> None:
        """Advance by a time [s] to the present points of the motion."""
        self.step_time_left = max(self.step_time_left - elapsed, 0.0)
        self._age += elapsed
        decayed, shown = self._decay(), self._shown
        self._shown = [a + b for a, b in zip(self._goal(points), decayed, strict=True)]
        self.offset = FootOffset(*self._shown)
        self._last_height = shown[3]
        # Two updates at one time, as after a seek, must not divide by zero.
        if elapsed > 0.0:
            before = self._before or points
            moved = math.dist(before.ball, points.ball), math.dist(before.heel, points.heel)
            self._speed = moved[0] / (elapsed * self._body_height)
            self._least_speed = min(moved) / (elapsed * self._body_height)
            self._before = points
            self._velocity = [(a - b) / elapsed for a, b in zip(self._shown, shown, strict=True)]

    @property
    def age(self) -> float:
        """Time since it was last held or let go [s]."""
        return self._age

    def is_strained(self, standing: bool) -> bool:
        """Return whether its offset is too large; the limits are smaller while standing."""
        distance, twist = (
            (_MAX_STANDING_OFFSET, _MAX_STANDING_TWIST_RAD)
            if standing
            else (_MAX_OFFSET, _MAX_TWIST_RAD)
        )
        far = self.offset.length > distance * self._body_height
        return far or abs(self.offset.yaw) > twist or self.out_of_reach

    def hold(self, points: FootPoints) -> None:
        """Hold the foot where it is shown: it lands, or rolls from heel to ball."""
        margin = _HEEL_MARGIN_HELD if self._heel else _HEEL_MARGIN_NEW
        heel = points.heel[1] + margin * self._body_height < points.ball[1]
        # Rolling from heel to ball only moves the anchor; landing also starts a decay of the
        # height.
        if self.held and self._heel == heel:
            return
        self._heel = heel
        x, z = self.offset.shown_point(points, self._heel)
        self.anchor = x, z, points.heading + self.offset.yaw
        if not self.held:
            self.held = True
            self.offset.y = self._raised
            landing = [0.0, 0.0, 0.0, self.offset.y - self._to_ground(points)]
            # Height only: x, z and heading are held exactly from the first frame on, so nothing
            # slides.
            self._start_decay(landing, [0.0] * 4, _OFFSET_DECAY_S)
            self.step_time_left = 0.0

    def release(self, points: FootPoints, step: bool) -> None:
        """Release the foot, for a quick step or to follow the motion."""
        if not self.held:
            return
        self.held = self.out_of_reach = False
        speed = _MAX_DECAY_SPEED * self._body_height
        limits = [speed, speed, _MAX_DECAY_SPEED, speed]
        velocity = [
            min(max(v, -most), most) for v, most in zip(self._velocity, limits, strict=True)
        ]
        # It stood still while its motion rose already, and makes up for it, not to drag.
        self._shown[3] = max(self._shown[3], self._last_height)
        # Never into the ground: while held, the offset fell as the motion rose.
        velocity[3] = max(velocity[3], 0.0)
        self._start_decay(self._shown, velocity, _QUICK_STEP_S if step else _OFFSET_DECAY_S)
        self.offset.y = self._shown[3]
        self._last_stand = self.offset.shown_point(points, heel=False)
        self._step_length = self.offset.length
        self.step_time_left = _QUICK_STEP_S if step else 0.0

    def lift(self, points: FootPoints) -> None:
        """Keep a moving foot clear of the ground, and any foot above it."""
        lowest = -points.height
        if self.step_time_left > 0.0:
            top = min(
                _MAX_STEP_HEIGHT * self._body_height,
                _STEP_HEIGHT_PER_LENGTH * self._step_length + _MIN_STEP_HEIGHT * self._body_height,
            )
            angle = math.pi * self.step_time_left / _QUICK_STEP_S
            # sin² starts and ends without vertical speed, so that the foot neither jerks nor
            # stamps.
            lowest = top * math.sin(angle) ** 2 - points.height
        elif not self.held:
            x, z = self.offset.shown_point(points, heel=False)
            away = math.hypot(x - self._last_stand[0], z - self._last_stand[1]) / self._body_height
            fade = (_LIFT_FADE_END - away) / (_LIFT_FADE_END - _LIFT_FADE_START)
            raised = _LIFT_HEIGHT * self._body_height * min(away / _LIFT_DISTANCE, 1.0)
            lowest = raised * min(max(fade, 0.0), 1.0) - points.ball[1]
        if self.offset.y < lowest:
            self.offset.y = lowest
        if not self.held:
            self.offset.y += self._clearance(points.ball[1] + self.offset.y)
        self._raised = self.offset.y

    def _clearance(self, height: float) -> float:
        """Return by how much to raise a moving ball that is shown at a height [m]."""
        slow, fast = _BRUSHING_SPEEDS
        share = min(max((self._speed - slow) / (fast - slow), 0.0), 1.0)
        share *= min(self._age / _CLEARING_S, 1.0)
        least = _CLEARANCE * self._body_height * share
        if least == 0.0 or height >= 2.0 * least:
            return 0.0
        # A parabola that meets both lines smoothly: the foot is eased over the clearance, not
        # clipped at it.
        return (2.0 * least - max(height, 0.0)) ** 2 / (4.0 * least)

    def may_land(self, points: FootPoints) -> bool:
        """Return whether a moving foot is near the ground, and near the end of a quick step."""
        low = points.height + self._raised < _MAX_LANDING_HEIGHT * self._body_height
        if self.step_time_left == 0.0:
            # While a jump between clips passes over, a foot may still swing that stands in the new
            # one: held, it would stop dead.
            return low and self._least_speed < _BRUSHING_SPEEDS[1]
        late = self.step_time_left < _EARLY_LANDING_SHARE * _QUICK_STEP_S
        return low and late and self.offset.length < _EARLY_LANDING_DISTANCE * self._body_height

    def _start_decay(self, old: list[float], velocity: list[float], length: float) -> None:
        self._old, self._old_velocity = list(old), velocity
        self._age, self._decay_time = 0.0, length

    def _decay(self) -> list[float]:
        if self._age >= self._decay_time:
            return [0.0] * 4
        position, velocity = quintic_decay(self._age / self._decay_time)
        velocity *= self._decay_time
        return [
            a * position + v * velocity for a, v in zip(self._old, self._old_velocity, strict=True)
        ]

    def _goal(self, points: FootPoints) -> list[float]:
        """Return the offset that holds the foot exactly, or zeros if it is not held."""
        if not self.held:
            return [0.0] * 4
        x, z, heading = self.anchor
        # The shorter way round: headings jump by a turn behind the body.
        yaw = math.remainder(heading - points.heading, math.tau)
        if self._heel:
            dx, dz = points.ball[0] - points.heel[0], points.ball[2] - points.heel[2]
            ahead = rotate_yaw(dx, dz, yaw)
            x, z = x + ahead[0], z + ahead[1]
        return [x - points.ball[0], z - points.ball[2], yaw, self._to_ground(points)]

    def _to_ground(self, points: FootPoints) -> float:
        """Return how far a held foot is raised from its motion [m]; negative if it is lowered."""
        return -points.height if self._rolls else max(-points.height, 0.0)


def rotate_yaw(x: float, z: float, yaw: float) -> tuple[float, float]:
    """Return x, z rotated about +y."""
    sine, cosine = math.sin(yaw), math.cos(yaw)
    # About +y, from +z towards +x: the signs differ from those of the usual x, y plane.
    return cosine * x + sine * z, cosine * z - sine * x
