"""One gesture that plays, from its first frame to its last."""

import math
from dataclasses import dataclass, field

import numpy as np

from cubeling.characters.behaviour.expressivity import NEUTRAL
from cubeling.characters.behaviour.gestures.motion import GestureMotion
from cubeling.characters.behaviour.gestures.planning import GestureRealizer
from cubeling.characters.behaviour.gestures.timing import PhaseTimes, apex_share
from cubeling.characters.behaviour.intents import GestureIntent, Hand
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.skeleton.way_round import WayRound
from cubeling.characters.smoothing import smoothstep

RETIME_S = 0.25
"""How long a gesture takes to catch up with times that have changed, at most [s]."""

MIN_RETIME_S = 0.1
"""And at least [s]: an apex that is moved to a nearer time than that is late."""

COAST_S = 0.1
"""How long a gesture takes to stop that waits, because its times have moved away or because it is
given up, at most [s]."""

MIN_LEAVE_S = 0.45
"""Hands that give up a gesture take at least so long to go [s], and as long as they would have
taken from its end to rest; longer where they are far away."""

LEAVE_SPEED_RAD = 5.0
"""How fast a joint goes then at most: usual gestures are as fast [rad/s]."""

USUAL_AWAY_RAD, MOST_AWAY_RAD = 0.5, 1.8
"""How far a joint of an arm is from rest while nothing holds it [rad], and the angle up to which
more than that counts."""

AWAY_SLOWNESS = 0.15
"""How much longer a gesture prepares for each radian that the gesture whose place it takes has left
an arm farther away [1/rad]: the way from there is longer than that from rest."""

POSTURES_PER_FRAME = 1
"""Key postures that are planned ahead in each frame, until all are there."""

STEP_S = 1e-3
"""Time over which its speed is measured [s]."""


