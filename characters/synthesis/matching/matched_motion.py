"""The motion that matching plays: legs and arms, each from the clip that suits them."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cubeling.characters.motion.inertialization import Inertialization, OffsetDecay
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.synthesis.matching.database import MotionDatabase, Playhead
from cubeling.characters.synthesis.matching.features import ROW_RATE_HZ

SEARCH_INTERVAL_S = 0.1
"""Time between searches without a reason [s]."""

TRANSITION_S, MAX_TRANSITION_S = 0.3, 0.6
"""Length of a transition by inertialization [s]; it is longer where hands or feet would be pulled
harder than the clips ever do."""

MAX_PULL_SHARE = 0.5
"""How hard the difference of two motions may pull hands and feet, as a share of the largest
acceleration in the clips: the motions have their own besides."""

VELOCITY_S = 1.0 / ROW_RATE_HZ
"""Time over which velocities at a jump are measured [s]: from one frame of a recording to the next,
limbs may turn by its noise alone, and a transition would play that on."""

_OFFSET_PEAK, _VELOCITY_PEAK = 5.77, 4.0  # largest second derivatives of `quintic_decay`

MIN_PLAY_S = 0.2
"""Time between jumps without a reason [s]."""

SAME_PLACE_S = 0.2
"""A jump within one clip must go farther than this [s]."""

STAYING = 0.85
"""A jump must cost less than this part of what playing on costs."""


@dataclass(frozen=True)
class _Play:
    """What a part of the body plays since its last jump."""

    database: MotionDatabase

    head: Playhead
    """Where it has jumped to."""

    time: float
    """When [s]."""

    transition: Inertialization | None = None
    """Decaying difference from what was played before; its rotations are in the character's frame.

    So what one joint does and the next makes up for stays unseen, though either is offset: hips
    whose markers shake under a trunk, or a straight limb that turns about itself.
    """

    drift: OffsetDecay | None = None
    """Decaying difference of the velocity over the ground (x, z, yaw)."""

    def head_at(self, time: float) -> Playhead:
        """Return the moment that plays at a time [s]."""
        return Playhead(self.head.clip, self.head.time + time - self.time)

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s], with rotations in the character's frame."""
        head = self.head_at(time)
        pose = self.database.clips[head.clip].sample(head.time)
        turned = pose.turned_in_character(self.database.skeleton)
        return self.transition.apply(turned, time - self.time) if self.transition else turned

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        first, last = self.head_at(start), self.head_at(end)
        step = self.database.clips[first.clip].travel(first.time, last.time)
        if self.drift is None or start - self.time >= self.drift.length:
            return step
        x, z, yaw = self.drift.integral(start - self.time, end - self.time).tolist()
        return RootDelta(step.x + x, step.z + z, step.yaw + yaw)

    def velocity(self, time: float) -> Array:
        """Return the velocity over the ground after a time [s], (3,): x, z [m/s], yaw [rad/s]."""
        step = self.travel(time, time + VELOCITY_S)
        return np.array([step.x, step.z, step.yaw]) / VELOCITY_S

    def jump(self, head: Playhead, time: float, ends: Sequence[int]) -> "_Play":
        """Return what plays after a jump that does not pull the ends of the limbs."""
        new = _Play(self.database, head, time)
        old_poses, new_poses = (
            (play.sample(time), play.sample(time + VELOCITY_S)) for play in (self, new)
        )
        skeleton = self.database.skeleton
        length = _transition_length(self.database, [*old_poses, *new_poses], ends)
        transition = Inertialization.begin(
            old_poses, new_poses, VELOCITY_S, length, skeleton.parents
        )
        drift = OffsetDecay(self.velocity(time) - new.velocity(time), np.zeros(3), length)
        return replace(new, transition=transition, drift=drift)


def _transition_length(
    database: MotionDatabase, poses: Sequence[Pose], ends: Sequence[int]
) -> float:
    """Return how long it takes to pass over to a motion without a pull at the ends of limbs [s].

    `poses` are two of the old motion and two of the new one, each `VELOCITY_S` apart.
    """
    if not ends:
        return TRANSITION_S
    turned = Pose.of_frames(poses).turned_in_parents(database.skeleton)
    at = turned.globals(database.skeleton)[..., :3, 3][:, list(ends)]
    now, later = at[:2] - at[2:]
    away = float(np.linalg.norm(now, axis=-1).max())
    speed = float(np.linalg.norm(later - now, axis=-1).max()) / VELOCITY_S
    most = MAX_PULL_SHARE * database.acceleration
    needed = max(math.sqrt(_OFFSET_PEAK * away / most), _VELOCITY_PEAK * speed / most)
    return min(max(needed, TRANSITION_S), MAX_TRANSITION_S)


