"""Feet that hold: a foot that has landed stays where it is until it lifts.

What a foot stands on, its heel or its ball, is held in the world, and so is the way it faces; where
the motion would have it otherwise is the foot's shift. When the foot lifts, the shift dies away
from the velocity that it had, so nothing pops: inertialisation (Bollo, GDC 2018), for a foot. A
foot that would have to be held too far from where the motion wants it takes a quick step there.
"""

import math
from dataclasses import dataclass

# Lengths are parts of the body's height.
_LANDS = 0.014  # a foot lands only so near to the ground
_FARTHEST, _TWISTED = 0.05, math.radians(40)  # a held foot is let go beyond this offset or turn
_UNTIDY, _ASKEW = 0.025, math.radians(20)  # and one of somebody who stands already beyond these
_ON_BALL, _ON_HEEL = (
    0.003,
    0.006,
)  # it stands on the heel if that is so much lower: still, and newly
_STEP_TIME = 0.22  # [s]: what a quick step takes
_STEP_HEIGHT, _STEP_SLOPE = 0.025, 0.35  # how high it goes: at most, and for its length
_STEP_LEAST = 6e-4  # and at least, of the body's height
_PEEL, _PEELED = 0.009, 0.02  # a foot that lifts is so high once it is so far from where it stood,
_FREE, _CLEAR = 0.06, 0.14  # and that begins to matter less from here on, and ends there
_FADE_TIME = 0.2  # [s]: after that nothing is left of an old shift
_TOUCH, _NEARLY = 0.35, 0.012  # part of a step before whose end it may land, if it is so near
_HASTE = 3.0  # [m/s of a body of 1 m, rad/s]: no offset starts to die away faster


@dataclass(frozen=True)
class FootPoints:
    """What of a foot meets the ground, in the world, as the motion has it [m]."""

    heel: tuple[float, float, float]
    """Point under the heel."""

    ball: tuple[float, float, float]
    """Joint of the toes, as high above the ground as it is when it stands."""

    @property
    def heading(self) -> float:
        """Where it points: the angle about +y from +z [rad]."""
        return math.atan2(self.ball[0] - self.heel[0], self.ball[2] - self.heel[2])

    @property
    def low(self) -> float:
        """How far the lower of both is above the ground."""
        return min(self.heel[1], self.ball[1])


@dataclass
class Shift:
    """How a foot is shown elsewhere than the motion has it: its ball moved, and turned about it."""

    x: float = 0.0
    """[m]."""

    z: float = 0.0
    """[m]."""

    yaw: float = 0.0
    """[rad]."""

    y: float = 0.0
    """[m]."""

    def moved(self, sole: FootPoints, heel: bool) -> tuple[float, float]:
        """Return x, z where the heel or the ball of a foot is shown."""
        ball = sole.ball[0] + self.x, sole.ball[2] + self.z
        if not heel:
            return ball
        x, z = turned(sole.heel[0] - sole.ball[0], sole.heel[2] - sole.ball[2], self.yaw)
        return ball[0] + x, ball[1] + z

    @property
    def length(self) -> float:
        """How far over the ground [m]."""
        return math.hypot(self.x, self.z)