@dataclass(eq=False)
class GesturePlayback:
    """One gesture that plays, from its first frame to its last."""

    intent: GestureIntent
    """What is asked, last heard of."""

    hand: Hand
    """Which hand performs it, if it is one-handed."""

    realizer: GestureRealizer

    present: float
    """How far it has joined in, 0…1."""

    takes_over: bool = False
    """Whether it takes the place of one that is given up."""

    called_off: bool = False
    """Whether its new times leave no room for what is left of its strokes."""

    _ahead: float = 0.0
    _speed: float = 0.0
    _coast: float = 0.0
    _since: float = 0.0
    _waits_from: float = 0.0
    _settled: float = 0.0
    _left: bool = False
    _leave_s: float = MIN_LEAVE_S
    _motion: GestureMotion | None = None
    _shown: Array | None = None
    _way: WayRound = field(default_factory=WayRound)

    def __post_init__(self) -> None:
        gesture, style = self.intent.gesture, self.intent.expressivity
        style = gesture.expressivity if style == NEUTRAL else style
        self._planning = self.realizer.planning(gesture, self.hand, style)
        self._apex = apex_share(gesture)
        self._times = self._own = self._phase_times()

    def plays(self, intent: GestureIntent) -> bool:
        """Return whether an intent asks for it, at whatever times."""
        own = self.intent
        return intent is own or (
            intent.key == own.key
            and intent.hand == own.hand
            and (intent.gesture is own.gesture or intent.gesture == own.gesture)
            and intent.expressivity == own.expressivity
        )

    def retime(self, intent: GestureIntent, now: float) -> None:
        """Follow new times from where it is.

        It hurries to what is sooner than it was, and has caught up at the stroke; it waits for what
        is later, and does not go back. If its strokes are to be over already, it is called off:
        hurried through all of them at once, hands would be thrown.
        """
        if intent.times == self.intent.times and (self.called_off or not self._left):
            return
        before = self.moment(now)
        self._speed = (before - self.moment(now - STEP_S)) / STEP_S
        self.called_off = intent.times.stroke_end <= now and before < self._own.stroke_end - STEP_S
        if self.called_off:
            self.intent = intent
            return
        self.intent, self._left = intent, False
        self._times = self._phase_times()
        if self._motion is None:
            self._own = self._times  # it has not begun: nothing to catch up with
            return
        self._ahead = before - self._times.at(now, self._own)
        self._wait(before, now)
        stroke = intent.times.stroke
        left = stroke - now if stroke > now else RETIME_S
        self._settled = now + max(min(left, RETIME_S), MIN_RETIME_S)

    def give_up(self, now: float, elapsed: float) -> None:
        """Stop where it is, and let it go by the time of a frame [s]."""
        if not self._left:
            before = self.moment(now)
            self._speed = (before - self.moment(now - STEP_S)) / STEP_S
            self._wait(before, now)
            self._left, self._leave_s = True, max(self._own.end - self._own.relax, MIN_LEAVE_S)
        self.present -= elapsed / self._leave_s

    def moment(self, now: float) -> float:
        """Return the time, of those it was planned for, at which it is as far as now [s]."""
        if self._left:
            return self._time_of_wait(now)
        moment = self._times.at(now, self._own)
        if self._ahead < 0.0 and now < self._settled:
            rest = (self._settled - now) / (self._settled - self._since)
            return moment + self._ahead * rest
        if self._ahead > 0.0:
            moment = max(moment, self._time_of_wait(now))
        return moment

    def _wait(self, before: float, now: float) -> None:
        """Come to a stop from where it is, if there is no reason to go on."""
        # Half of what is left of its phase, so that it waits before the apex and not after it.
        limit = next((knot for knot in self._own.knots if knot > before), before)
        self._coast = min(max(self._speed, 0.0) * COAST_S, 0.5 * (limit - before))
        self._since, self._waits_from = now, before

    def _time_of_wait(self, now: float) -> float:
        """Return where it comes to a stop, smoothly, to wait for its new times."""
        start = self._waits_from
        if self._coast <= 0.0:
            return start
        return start - self._coast * math.expm1((self._since - now) * self._speed / self._coast)

    def _phase_times(self) -> PhaseTimes:
        return PhaseTimes(self.intent.times, self._apex, self.intent.gesture.retraction)

    def _prepare_longer(self, start: Array) -> None:
        """Let all but the start be later by how far the arms are from rest."""
        rest = self._planning.joints.rest[: len(start)]
        cosine = float(np.abs(np.vecdot(start, rest)).min())
        away = min(2.0 * math.acos(min(cosine, 1.0)), MOST_AWAY_RAD)
        preparation = self._times.ready - self._times.start
        later = AWAY_SLOWNESS * max(away - USUAL_AWAY_RAD, 0.0) * preparation
        self._times = self._times.later(later)

    def is_over(self, now: float) -> bool:
        """Return whether nothing of it is left at a time [s]."""
        return self.moment(now) >= self._own.end

    def is_under_way(self, now: float) -> bool:
        """Return whether something of it is to be seen at a time [s]."""
        return self._own.start < self.moment(now) < self._own.end

    def cover(self, step: float) -> None:
        """Let it go by a step of 0…1 as others cover it; one that has not begun does not begin."""
        self.present = 0.0 if self._motion is None else max(self.present - step, 0.0)

    def over(self, pose: Pose, now: float, share: float) -> Pose:
        """Return a pose with the gesture laid over it; `share` of it is shown, 0…1."""
        moment = self.moment(now)
        if self.present <= 0.0 or not self._own.start < moment < self._own.end:
            return pose
        if self._motion is None:  # it goes on from what the arms do now
            start = pose.rotations[self._planning.joints.arms]
            self._motion = self._planning.motion(self._own, start)
            if self.takes_over:
                self._prepare_longer(start)
        self._planning.advance(POSTURES_PER_FRAME)
        if self._left and self._shown is not None:
            below = pose.rotations.take(self._motion.moved, 0)
            # Half the angle to the pose below; the steepest part of a fade is 1.5 of the mean.
            half = math.acos(min(float(np.abs(np.vecdot(self._shown, below)).min()), 1.0))
            weight = max(share * smoothstep(self.present), 0.2)
            self._leave_s = max(self._leave_s, 3.0 * half / (weight * LEAVE_SPEED_RAD))
        pose = self._motion.over(pose, moment, share * smoothstep(self.present), self._way)
        self._shown = pose.rotations.take(self._motion.moved, 0)
        return pose