class _BodyPartPlayback:
    """What a part of the body plays."""

    def __init__(self, database: MotionDatabase, head: Playhead, ends: tuple[int, ...]) -> None:
        self._database = database
        self._ends = ends  # of its limbs
        self._searched = 0.0
        self.play = _Play(database, head, 0.0)
        """What plays now."""

    def may_search(self, time: float) -> bool:
        """Whether a search without a reason is due."""
        rested = time - self.play.time >= MIN_PLAY_S
        return rested and time - self._searched >= SEARCH_INTERVAL_S - 1e-9

    def jump(self, found: Playhead | None, time: float) -> bool:
        """Go on from a moment that a search found; return whether that is elsewhere."""
        self._searched = time
        if found is None or self._near(self.play.head_at(time), found):
            return False
        self.play = self.play.jump(found, time, self._ends)
        return True

    def _near(self, now: Playhead, found: Playhead) -> bool:
        clip = self._database.clips[now.clip]
        if found.clip != now.clip or self._database.ends_within(now, SAME_PLACE_S):
            return False
        apart = found.time - now.time
        if clip.loop:
            apart = math.remainder(apart, clip.duration)
        return abs(apart) < SAME_PLACE_S


class MatchedMotion:
    """Plays the frames of a database that suit a wish; a `Motion` that is advanced with `match`.

    Legs and hips are matched to the path ahead; trunk, head and arms to the steps of the legs.
    """

    def __init__(self, database: MotionDatabase, start: Playhead) -> None:
        self.database = database
        self.jumps = 0
        """How often legs and arms have jumped so far."""
        self.restart(start)

    @property
    def duration(self) -> float:
        """Infinite: it goes on for as long as it is sampled."""
        return math.inf

    def restart(self, start: Playhead) -> None:
        """Begin at a moment of the database; its time is 0 again."""
        self._legs = _BodyPartPlayback(self.database, start, self.database.joints.feet)
        self._arms = _BodyPartPlayback(self.database, start, self.database.joints.hands)

    def match(self, time: float, ahead: Callable[[], Mapping[str, Array]], sudden: bool) -> None:
        """Jump, at a time [s], where frames suit better than those that come next.

        Parameters
        ----------
        time
            Not before the last one.
        ahead
            Returns the wished features "path" and "facing"; called if a search is due.
        sudden
            Whether the wish has just changed, so that legs are searched for at once.
        """
        database, now = self.database, self._legs.play.head_at(time)
        ends = database.ends_within(now, SEARCH_INTERVAL_S / 2)
        if sudden or ends or self._legs.may_search(time):
            found = database.match_legs(now, ahead(), math.inf if ends else STAYING)
            jumped = self._legs.jump(found, time)
            self.jumps += jumped
            sudden |= jumped
        arms = self._arms.play.head_at(time)
        ends = database.ends_within(arms, SEARCH_INTERVAL_S / 2)
        if sudden or ends or self._arms.may_search(time):
            legs = self._legs.play.head_at(time)
            found = database.match_arms(arms, legs, math.inf if ends else STAYING)
            self.jumps += self._arms.jump(found, time)

    def legs(self, time: float) -> Playhead:
        """Return what the legs play at a time [s]."""
        return self._legs.play.head_at(time)

    def arms(self, time: float) -> Playhead:
        """Return what trunk, head and arms play at a time [s]."""
        return self._arms.play.head_at(time)

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        pose = self._legs.play.sample(time)
        skeleton = self.database.skeleton
        if self.database.arms is None:
            return pose.turned_in_parents(skeleton)
        above, upper = self._arms.play.sample(time), self.database.upper
        translations, turns = pose.translations.copy(), pose.rotations.copy()
        translations[upper], turns[upper] = above.translations[upper], above.rotations[upper]
        whole = Pose(translations, turns, pose.scales, pose.morphs)
        return whole.turned_in_parents(skeleton)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self._legs.play.travel(start, end)
