"""The motion that matching plays: legs and arms, each from the clip that suits them."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from cubeling.characters.motion.motion import Motion, RootDelta
from cubeling.characters.motion.state_machine import StateMachine
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.synthesis.matching.database import MotionDatabase, Playhead

SEARCH_INTERVAL_S = 0.1
"""Time between searches without a reason [s]."""

TRANSITION_S, MAX_TRANSITION_S = 0.3, 0.6
"""Length of a transition by inertialization [s]; it is longer where hands or feet would be pulled
harder than the clips ever do."""

MAX_PULL_SHARE = 0.5
"""How hard the difference of two motions may pull hands and feet, as a share of the largest
acceleration in the clips: the motions have their own besides."""

_OFFSET_PEAK, _VELOCITY_PEAK = 5.77, 4.0  # largest second derivatives of `quintic_decay`

MIN_PLAY_S = 0.2
"""Time between jumps without a reason [s]."""

SAME_PLACE_S = 0.2
"""A jump within one clip must go farther than this [s]."""

STAYING = 0.85
"""A jump must cost less than this part of what playing on costs."""


@dataclass(frozen=True)
class _From:
    """A motion from a time on; a `Motion`."""

    motion: Motion
    start: float

    @property
    def duration(self) -> float:
        return math.inf

    def sample(self, time: float) -> Pose:
        return self.motion.sample(self.start + time)

    def travel(self, start: float, end: float) -> RootDelta:
        return self.motion.travel(self.start + start, self.start + end)


class _BodyPartPlayback:
    """What a part of the body plays."""

    def __init__(self, database: MotionDatabase, head: Playhead, ends: tuple[int, ...]) -> None:
        self._database = database
        self._head = head
        self._ends = list(ends)  # of its limbs
        self._searched = 0.0
        self.machine = StateMachine({"": self._motion(head)}, "", TRANSITION_S)

    def head(self, time: float) -> Playhead:
        """Return the moment that plays at a time [s]."""
        return Playhead(self._head.clip, self._head.time + time - self.machine.entered)

    def may_search(self, time: float) -> bool:
        """Whether a search without a reason is due."""
        rested = time - self.machine.entered >= MIN_PLAY_S
        return rested and time - self._searched >= SEARCH_INTERVAL_S - 1e-9

    def jump(self, found: Playhead | None, time: float) -> bool:
        """Go on from a moment that a search found; return whether that is elsewhere."""
        self._searched = time
        now = self.head(time)
        if found is None or self._near(now, found):
            return False
        self._head = found
        motion = self._motion(found)
        self.machine.play(motion, time, self._transition_length(motion, time))
        return True

    def _transition_length(self, motion: Motion, time: float) -> float:
        """Return how long it takes to pass over to a motion without a pull [s]."""
        if not self._ends:
            return TRANSITION_S
        step = 1.0 / 60.0
        poses = [self.machine.sample(time + t) for t in (0.0, step)]
        poses += [motion.sample(t) for t in (0.0, step)]
        at = Pose.of_frames(poses).globals(self._database.skeleton)[..., :3, 3][:, self._ends]
        apart = at[:2] - at[2:]
        away = float(np.linalg.norm(apart[0], axis=-1).max())
        speed = float(np.linalg.norm(apart[1] - apart[0], axis=-1).max()) / step
        most = MAX_PULL_SHARE * self._database.acceleration
        needed = max(math.sqrt(_OFFSET_PEAK * away / most), _VELOCITY_PEAK * speed / most)
        return min(max(needed, TRANSITION_S), MAX_TRANSITION_S)

    def _near(self, now: Playhead, found: Playhead) -> bool:
        clip = self._database.clips[now.clip]
        if found.clip != now.clip or self._database.ends_within(now, SAME_PLACE_S):
            return False
        apart = found.time - now.time
        if clip.loop:
            apart = math.remainder(apart, clip.duration)
        return abs(apart) < SAME_PLACE_S

    def _motion(self, head: Playhead) -> Motion:
        return _From(self._database.clips[head.clip], head.time)


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
        database, now = self.database, self._legs.head(time)
        ends = database.ends_within(now, SEARCH_INTERVAL_S / 2)
        if sudden or ends or self._legs.may_search(time):
            found = database.match_legs(now, ahead(), math.inf if ends else STAYING)
            jumped = self._legs.jump(found, time)
            self.jumps += jumped
            sudden |= jumped
        arms = self._arms.head(time)
        ends = database.ends_within(arms, SEARCH_INTERVAL_S / 2)
        if sudden or ends or self._arms.may_search(time):
            legs = self._legs.head(time)
            found = database.match_arms(arms, legs, math.inf if ends else STAYING)
            self.jumps += self._arms.jump(found, time)

    def legs(self, time: float) -> Playhead:
        """Return what the legs play at a time [s]."""
        return self._legs.head(time)

    def arms(self, time: float) -> Playhead:
        """Return what trunk, head and arms play at a time [s]."""
        return self._arms.head(time)

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        pose = self._legs.machine.sample(time)
        if self.database.arms is None:
            return pose
        above, upper = self._arms.machine.sample(time), self.database.upper
        translations, turns = pose.translations.copy(), pose.rotations.copy()
        translations[upper], turns[upper] = above.translations[upper], above.rotations[upper]
        return Pose(translations, turns, pose.scales, pose.morphs)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self._legs.machine.travel(start, end)
