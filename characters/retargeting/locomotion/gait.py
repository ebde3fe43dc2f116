"""One cycle of a gait on its arc, to be bent to any other arc."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from characters.motion.clip import Clip
from characters.retargeting.body import Body, Leg, turns_of
from characters.retargeting.feet import Footing, hold
from characters.retargeting.ground import Way
from characters.retargeting.locomotion.arcs import Course
from characters.retargeting.transfer import ankle
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose

_GRAVITY = 9.81 / 0.92  # [leg lengths/s²]: of a person's legs, which all bodies are measured by
_LEANS, _LEAN = 0.6, 0.22  # how much of the balance in a curve is leaning, at most [rad]
_AHEAD, _GLANCE = 0.25, 0.4  # [s] that the head looks ahead in a curve, at most [rad]


@dataclass(frozen=True)
class Gait:
    """A loop of walking or running."""

    origin: str
    """Where it is from."""

    clip: Clip
    """One cycle with its root on the course from the origin, from a left landing on."""

    body: Body
    """What it moves."""

    footing: Footing
    """When its feet stand."""

    course: Course
    """How it goes over the ground."""

    seam: float
    """How far the joints were apart where it was closed, root mean square [m]."""

    @property
    def legs(self) -> tuple[Leg, ...]:
        """The legs that stand."""
        return self.body.legs[: self.footing.ball.shape[1]]

    def on(self, course: Course) -> "Gait":
        """Return the gait on another course, its footprints bent with it."""
        times = np.arange(len(self.clip)) / self.clip.rate
        share = course.speed / self.course.speed
        change = course.curvature * share - self.course.curvature
        pose = _on_root(self.clip.poses, course.at(times))
        pose = self._leaning(pose, course)
        ends = np.empty((len(times), len(self.legs), 3))
        for number, leg in enumerate(self.legs):
            beside = self.course.beside(self._end(leg), times)
            twist = change * (beside[:, 0] - self.course.speed * times)
            pose = _foot_turned(pose, self.body, leg, twist)
            beside[:, 0] *= share
            ends[:, number] = course.places(beside)
        way = Way(np.zeros((len(times), 3)), course.at(times[-1:])[0], self.clip.rate)
        pose = _sealed(hold(pose, self.body, self.legs, self.footing, way, ends))
        return replace(self, clip=replace(self.clip, poses=pose), course=course)

    def _end(self, leg: Leg) -> Array:
        """Return where the end of a leg is, (frames, 3) [m]."""
        globals_ = self.clip.poses.globals(self.body.skeleton)
        if leg.toes is not None and leg.foot in self.body.line(leg.toes):
            return np.asarray(globals_[:, leg.toes, :3, 3])
        return ankle(globals_, self.body, leg)

    def _leaning(self, pose: Pose, course: Course) -> Pose:
        """Return poses that lean into a curve and look ahead in it."""
        new, old = (
            np.clip(
                _LEANS * np.arctan(c.speed * c.yaw_rate / (_GRAVITY * self.body.leg_length)),
                -_LEAN,
                _LEAN,
            )
            for c in (course, self.course)
        )
        glance = np.clip(_AHEAD * (course.yaw_rate - self.course.yaw_rate), -_GLANCE, _GLANCE)
        translations, turns = pose.translations.copy(), pose.rotations.copy()
        lean = rotations.about("z", old - new)
        below = _below_root(self.body)
        translations[:, below] = rotations.rotate(lean, translations[:, below])
        turns[:, below] = rotations.multiply(lean, turns[:, below])
        pose = replace(pose, translations=translations, rotations=turns)
        necks = [j for part in ("neck", "head") if (j := self.body.part(part)) is not None]
        for joint in necks:
            pose = _turned(pose, self.body, joint, rotations.about("y", glance / len(necks)))
        return pose


def held(gait: Gait) -> Gait:
    """Return a gait whose feet stand still on its own course."""
    times = np.arange(len(gait.clip)) / gait.clip.rate
    way = Way(np.zeros((len(times), 3)), gait.course.at(times[-1:])[0], gait.clip.rate)
    pose = _sealed(hold(gait.clip.poses, gait.body, gait.legs, gait.footing, way))
    return replace(gait, clip=replace(gait.clip, poses=pose))


def _sealed(pose: Pose) -> Pose:
    """Return a cycle whose last pose is its first, to the last bit, but for the root."""
    translations, turns = pose.translations.copy(), pose.rotations.copy()
    translations[-1, 1:] = translations[0, 1:]
    turns[-1, 1:] = rotations.align(turns[0, 1:], turns[-1, 1:])
    return replace(pose, translations=translations, rotations=turns)


def slide(gait: Gait) -> float:
    """Return the mean speed of standing balls of feet over the ground [m/s]."""
    speeds: list[Array] = []
    for number, leg in enumerate(gait.legs):
        at = gait._end(leg)[:, [0, 2]]
        down = gait.footing.ball[:, number]
        speed = np.linalg.norm(np.diff(at, axis=0), axis=-1) * gait.clip.rate
        speeds.append(speed[down[1:] & down[:-1]])
    every = np.concatenate(speeds)
    return float(every.mean()) if len(every) else 0.0


def _below_root(body: Body) -> Sequence[int]:
    return [joint for joint, parent in enumerate(body.skeleton.parents) if parent == 0]


def _on_root(pose: Pose, way: Array) -> Pose:
    """Return poses with the root on a way (frames, 3); all that it carries goes with it."""
    translations, turns = pose.translations.copy(), pose.rotations.copy()
    translations[:, 0] = np.stack([way[:, 0], np.zeros(len(way)), way[:, 1]], axis=-1)
    turns[:, 0] = rotations.about("y", way[:, 2])
    return replace(pose, translations=translations, rotations=rotations.continuous(turns))


def _foot_turned(pose: Pose, body: Body, leg: Leg, yaw: Array) -> Pose:
    """Return poses with a foot turned in the world by yaws (frames,) [rad]."""
    return _turned(pose, body, leg.foot, rotations.about("y", yaw))


def _turned(pose: Pose, body: Body, joint: int, turn: Array) -> Pose:
    """Return poses with a joint turned in the world by rotations (frames, 4)."""
    globals_ = turns_of(pose.globals(body.skeleton)[:, [body.skeleton.parents[joint], joint]])
    turns = pose.rotations.copy()
    above, own = globals_[:, 0], globals_[:, 1]
    turns[:, joint] = rotations.multiply(rotations.conjugate(above), rotations.multiply(turn, own))
    return replace(pose, rotations=rotations.continuous(turns))
