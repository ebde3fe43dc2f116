"""One gesture that plays, from its first frame to its last."""

import math
from dataclasses import dataclass

from cubeling.characters.behaviour.expressivity import NEUTRAL
from cubeling.characters.behaviour.gestures.planning import GestureRealizer
from cubeling.characters.behaviour.gestures.style.easing import ease_time
from cubeling.characters.behaviour.gestures.timing import (
    GONE,
    PREPARED,
    STROKE_END,
    apex_share,
    phase_at,
)
from cubeling.characters.behaviour.intents import GestureIntent, Hand, StrokeTimes
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.smoothing import smoothstep

RETIME_S = 0.25
"""How long a gesture takes to catch up with times that have changed, at most [s]."""

MIN_RETIME_S = 0.1
"""And at least [s]: an apex that is moved to a nearer time than that is late."""

COAST_S = 0.1
"""How long a gesture takes to stop and wait whose times have moved away, at most [s]."""

POSTURES_PER_FRAME = 2
"""Key postures that are planned in each frame of a preparation."""

STEP_S = 1e-3
"""Time over which the speed of a phase is measured [s]."""


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

    _ahead: float = 0.0
    _speed: float = 0.0
    _coast: float = 0.0
    _since: float = 0.0
    _settled: float = 0.0

    def __post_init__(self) -> None:
        gesture, style = self.intent.gesture, self.intent.expressivity
        self._style = gesture.expressivity if style == NEUTRAL else style
        self._planning = self.realizer.planning(gesture, self.hand, self._style)
        self._apex = apex_share(gesture)
        self._touches = any(
            keys and keys[0].place.contact for keys in (gesture.right, gesture.left)
        )

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
        is later, and does not go back.
        """
        if intent.times == self.intent.times:
            return
        before = self.phase(now)
        self._speed = (before - self.phase(now - STEP_S)) / STEP_S
        self.intent = intent
        self._ahead = before - self._phase(intent.times, now)
        # Half of what is left of its phase, so that it waits before the apex and not after it.
        apex = PREPARED + self._apex
        limit = apex if PREPARED <= before < apex else math.floor(before) + 1.0
        self._coast = min(max(self._speed, 0.0) * COAST_S, 0.5 * (limit - before))
        stroke = intent.times.stroke
        left = stroke - now if stroke > now else RETIME_S
        self._since = now
        self._settled = now + max(min(left, RETIME_S), MIN_RETIME_S)

    def phase(self, now: float) -> float:
        """Return how far it is, as `phase_at`."""
        phase = self._phase(self.intent.times, now)
        if self._ahead < 0.0 and now < self._settled:
            rest = (self._settled - now) / (self._settled - self._since)
            return phase + self._ahead * rest
        if self._ahead > 0.0:
            phase = max(phase, self._waiting(now))
        return phase

    def _waiting(self, now: float) -> float:
        """Return where it comes to a stop, smoothly, to wait for its new times."""
        start = self._phase(self.intent.times, self._since) + self._ahead
        if self._coast <= 0.0:
            return start
        return start - self._coast * math.expm1((self._since - now) * self._speed / self._coast)

    def _phase(self, times: StrokeTimes, now: float) -> float:
        return phase_at(times, now, self._apex, self.intent.gesture.retraction)

    def is_over(self, now: float) -> bool:
        """Return whether nothing of it is left at a time [s]."""
        return self.phase(now) >= GONE

    def over(self, pose: Pose, now: float, share: float) -> Pose:
        """Return a pose with the gesture laid over it; `share` of it is shown, 0…1."""
        phase = self.phase(now)
        if not 0.0 < phase < GONE:
            return pose
        weight, prepares = 1.0, phase < PREPARED
        if prepares:
            self._planning.advance(POSTURES_PER_FRAME)
            weight = ease_time(smoothstep(phase), self._style)
            weight = min(weight, 1.0) if self._touches else weight
        elif phase > STROKE_END:
            weight = smoothstep(GONE - phase)
        weight *= share * smoothstep(self.present)
        motion = self._planning.opening if prepares else self._planning.motion
        return motion.over(pose, min(max(phase - PREPARED, 0.0), 1.0), weight)
