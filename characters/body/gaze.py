"""Head and eyes that look at a point, within the limits of a body.

Eyes jump (a saccade), the head follows, and meanwhile the eyes turn back by as much, so that the
gaze stays on the point. The head leaves small turns to the eyes (Stahl, "Amplitude of human head
movements associated with horizontal saccades", 1999; Guitton and Volle, "Gaze control in humans",
1987).
"""

import math
from dataclasses import dataclass

import numpy as np

from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Array, Pose, Skeleton
from characters.skeleton.rotations import from_matrix
from characters.skeleton.scalar_quaternions import (
    IDENTITY,
    Quaternion,
    Vector,
    conjugate,
    from_rotation_vector,
    multiply,
    rotate,
    subtract,
    to_rotation_vector,
)
from characters.smoothing import damped_spring

# How far a body can look, relative to its chest: slightly within the range of motion of a healthy
# adult's neck (Youdas et al., 1992), and within that of the eyes, since drawn lids hide no more.
MAX_HEAD_YAW_RAD = math.radians(72)  # to either side
MAX_HEAD_UP_RAD, MAX_HEAD_DOWN_RAD = math.radians(42), math.radians(48)
MAX_EYE_YAW_RAD, MAX_EYE_PITCH_RAD = math.radians(24), math.radians(15)  # in the head
MAX_TARGET_YAW_RAD = math.radians(130)  # a target beyond is ignored

EYES_ONLY_RAD = math.radians(9)  # turns up to this are made by the eyes alone
HEAD_SHARE = 0.92  # part of the rest that the head takes
HEAD_LAG_S, EYE_LAG_S = 0.34, 0.035
_AHEAD: Vector = (0.0, 0.0, 1.0)


@dataclass
class _Joint:
    """A joint on the way from the root to the head or an eye."""

    number: int
    """Its index in the skeleton."""

    parent: int
    """Index of its parent among these joints; −1 for none."""

    rest: Quaternion
    """Its rotation at rest, in the character frame."""

    turn: Quaternion = IDENTITY
    """Its present rotation, in the character frame."""

    place: Vector = (0.0, 0.0, 0.0)
    """Its present position."""

    scale: Vector = (1.0, 1.0, 1.0)
    """Its present scale, which stretches its children's translations."""

    @property
    def facing(self) -> Quaternion:
        """The body's axes as this joint turns them."""
        return multiply(self.turn, conjugate(self.rest))


