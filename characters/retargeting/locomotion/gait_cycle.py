"""One cycle of a gait on an arc over the ground, which can be bent to any other arc.

A point has the coordinates length along the arc, height and distance to the left of it. Bending the
arc bends the footprints with it: standing feet keep standing, and outer feet take longer steps.
"""

from dataclasses import dataclass, replace

import numpy as np

from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.retargeting.feet.footskate import (
    FootContacts,
    ball_positions,
    hold_feet_in_contact,
)
from cubeling.characters.retargeting.feet.ground_motion import GroundMotion, arc, transform
from cubeling.characters.retargeting.rig import LegJoints, Rig, global_rotations
from cubeling.characters.retargeting.root import move_to_trajectory
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose

_GRAVITY = 9.81 / 0.92  # [leg lengths/s²], for legs of 0.92 m
_LEAN_SHARE, _MAX_LEAN = 0.6, 0.22  # of the angle that balances a curve; [rad]
_LOOK_AHEAD_S, _MAX_LOOK_YAW = 0.25, 0.4  # of the head in a curve; [rad]
_MIN_CURVATURE = 1e-6  # [1/m]; less is straight


@dataclass(frozen=True)
class ArcPath:
    """An arc from the origin along +z at constant speed."""

    speed: float
    """Along the arc [m/s]."""

    yaw_rate: float
    """About +y, to the left [rad/s]."""

    @staticmethod
    def of(delta: RootDelta, duration: float) -> "ArcPath":
        """Return the path of a root delta in a time [s], if it starts along the arc.

        >>> path = ArcPath.of(RootDelta(2.0, 2.0, np.pi / 2), 1.0)
        >>> round(path.speed, 6), round(path.yaw_rate, 6)
        (3.141593, 1.570796)
        """
        stretch = 1.0 / float(np.sinc(delta.yaw / 2 / np.pi))
        return ArcPath(delta.length * stretch / duration, delta.yaw / duration)

    @property
    def curvature(self) -> float:
        """Inverse of the radius, positive to the left [1/m]."""
        return self.yaw_rate / max(self.speed, 1e-9)

    def at(self, times: Array) -> Array:
        """Return x, z [m] and yaw [rad] at times [s], (n, 3)."""
        return arc(np.array([0.0, self.speed]), self.yaw_rate, times)

    def to_arc(self, points: Array, times: Array) -> Array:
        """Return points (n, 3) in coordinates along the arc, (n, 3) [m].

        Of the possible lengths along the arc, the ones nearest to the path at `times` are taken.
        """
        curvature = self.curvature
        if abs(curvature) < _MIN_CURVATURE:
            return points[:, [2, 1, 0]]
        side = np.sign(curvature)
        across, ahead = points[:, 0] - 1 / curvature, points[:, 2]
        angle = np.arctan2(side * ahead, -side * across)
        expected = self.yaw_rate * times
        angle = expected + np.remainder(angle - expected + np.pi, 2 * np.pi) - np.pi
        left = 1 / curvature - side * np.hypot(across, ahead)
        return np.stack([angle / curvature, points[:, 1], left], axis=-1)

    def from_arc(self, coordinates: Array) -> Array:
        """Return the points (n, 3) of coordinates along the arc."""
        path = arc(np.array([0.0, 1.0]), self.curvature, coordinates[:, 0])
        left, height = coordinates[:, 2], coordinates[:, 1]
        return transform(path, np.stack([left, height, np.zeros(len(coordinates))], axis=-1))


