"""Head and eyes that look at a point, within the limits of a body.

Eyes jump (a saccade), the head follows, and meanwhile the eyes turn back by as much, so that the
gaze stays on the point and the eyes come to rest near their middle. The head leaves small turns to
the eyes (Stahl, "Amplitude of human head movements associated with horizontal saccades", 1999;
Guitton and Volle, "Gaze control in humans", 1987).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.characters.body.eye_range import range_share, within_range
from cubeling.characters.body.gaze_morphs import GazeMorphs, range_parts
from cubeling.characters.body.head_joints import HeadJoints, middle
from cubeling.characters.model.look_at import LookAt
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.skeleton.scalar_quaternions import (
    Quaternion,
    Vector,
    add,
    conjugate,
    from_rotation_vector,
    multiply,
    rotate,
    subtract,
    to_rotation_vector,
)
from cubeling.characters.smoothing import damped_spring

# How far a head turns, relative to the chest: slightly within the range of motion of a healthy
# adult's neck (Youdas et al., 1992).
MAX_HEAD_YAW_RAD = math.radians(72)  # to either side
MAX_HEAD_UP_RAD, MAX_HEAD_DOWN_RAD = math.radians(42), math.radians(48)
MAX_TARGET_YAW_RAD = math.radians(130)  # a target beyond is ignored

EYES_ALONE_RAD = math.radians(16)  # the eyes alone make turns that are much smaller
HEAD_YAW_SHARE, HEAD_PITCH_SHARE = 0.95, 0.8  # of large turns; the eyes help to look up and down
HEAD_LAG_S, EYE_LAG_S = 0.28, 0.035
_AHEAD: Vector = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Aversion:
    """A direction beside what is looked at."""

    yaw: float
    """To the left [rad]."""

    pitch: float
    """Upwards [rad]."""

    head_share: float
    """Share of the way that the head goes along, 0…1."""


class Gaze:
    """Turns neck, head and eyes of one character.

    Parameters
    ----------
    skeleton, anatomy
        Its joints.
    morphs
        Names of its morphs: without joints of eyes it looks about by those that do.
    look_at
        How its eyes follow, if its file says so.
    """

    def __init__(
        self,
        skeleton: Skeleton,
        anatomy: Anatomy,
        morphs: Sequence[str] = (),
        look_at: LookAt | None = None,
    ) -> None:
        head = anatomy.joint("head")
        self._joints = None if head is None else HeadJoints(skeleton, anatomy, head)
        has_eyes = self._joints is not None and bool(self._joints.eyes)
        by_morphs = not has_eyes or (look_at is not None and look_at.by == "expression")
        self._morphs = GazeMorphs.of(morphs) if by_morphs else None
        self._morph_count = len(morphs)
        # What is stated for joints does not hold for morphs.
        fits = look_at is not None and (look_at.by == "expression") == (self._morphs is not None)
        self._look_at = look_at if fits else None
        if self._joints is not None and look_at is not None and look_at.eye_offset is not None:
            self._joints.eye_offset = look_at.eye_offset
        self._yaw = self._pitch = self._yaw_speed = self._pitch_speed = 0.0
        self.shift = 0.0
        """Angle by which the target moved in the last update [rad]."""
        self._aim: tuple[float, float] | None = None
        self._turned: Vector = (0.0, 0.0, 0.0)  # neck and head, as a rotation vector [rad]
        self._eye_turns = [(0.0, 0.0), (0.0, 0.0)]

    def update(
        self,
        pose: Pose,
        target: Array | None,
        elapsed: float,
        head_share: float = 1.0,
        *,
        tempo: float = 1.0,
        head_drop: float = 0.0,
        head_turn: Array | None = None,
        averted: Aversion | None = None,
    ) -> Pose:
        """Advance by a time [s] and return the pose with head and eyes turned.

        Parameters
        ----------
        target
            The point to look at, (3,) in the character frame [m]; None for none.
        elapsed
            Time since the last call [s].
        head_share
            Part of its turn that the head makes, 0…1; the eyes look in any case.
        tempo
            Tempo of the head; 1 is normal.
        head_drop
            How far the head drops as well [rad]; the eyes compensate.
        head_turn
            How it nods and turns besides, a rotation vector about the chest's axes, (3,) [rad];
            the eyes compensate.
        averted
            How far the gaze is beside the point; None for on it.
        """
        joints = self._joints
        if joints is None:
            return pose
        joints.place(pose)
        body = joints.body
        back = conjugate(body)
        held = _angles(rotate(back, rotate(joints.head.facing, _AHEAD)))
        point: Vector | None = None
        if target is not None:
            x, y, z = target.tolist()
            point = (x, y, z)
        aim = self._aim_at(joints, back, point)
        self.shift = 0.0 if aim is None or self._aim is None else math.dist(aim, self._aim)
        self._aim = aim
        turn = (0.0, 0.0) if aim is None else _head_turn(aim, held, head_share)
        if averted is not None and aim is not None and point is not None:
            share = averted.head_share * head_share
            turn = turn[0] + share * averted.yaw, turn[1] + share * averted.pitch
            aim = aim[0] + averted.yaw, aim[1] + averted.pitch
            eyes = middle(joints.eye_places(self._turned))
            far = math.dist(point, eyes)
            point = add(eyes, rotate(body, _direction(aim, far)))
        lag = HEAD_LAG_S / tempo
        self._yaw, self._yaw_speed = damped_spring(
            self._yaw, self._yaw_speed, turn[0], elapsed, lag
        )
        self._pitch, self._pitch_speed = damped_spring(
            self._pitch, self._pitch_speed, turn[1], elapsed, lag
        )
        # Pitch is positive upwards, so a drop is subtracted.
        aimed = held[0] + self._yaw, held[1] + self._pitch - head_drop
        self._turned = rotate(body, _turn_between(held, aimed))
        x, y, z = (0.0, 0.0, 0.0) if head_turn is None else head_turn.tolist()
        if x or y or z:
            besides = from_rotation_vector(rotate(body, (x, y, z)))
            # A nod from the left: about the chest's axes, wherever the head looks.
            both = multiply(besides, from_rotation_vector(self._turned))
            self._turned = to_rotation_vector(both)
        local, weights = pose.rotations.copy(), pose.morphs
        joints.turn_head(local, self._turned)
        share = 1.0
        if aim is None:
            point = None
        else:
            share = range_share(aim[0] - held[0] - turn[0], aim[1] - held[1] - turn[1])
        if self._morphs is None:
            self._turn_eyes(joints, local, point, share, elapsed)
        else:
            weights = np.zeros(self._morph_count) if weights is None else weights.copy()
            self._morphs.look(weights, *self._morph_parts(joints, point, share, elapsed))
        return Pose(pose.translations, local, pose.scales, weights)

    def _aim_at(
        self, joints: HeadJoints, back: Quaternion, point: Vector | None
    ) -> tuple[float, float] | None:
        """Return yaw and pitch of a point relative to the chest; None if it is ignored.

        `back` turns the character's frame to the chest's.
        """
        if point is None:
            return None
        # Whether a point is behind does not depend on the head, or a head that turns away from it
        # and back would never come to rest.
        at_rest = middle([eye.place for eye in joints.eyes or [joints.head]])
        if abs(_angles(rotate(back, subtract(point, at_rest)))[0]) >= MAX_TARGET_YAW_RAD:
            return None
        # The head carries the eyes along, which matters for near points.
        way = subtract(point, middle(joints.eye_places(self._turned)))
        return None if max(map(abs, way)) < 1e-6 else _angles(rotate(back, way))

    def _turn_eyes(
        self,
        joints: HeadJoints,
        local: Array,
        point: Vector | None,
        share: float,
        elapsed: float,
    ) -> None:
        """Turn each eye in the turned head to the point, within a share of its range.

        Without a point the eyes go back to where they are in the pose.
        """
        facing = joints.head.facing
        from_head = conjugate(facing)
        back = multiply(from_head, conjugate(from_rotation_vector(self._turned)))
        # Exact for any frame rate, unlike a constant share of each frame.
        kept = math.exp(-elapsed / EYE_LAG_S)
        places = joints.eye_places(self._turned)
        for number, eye in enumerate(joints.eyes):
            held = _angles(rotate(from_head, rotate(eye.facing, _AHEAD)))
            target = (0.0, 0.0)
            if point is not None:
                asked = _angles(rotate(back, subtract(point, places[number])))
                if self._look_at is None:
                    yaw, pitch = within_range(*asked, share)
                else:
                    yaw, pitch = self._look_at.map_angles(*asked, "right" if number else "left")
                target = yaw - held[0], pitch - held[1]
            before = self._eye_turns[number]
            yaw, pitch = (w + (b - w) * kept for w, b in zip(target, before, strict=True))
            self._eye_turns[number] = yaw, pitch
            turn = _turn_between(held, (held[0] + yaw, held[1] + pitch))
            joints.turn(local, eye, rotate(facing, turn))

    def _morph_parts(
        self, joints: HeadJoints, point: Vector | None, share: float, elapsed: float
    ) -> tuple[float, float]:
        """Return how far both eyes look to the left and up in the turned head, 1 a whole morph.

        Without a point they go back to the middle.
        """
        target = (0.0, 0.0)
        if point is not None:
            back = conjugate(multiply(from_rotation_vector(self._turned), joints.head.facing))
            way = subtract(point, middle(joints.eye_places(self._turned)))
            asked = _angles(rotate(back, way))
            if self._look_at is None:
                target = range_parts(*within_range(*asked, share))
            else:
                target = self._look_at.map_angles(*asked)
        kept = math.exp(-elapsed / EYE_LAG_S)
        yaw, pitch = (w + (b - w) * kept for w, b in zip(target, self._eye_turns[0], strict=True))
        self._eye_turns[0] = yaw, pitch
        return yaw, pitch


def _head_turn(
    aim: tuple[float, float], held: tuple[float, float], share: float
) -> tuple[float, float]:
    """Return the turn of the head relative to the pose [rad]: yaw, pitch."""
    turns = []
    limits = (
        (-MAX_HEAD_YAW_RAD, MAX_HEAD_YAW_RAD, HEAD_YAW_SHARE),
        (-MAX_HEAD_DOWN_RAD, MAX_HEAD_UP_RAD, HEAD_PITCH_SHARE),
    )
    for angle, now, (low, high, most) in zip(aim, held, limits, strict=True):
        away = angle - now
        # A bell: nothing of small turns, nearly all of large ones, and smooth between them.
        turn = away * most * (1.0 - math.exp(-((away / EYES_ALONE_RAD) ** 2)))
        # The clamp is on where the head points, not on the turn: in an action it may be turned
        # already.
        turns.append((min(max(now + turn, low), high) - now) * share)
    return turns[0], turns[1]


def _angles(direction: Vector) -> tuple[float, float]:
    """Return yaw to the left and pitch upwards [rad] of a direction: left, up, forward."""
    x, y, z = direction
    return math.atan2(x, z), math.atan2(y, math.hypot(x, z))


def _direction(angles: tuple[float, float], length: float) -> Vector:
    """Return what is so far in the direction of a yaw to the left and a pitch upwards [rad]."""
    yaw, pitch = angles
    flat = length * math.cos(pitch)
    return flat * math.sin(yaw), length * math.sin(pitch), flat * math.cos(yaw)


def _turn_between(start: tuple[float, float], end: tuple[float, float]) -> Vector:
    """Return the rotation from one direction to another without roll, as a rotation vector [rad].

    The directions are yaws to the left and pitches upwards: first back to straight ahead by
    the yaw of one, then by the difference of the pitches, then by the yaw of the other.
    """
    half = (end[0] / 2, (start[1] - end[1]) / 2, -start[0] / 2)
    (sa, sb, sc), (ca, cb, cc) = map(math.sin, half), map(math.cos, half)
    first = (ca * sb, sa * cb, -sa * sb, ca * cb)
    return to_rotation_vector(multiply(first, (0.0, sc, 0.0, cc)))