class Gaze:
    """Turns neck, head and eyes of one character."""

    def __init__(self, skeleton: Skeleton, anatomy: Anatomy) -> None:
        head = anatomy.joint("head")
        self._able = head is not None
        self._yaw = self._pitch = self._yaw_speed = self._pitch_speed = 0.0
        self.shift = 0.0
        """Angle by which the target moved in the last update [rad]."""
        self._aim: tuple[float, float] | None = None
        if head is None:
            return
        line = _line(head, anatomy.joint("neck"), skeleton)
        eyes = [j for side in ("left", "right") if (j := anatomy.joint(f"{side}Eye")) is not None]
        self._joints = _with_ancestors(skeleton, [*line, *eyes])
        places = {joint.number: place for place, joint in enumerate(self._joints)}
        self._numbers = np.array([joint.number for joint in self._joints], np.intp)
        self._line = [self._joints[places[joint]] for joint in line]
        self._eyes = [self._joints[places[joint]] for joint in eyes]
        self._eye_turns = [(0.0, 0.0)] * len(eyes)

    def update(
        self,
        pose: Pose,
        target: Array | None,
        elapsed: float,
        head_share: float = 1.0,
        *,
        tempo: float = 1.0,
        head_drop: float = 0.0,
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
        """
        if not self._able:
            return pose
        self._place(pose)
        body, head = self._body(), self._line[-1]
        held = _angles(rotate(conjugate(body), rotate(head.facing, _AHEAD)))
        point: Vector | None = None
        if target is not None:
            x, y, z = target.tolist()
            point = (x, y, z)
        aim = self._aimed(body, point)
        self.shift = 0.0 if aim is None or self._aim is None else math.dist(aim, self._aim)
        self._aim = aim
        turn = (0.0, 0.0) if aim is None else self._head_turn(aim, held, head_share)
        lag = HEAD_LAG_S / tempo
        self._yaw, self._yaw_speed = damped_spring(
            self._yaw, self._yaw_speed, turn[0], elapsed, lag
        )
        self._pitch, self._pitch_speed = damped_spring(
            self._pitch, self._pitch_speed, turn[1], elapsed, lag
        )
        aimed = held[0] + self._yaw, held[1] + self._pitch - head_drop
        turned = rotate(body, _turn_between(held, aimed))
        local = pose.rotations.copy()
        self._turn_line(local, turned)
        if self._eyes:
            self._turn_eyes(local, turned, point if aim is not None else None, elapsed)
        return Pose(pose.translations, local, pose.scales, pose.morphs)

    def _place(self, pose: Pose) -> None:
        """Compute the joints' rotations and positions in a pose."""
        turns = pose.rotations[self._numbers].tolist()
        shifts = pose.translations[self._numbers].tolist()
        scales = None if pose.scales is None else pose.scales[self._numbers].tolist()
        for number, (joint, own, shift) in enumerate(zip(self._joints, turns, shifts, strict=True)):
            joint.turn, joint.place = own, shift
            if joint.parent >= 0:
                above = self._joints[joint.parent]
                if scales is not None:
                    shift = [a * b for a, b in zip(shift, above.scale, strict=True)]
                x, y, z = rotate(above.turn, shift)
                px, py, pz = above.place
                joint.turn, joint.place = multiply(above.turn, own), (x + px, y + py, z + pz)
            if scales is not None:
                # Shear is neglected: bodies are scaled along their joints' axes, or uniformly.
                before = self._joints[joint.parent].scale if joint.parent >= 0 else (1.0, 1.0, 1.0)
                sx, sy, sz = scales[number]
                joint.scale = (before[0] * sx, before[1] * sy, before[2] * sz)

    def _body(self) -> Quaternion:
        """Return the rotation of the chest."""
        base = self._line[0].parent
        return self._joints[base].facing if base >= 0 else IDENTITY

    def _aimed(self, body: Quaternion, point: Vector | None) -> tuple[float, float] | None:
        """Return yaw and pitch of a point relative to the chest; None if it is ignored."""
        if point is None:
            return None
        eyes = self._eyes or self._line[-1:]
        middle = [sum(eye.place[axis] for eye in eyes) / len(eyes) for axis in range(3)]
        way = subtract(point, (middle[0], middle[1], middle[2]))
        if max(map(abs, way)) < 1e-6:
            return None
        aim = _angles(rotate(conjugate(body), way))
        return aim if abs(aim[0]) < MAX_TARGET_YAW_RAD else None

    def _head_turn(
        self, aim: tuple[float, float], held: tuple[float, float], share: float
    ) -> tuple[float, float]:
        """Return the turn of the head relative to the pose [rad]: yaw, pitch."""
        turns = []
        ranges = ((-MAX_HEAD_YAW_RAD, MAX_HEAD_YAW_RAD), (-MAX_HEAD_DOWN_RAD, MAX_HEAD_UP_RAD))
        for angle, now, (low, high) in zip(aim, held, ranges, strict=True):
            away = angle - now
            beyond = math.copysign(max(abs(away) - EYES_ONLY_RAD, 0.0) * HEAD_SHARE, away)
            at = min(max(now + beyond, low), high)
            turns.append((at - now) * share)
        return turns[0], turns[1]

    def _turn_line(self, local: Array, turned: Vector) -> None:
        """Turn neck and head: each joint of the chain by an equal part.

        Powers of one rotation commute: the part of each joint is the same vector, in the frame of
        its parent before the turn.
        """
        x, y, z = (value / len(self._line) for value in turned)
        for joint in self._line:
            part = (x, y, z)
            if joint.parent >= 0:
                part = rotate(conjugate(self._joints[joint.parent].turn), part)
            local[joint.number] = multiply(from_rotation_vector(part), local[joint.number].tolist())

    def _turn_eyes(
        self, local: Array, turned: Vector, point: Vector | None, elapsed: float
    ) -> None:
        """Turn each eye in the turned head to the point."""
        head, whole = self._line[-1], from_rotation_vector(turned)
        back = conjugate(multiply(whole, head.facing))
        kept = math.exp(-elapsed / EYE_LAG_S)
        for number, eye in enumerate(self._eyes):
            target = (0.0, 0.0)
            if point is not None:
                x, y, z = rotate(whole, subtract(eye.place, head.place))
                place = (x + head.place[0], y + head.place[1], z + head.place[2])
                yaw, pitch = _angles(rotate(back, subtract(point, place)))
                target = (
                    min(max(yaw, -MAX_EYE_YAW_RAD), MAX_EYE_YAW_RAD),
                    min(max(pitch, -MAX_EYE_PITCH_RAD), MAX_EYE_PITCH_RAD),
                )
            before = self._eye_turns[number]
            yaw, pitch = (w + (b - w) * kept for w, b in zip(target, before, strict=True))
            self._eye_turns[number] = yaw, pitch
            # About the body's up, and about its left downwards, in the frame of the eye.
            own = rotate(conjugate(eye.rest), (-pitch, yaw, 0.0))
            local[eye.number] = multiply(local[eye.number].tolist(), from_rotation_vector(own))


def _with_ancestors(skeleton: Skeleton, joints: list[int]) -> list[_Joint]:
    """Return joints with all their ancestors, parents first."""
    order = skeleton.with_ancestors(joints)
    place = {joint: number for number, joint in enumerate(order)} | {-1: -1}
    matrices = skeleton.rest.globals(skeleton)[order, :3, :3]
    sizes = np.linalg.norm(matrices, axis=1, keepdims=True)
    rest = from_matrix(matrices / np.where(sizes > 0, sizes, 1.0)).tolist()
    return [
        _Joint(joint, place[skeleton.parents[joint]], tuple(turned))
        for joint, turned in zip(order, rest, strict=True)
    ]


def _line(head: int, neck: int | None, skeleton: Skeleton) -> list[int]:
    """Return the joints from the neck to the head; without a neck, the head alone."""
    line = [head]
    while neck is not None and line[-1] not in (neck, -1):
        line.append(skeleton.parents[line[-1]])
    return line[::-1] if line[-1] == neck else [head]


def _angles(direction: Vector) -> tuple[float, float]:
    """Return yaw to the left and pitch upwards [rad] of a direction: left, up, forward."""
    x, y, z = direction
    return math.atan2(x, z), math.atan2(y, math.hypot(x, z))


def _turn_between(start: tuple[float, float], end: tuple[float, float]) -> Vector:
    """Return the rotation from one direction to another without roll, as a rotation vector [rad].

    The directions are yaws to the left and pitches upwards: first back to straight ahead by
    the yaw of one, then by the difference of the pitches, then by the yaw of the other.
    """
    half = (end[0] / 2, (start[1] - end[1]) / 2, -start[0] / 2)
    (sa, sb, sc), (ca, cb, cc) = map(math.sin, half), map(math.cos, half)
    first = (ca * sb, sa * cb, -sa * sb, ca * cb)
    return to_rotation_vector(multiply(first, (0.0, sc, 0.0, cc)))