@dataclass(frozen=True)
class GaitCycle:
    """A loop of walking or running."""

    origin: str
    """The recording that it is made from."""

    clip: Clip
    """One cycle from a left landing on, its root on the path from the origin."""

    rig: Rig
    """The skeleton of the clip."""

    contacts: FootContacts
    """When its feet stand."""

    path: ArcPath
    """Its path over the ground."""

    seam: float
    """Distance of the joints where the loop was closed, root mean square [m]."""

    source_knees: Array | None = None
    """How far the knees of a person's recording are bent, (legs, 5); see `knee_quantiles`.

    None for an animal, and on another curve, where knees bend otherwise."""

    @property
    def legs(self) -> tuple[LegJoints, ...]:
        """The legs with contacts."""
        return self.rig.legs[: self.contacts.ball.shape[1]]

    @property
    def mean_slide(self) -> float:
        """Mean speed of standing balls of feet over the ground [m/s]."""
        speeds: list[Array] = []
        for number, leg in enumerate(self.legs):
            at = ball_positions(self.clip.poses, self.rig, leg)[:, [0, 2]]
            down = self.contacts.ball[:, number]
            speed = np.linalg.norm(np.diff(at, axis=0), axis=-1) * self.clip.rate
            speeds.append(speed[down[1:] & down[:-1]])
        every = np.concatenate(speeds)
        return float(every.mean()) if len(every) else 0.0

    def bend_to(self, path: ArcPath) -> "GaitCycle":
        """Return the gait on another path, its footprints bent with it."""
        times = np.arange(len(self.clip)) / self.clip.rate
        share = path.speed / self.path.speed
        curvature_change = path.curvature * share - self.path.curvature
        pose = move_to_trajectory(self.clip.poses, path.at(times))
        pose = self._with_lean(pose, path)
        ends = np.empty((len(times), len(self.legs), 3))
        for number, leg in enumerate(self.legs):
            balls = ball_positions(self.clip.poses, self.rig, leg)
            coordinates = self.path.to_arc(balls, times)
            yaw = curvature_change * (coordinates[:, 0] - self.path.speed * times)
            pose = _turn(pose, self.rig, leg.foot, rotations.about("y", yaw))
            coordinates[:, 0] *= share
            ends[:, number] = path.from_arc(coordinates)
        knees = self.source_knees if abs(curvature_change) < _MIN_CURVATURE else None
        clip = replace(self.clip, poses=pose)
        return replace(self, path=path, clip=clip, source_knees=knees).with_held_feet(ends)

    def with_held_feet(self, ends: Array | None = None) -> "GaitCycle":
        """Return the gait with feet that do not slide; see `hold_feet_in_contact`."""
        times = np.arange(len(self.clip)) / self.clip.rate
        cycle = self.path.at(times[-1:])[0]
        ground = GroundMotion(np.zeros((len(times), 3)), cycle, self.clip.rate)
        pose = self.clip.poses
        held = hold_feet_in_contact(pose, self.rig, self.legs, self.contacts, ground, ends)
        return replace(self, clip=replace(self.clip, poses=_with_exact_end(held)))

    def _with_lean(self, pose: Pose, path: ArcPath) -> Pose:
        """Return poses that lean into a curve and look ahead in it."""
        weight = _GRAVITY * self.rig.leg_length
        balance = np.array([np.arctan(p.speed * p.yaw_rate / weight) for p in (path, self.path)])
        new, old = np.clip(_LEAN_SHARE * balance, -_MAX_LEAN, _MAX_LEAN)
        look_yaw = _LOOK_AHEAD_S * (path.yaw_rate - self.path.yaw_rate)
        look_yaw = np.clip(look_yaw, -_MAX_LOOK_YAW, _MAX_LOOK_YAW)
        translations, turns = pose.translations.copy(), pose.rotations.copy()
        lean = rotations.about("z", old - new)
        children = [j for j, parent in enumerate(self.rig.skeleton.parents) if parent == 0]
        translations[:, children] = rotations.rotate(lean, translations[:, children])
        turns[:, children] = rotations.multiply(lean, turns[:, children])
        pose = replace(pose, translations=translations, rotations=turns)
        necks = [j for part in ("neck", "head") if (j := self.rig.anatomy.joint(part)) is not None]
        for joint in necks:
            turn = rotations.about("y", look_yaw / len(necks))
            pose = _turn(pose, self.rig, joint, turn)
        return pose


def _with_exact_end(pose: Pose) -> Pose:
    """Return a cycle whose last pose equals its first exactly, except for the root."""
    translations, turns = pose.translations.copy(), pose.rotations.copy()
    translations[-1, 1:] = translations[0, 1:]
    turns[-1, 1:] = rotations.align(turns[0, 1:], turns[-1, 1:])
    return replace(pose, translations=translations, rotations=turns)


def _turn(pose: Pose, rig: Rig, joint: int, turn: Array) -> Pose:
    """Return poses with a joint turned in the world by rotations (frames, 4)."""
    pair = [rig.skeleton.parents[joint], joint]
    placements = global_rotations(pose.globals(rig.skeleton)[:, pair])
    turns = pose.rotations.copy()
    above, own = placements[:, 0], placements[:, 1]
    turns[:, joint] = rotations.multiply(rotations.conjugate(above), rotations.multiply(turn, own))
    return replace(pose, rotations=rotations.continuous(turns))
