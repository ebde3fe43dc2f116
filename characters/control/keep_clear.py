"""A character that keeps out of obstacles, and in sight between them.

The controller walks in coordinates of its own: whatever moves the character besides its walk is an
offset between those and the table. So any controller keeps clear, and none of them knows of it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cubeling.characters.body.outline import Outline
from cubeling.characters.control.command import CharacterCommand, LocomotionIntent
from cubeling.characters.control.controllers.controller import ControllerFrame
from cubeling.characters.locomotion.obstacles import STANDING, Obstacle
from cubeling.characters.locomotion.places import (
    WayOut,
    better_place,
    detour,
    hidden_share,
    is_good,
    way_out,
)
from cubeling.characters.locomotion.steering import ARRIVAL_DISTANCE_M
from cubeling.characters.model.character import Character
from cubeling.characters.motion.curves import ease
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.smoothing import low_pass

ROOM_M, ROOM_S = 0.004, 0.04
"""Room that is kept to an obstacle at rest [m], and what is added for its speed [s]."""

AHEAD_S = (0.0, 0.1, 0.2, 0.3, 0.45, 0.6)
"""Times at which it looks where obstacles will be [s]."""

STEP_M_S, STEP_LAG_S, STILL_M_S = 0.14, 0.08, 0.002
"""Speed up to which it steps aside [m/s], the lag with which it comes to a speed [s], and the speed
below which it stands [m/s]."""

HURRY_M_S, SHORT_M = 0.3, 0.025
"""Speed of quick steps, and of how short a way they are [m/s, m]."""

LEAP_M_S, SHORTEST_LEAP_S, LEAP_BEFORE_S = 0.8, 0.14, 0.1
"""Greatest speed of a leap [m/s], how long it takes at least, and how long before it must be over
it begins at the latest, besides [s]."""

LEAP_ROOM_M, LEAP_HEIGHT_M, LEAP_HEIGHT = 0.01, 0.006, 0.2
"""How much further it leaps than it must [m]; height of a leap of no length [m], and what each
metre adds."""

HIDDEN, HIDDEN_S = 0.35, 0.2
"""Share of its outline that may be hidden, and how long more may be [s]."""

SLOWING_S, ARRIVED_M = 0.25, 0.003
"""It slows down this long before a place where it is seen [s], and is there at this distance."""

CALM_M_S = 0.05
"""It looks for such a place while no obstacle is faster than this [m/s]."""

GOAL_M, GOAL_S = 0.04, 0.2
"""A goal that moves further than this is another one [m]; how often a better one is looked for
[s]."""

SLACK_M = 0.04
"""What further away an obstacle may be than the body is wide, to be looked at closely [m]."""

NEAR_M = 0.45
"""Obstacles further away than this do not matter yet [m]."""


@dataclass(frozen=True)
class _Leap:
    """A quick leap aside."""

    start: Array  # offset, (2,) [m]
    way: Array  # (2,) [m]
    seconds: float
    time: float = 0.0

    @property
    def share(self) -> float:
        """How much of its time is over, 0…1."""
        return min(self.time / self.seconds, 1.0)

    @property
    def offset(self) -> Array:
        """The offset now, (2,) [m]."""
        return self.start + ease(self.share, "cubic") * self.way

    @property
    def height(self) -> float:
        """Height above the table [m]."""
        top = LEAP_HEIGHT_M + LEAP_HEIGHT * float(np.linalg.norm(self.way))
        return 4.0 * self.share * (1.0 - self.share) * top


class KeepClear:
    """Displaces one character; advanced once a frame."""

    def __init__(self, character: Character) -> None:
        self._character = character
        self._outline: Outline | None = None
        self._drawn: tuple[Pose, Array] | None = None  # pose and table_from_character
        self._points: Array | None = None  # of the outline, then, (n, 3)
        self._walked: RootDelta | None = None  # where the controller was
        self._offset, self._velocity = np.zeros(2), np.zeros(2)
        self._leap: _Leap | None = None
        self._side: Array | None = None  # direction of the way that it is on, (2,)
        self._hidden_s = 0.0
        self._seek: Array | None = None  # the offset at which it is seen, (2,)
        self._goal: tuple[Array, Array] | None = None  # asked for, and how far from it a better is
        self._goal_at = -math.inf  # when that was looked for

    def direct(self, command: CharacterCommand, walks: bool) -> CharacterCommand:
        """Return a command in the controller's coordinates, with a goal that is clear and seen."""
        going = command.locomotion
        if going is None:
            return command
        points = self._outline_of(command)
        target = going.target
        free = target is not None and not going.exact
        if points is not None and free and command.activity == "move":
            target = self._better_goal(command, going, points, walks)
            for each in command.obstacles:
                target = detour(self._here, target, each, self._body_height)
        if target is going.target and not self._is_displaced:
            return command
        target, facing = (
            None if point is None else np.asarray(point, float) - self._offset
            for point in (target, going.facing)
        )
        return replace(command, locomotion=replace(going, target=target, facing=facing))

    def keep(
        self, frame: ControllerFrame, command: CharacterCommand, elapsed: float
    ) -> ControllerFrame:
        """Return what a controller plays, where the character is clear of the obstacles."""
        now, before = frame.place, self._walked or frame.place
        self._walked = now
        points = self._outline_of(command)
        if points is not None:
            step = np.array([now.x - before.x, now.z - before.z])
            self._advance(points + np.insert(step, 1, 0.0), step, frame, command, elapsed)
        else:  # nothing is near any more, perhaps in the midst of a leap
            self._velocity, self._seek, self._hidden_s = np.zeros(2), None, 0.0
            self._fly(elapsed)
        if not self._is_displaced:
            return frame
        x, z = self._offset.tolist()
        place = RootDelta(now.x + x, now.z + z, now.yaw)
        if self._leap is None:
            return replace(frame, place=place)
        feet = None if frame.feet_down is None else [False] * len(frame.feet_down)
        height = frame.height + self._leap.height
        return replace(frame, place=place, height=height, feet_down=feet, standing=False)

    def learn(self, pose: Pose, table_from_character: Array) -> None:
        """Take what is drawn: the next frame keeps that out of the obstacles."""
        self._drawn, self._points = (pose, table_from_character), None

    def obstacle(self, velocity: Array) -> Obstacle | None:
        """Return the body as it was drawn last, for others; None if nothing has been drawn.

        It is a box that stands upright and is turned as the character is, and moves with a
        `velocity`, (3,) [m/s]. A body that leaps takes all the place from where it is to where it
        will land, and does not leave that.
        """
        points = self._outline_points()
        if points is None or not len(points):
            return None
        assert self._drawn is not None
        pose = self._drawn[1].copy()
        pose[:3, :3] /= float(pose[1, 1])
        within = points @ pose[:3, :3]
        low, high = within.min(axis=0), within.max(axis=0)
        if self._leap is not None:
            left = self._leap.start + self._leap.way - self._offset
            along = np.insert(left, 1, 0.0) @ pose[:3, :3]
            low, high = low + np.minimum(along, 0.0), high + np.maximum(along, 0.0)
            velocity = np.zeros(3)
        pose[:3, 3] = pose[:3, :3] @ (low + high) / 2
        return Obstacle(pose, np.asarray(high - low), velocity, alive=True)

    @property
    def _is_displaced(self) -> bool:
        return self._offset.tolist() != [0.0, 0.0]

    @property
    def _here(self) -> Array:
        assert self._drawn is not None
        here: Array = self._drawn[1][[0, 2], 3]
        return here

    @property
    def _body_height(self) -> float:
        assert self._drawn is not None
        return self._character.height * float(self._drawn[1][1, 1])

    def _outline_of(self, command: CharacterCommand) -> Array | None:
        """Return the outline as it was drawn last, without arms that reach, (n, 3) [m].

        None if nothing has been drawn, or no obstacle is near.
        """
        if self._drawn is None or not any(self._is_near(each) for each in command.obstacles):
            return None
        points = self._outline_points()
        assert points is not None
        assert self._outline is not None
        reaches = command.behaviour is not None and bool(command.behaviour.reaches)
        without_arms = reaches or _is_exact(command)
        return points[~self._outline.is_arm] if without_arms else points

    def _outline_points(self) -> Array | None:
        """Return the whole outline as it was drawn last, (n, 3) [m]; None before that."""
        if self._drawn is None:
            return None
        if self._outline is None:
            self._outline = Outline(self._character)
        if self._points is None:
            pose, placed = self._drawn
            self._points = self._outline.points(placed @ pose.globals(self._character.skeleton))
        return self._points

    def _is_near(self, obstacle: Obstacle) -> bool:
        return obstacle.distance(self._here) < NEAR_M

    def _better_goal(
        self, command: CharacterCommand, going: LocomotionIntent, points: Array, walks: bool
    ) -> Array:
        """Return a target (x, z) [m] from which the character stops where it is clear and seen."""
        target = np.asarray(going.target, float)
        if not going.stop:
            return target
        back = self._here - target
        far = float(np.linalg.norm(back))
        stops = min(ARRIVAL_DISTANCE_M, far) if walks else 0.0
        stand = target + back * (stops / max(far, 1e-9))
        if self._goal is None or float(np.linalg.norm(stand - self._goal[0])) > GOAL_M:
            self._goal, self._goal_at = (stand, np.zeros(2)), -math.inf
        asked, shift = self._goal
        there, now = points + np.insert(asked - self._here, 1, 0.0), command.timestamp
        late = now - self._goal_at >= GOAL_S
        moved = there + np.insert(shift, 1, 0.0)
        if late and not is_good(moved, command.obstacles, command.view):
            better = better_place(there, command.obstacles, command.view, shift)
            shift = np.zeros(2) if better is None else better
            self._goal, self._goal_at = (asked, shift), now
        if not shift.any():
            return target
        on = asked + shift - self._here
        length = float(np.linalg.norm(on))
        return asked + shift + on * ((ARRIVAL_DISTANCE_M if walks else 0.0) / max(length, 1e-9))

    def _advance(
        self,
        points: Array,
        step: Array,
        frame: ControllerFrame,
        command: CharacterCommand,
        elapsed: float,
    ) -> None:
        """Move the offset for one frame, in which the controller itself walks a step (2,) [m]."""
        obstacles = [each for each in command.obstacles if self._is_near(each)]
        out = self._way_out(points, obstacles, step / max(elapsed, 1e-3), command)
        if not command.visible:  # nobody sees how it gets there
            self._leap, self._velocity = None, np.zeros(2)
            if out is not None:
                self._offset = self._offset + out.distance * out.direction
            return
        if self._leap is None and out is not None and _must_leap(out):
            way = (out.distance + LEAP_ROOM_M) * out.direction
            self._leap = _Leap(self._offset, way, max(out.within, _leap_time(out)))
        if self._leap is not None:
            self._fly(elapsed)
            return
        if out is not None:
            self._side, self._seek = out.direction, None
            most = STEP_M_S if out.distance > SHORT_M else HURRY_M_S
            wanted = min(out.distance / max(out.within, 1e-3), most) * out.direction
        else:
            self._side = None
            wanted = self._way_to_be_seen(points, obstacles, frame, command, elapsed)
        for axis in range(2):
            now, then = float(self._velocity[axis]), float(wanted[axis])
            self._velocity[axis] = low_pass(now, then, elapsed, STEP_LAG_S)
        if float(np.linalg.norm(self._velocity)) < STILL_M_S:
            self._velocity = np.zeros(2)
        self._offset = self._offset + elapsed * self._velocity

    def _way_out(
        self,
        points: Array,
        obstacles: Sequence[Obstacle],
        walking: Array,
        command: CharacterCommand,
    ) -> WayOut | None:
        """Return the way out of what comes, for a body that walks, (2,) [m/s]."""
        if _is_exact(command):  # it knows how near it wants to be
            walking = STANDING
            obstacles = [each for each in obstacles if each.moves or each.holds(points)]
        # Most of the time all are too far away to come near: that is cheap to tell.
        wide = float(np.sqrt(((points[:, [0, 2]] - self._here) ** 2).sum(axis=1).max())) + SLACK_M
        wide += AHEAD_S[-1] * float(np.linalg.norm(walking))
        comes_near = [
            each.distance(self._here) < wide + 0.7 * float(np.linalg.norm(each.velocity))
            for each in obstacles
        ]
        if not any(comes_near):
            return None
        # A leap may lead to another character that is further away.
        pairs = zip(obstacles, comes_near, strict=True)
        obstacles = [each for each, near in pairs if near or each.alive]
        rooms = [ROOM_M + ROOM_S * float(np.linalg.norm(each.velocity)) for each in obstacles]
        return way_out(points, obstacles, AHEAD_S, rooms, command.view, self._side, walking)

    def _fly(self, elapsed: float) -> None:
        """Advance the leap, if it is on one."""
        if self._leap is None:
            return
        self._leap = replace(self._leap, time=self._leap.time + elapsed)
        self._offset, self._velocity = self._leap.offset, np.zeros(2)
        if self._leap.share >= 1.0:
            self._leap = None

    def _way_to_be_seen(
        self,
        points: Array,
        obstacles: Sequence[Obstacle],
        frame: ControllerFrame,
        command: CharacterCommand,
        elapsed: float,
    ) -> Array:
        """Return the velocity to a place where it is seen, (2,) [m/s]; 0 where it may stay."""
        view = command.view
        if view is None or _is_exact(command) or frame.acting or frame.speed > 0.0:
            self._hidden_s, self._seek = 0.0, None
            return np.zeros(2)
        hidden = hidden_share(points, obstacles, view) > HIDDEN
        self._hidden_s = self._hidden_s + elapsed if hidden else 0.0
        calm = all(float(np.linalg.norm(each.velocity)) < CALM_M_S for each in obstacles)
        if self._seek is None and calm and self._hidden_s > HIDDEN_S:
            way = better_place(points, obstacles, view, straight=True)
            self._seek = None if way is None else self._offset + way
            self._hidden_s = 0.0
        if self._seek is None:
            return np.zeros(2)
        left = self._seek - self._offset
        far = float(np.linalg.norm(left))
        if far < ARRIVED_M:
            self._seek = None
        return left * (min(STEP_M_S, far / SLOWING_S) / max(far, 1e-9))


def _is_exact(command: CharacterCommand) -> bool:
    """Return whether the character is to be where it is asked to be, to reach something."""
    return command.locomotion is not None and command.locomotion.exact


def _leap_time(out: WayOut) -> float:
    """Return how long a leap out of the way takes at least [s]."""
    return max(1.5 * (out.distance + LEAP_ROOM_M) / LEAP_M_S, SHORTEST_LEAP_S)


def _must_leap(out: WayOut) -> bool:
    """Return whether steps are too slow for a way out, and there is no time to wait."""
    too_slow = out.distance > max(STEP_M_S * out.within, SHORT_M)
    return too_slow and out.within <= _leap_time(out) + LEAP_BEFORE_S