class FootConstraint:
    """One foot: held, or on its way; advanced once a frame."""

    def __init__(self, height: float) -> None:
        self.held = False
        self.shift = Shift()
        """How it is shown elsewhere than the motion has it."""
        self.stepping = 0.0
        """What is left of a quick step [s]."""
        self.too_far = False
        """Whether the leg is too short to hold it."""
        self._height = height
        self._heel = False
        self.anchor = (0.0, 0.0, 0.0)
        """x, z [m] and heading [rad] of what is held, in the world."""
        self._left = (0.0, 0.0)  # where it stood last
        self._stride = 0.0  # of a quick step [m]
        self._shown = [0.0] * 4  # x, z, yaw, y
        self._pace = [0.0] * 4
        self._old, self._drift = [0.0] * 4, [0.0] * 4  # what dies away, as it was, and its pace
        self._age, self._fade_time = _FADE_TIME, _FADE_TIME

    def advance(self, sole: FootPoints, elapsed: float) -> None:
        """Go on as before to where the motion has the foot now."""
        self.stepping = max(self.stepping - elapsed, 0.0)
        self._age += elapsed
        rest, before = self._rest(), self._shown
        self._shown = [a + b for a, b in zip(self._goal(sole), rest, strict=True)]
        self.shift = Shift(*self._shown)
        if elapsed > 0.0:
            self._pace = [(a - b) / elapsed for a, b in zip(self._shown, before, strict=True)]

    def strained(self, standing: bool) -> bool:
        """Whether it is held too far from where the motion wants it."""
        far, askew = (_UNTIDY, _ASKEW) if standing else (_FARTHEST, _TWISTED)
        off = self.shift.length > far * self._height or abs(self.shift.yaw) > askew
        return off or self.too_far

    def hold(self, sole: FootPoints) -> None:
        """Hold the foot where it is shown: it lands, or rolls from heel to ball."""
        least = _ON_BALL if self._heel else _ON_HEEL
        heel = sole.heel[1] + least * self._height < sole.ball[1]
        if self.held and self._heel == heel:
            return
        self._heel = heel
        x, z = self.shift.moved(sole, self._heel)
        self.anchor = x, z, sole.heading + self.shift.yaw
        if not self.held:
            self.held = True
            self._fade([0.0, 0.0, 0.0, self.shift.y + sole.low], [0.0] * 4, _FADE_TIME)
            self.stepping = 0.0

    def release(self, sole: FootPoints, step: bool) -> None:
        """Let the foot go, in a quick step of its own or with the motion."""
        if not self.held:
            return
        self.held = self.too_far = False
        fastest = [_HASTE * self._height, _HASTE * self._height, _HASTE, _HASTE * self._height]
        pace = [min(max(v, -most), most) for v, most in zip(self._pace, fastest, strict=True)]
        self._fade(self._shown, pace, _STEP_TIME if step else _FADE_TIME)
        self._left = self.shift.moved(sole, heel=False)
        self._stride = self.shift.length
        self.stepping = _STEP_TIME if step else 0.0

    def lift(self, sole: FootPoints) -> None:
        """Keep a foot that is on its way clear of the ground, and every foot out of it."""
        least = -sole.low
        if self.stepping > 0.0:
            top = min(
                _STEP_HEIGHT * self._height, _STEP_SLOPE * self._stride + _STEP_LEAST * self._height
            )
            least = top * math.sin(math.pi * self.stepping / _STEP_TIME) ** 2 - sole.low
        elif not self.held:
            x, z = self.shift.moved(sole, heel=False)
            gone = math.hypot(x - self._left[0], z - self._left[1]) / self._height
            fading = min(max((_CLEAR - gone) / (_CLEAR - _FREE), 0.0), 1.0)
            least = _PEEL * self._height * min(gone / _PEELED, 1.0) * fading - sole.ball[1]
        if self.shift.y < least:
            self.shift.y = least

    def may_land(self, sole: FootPoints) -> bool:
        """Whether a foot that is on its way is so near to the ground, and to the end of a step."""
        near = sole.low + self.shift.y < _LANDS * self._height
        if self.stepping == 0.0:
            return near
        late = self.stepping < _TOUCH * _STEP_TIME
        return near and late and self.shift.length < _NEARLY * self._height

    def _fade(self, old: list[float], drift: list[float], length: float) -> None:
        """Let something die away from now on."""
        self._old, self._drift, self._age, self._fade_time = list(old), drift, 0.0, length

    def _rest(self) -> list[float]:
        """Return what is left of the old shift, by the quintic of `transition.OffsetDecay`."""
        if self._age >= self._fade_time:
            return [0.0] * 4
        u = self._age / self._fade_time
        position = 1 - u**3 * (10 - 15 * u + 6 * u * u)
        velocity = (u - u**3 * (6 - 8 * u + 3 * u * u)) * self._fade_time
        return [a * position + v * velocity for a, v in zip(self._old, self._drift, strict=True)]

    def _goal(self, sole: FootPoints) -> list[float]:
        """Return the shift that holds the foot exactly, or none if it is not held."""
        if not self.held:
            return [0.0] * 4
        x, z, heading = self.anchor
        yaw = math.remainder(heading - sole.heading, math.tau)
        if self._heel:
            ahead = turned(sole.ball[0] - sole.heel[0], sole.ball[2] - sole.heel[2], yaw)
            x, z = x + ahead[0], z + ahead[1]
        return [x - sole.ball[0], z - sole.ball[2], yaw, -sole.low]


def turned(x: float, z: float, yaw: float) -> tuple[float, float]:
    """Return x, z turned about +y."""
    sine, cosine = math.sin(yaw), math.cos(yaw)
    return cosine * x + sine * z, cosine * z - sine * x
