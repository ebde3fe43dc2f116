"""The body of who speaks: gestures that beat the rhythm, nods, and arms that join in.

What the stance, the eyes and the face do with a speech is planned here too, and found by their
layers in the context.
"""

from dataclasses import replace

import numpy as np

from cubeling.characters.control.command import SpeechIntent
from cubeling.characters.control.layers.layer import Found, FrameContext
from cubeling.characters.control.speaking.arms import ARM_MOVEMENTS, ArmJoints
from cubeling.characters.control.speaking.spoken import SpokenBody, speech_seed
from cubeling.characters.control.speaking.state import NOT_SPEAKING
from cubeling.characters.control.tagged_gestures import spans_with_hands
from cubeling.characters.model.character import Character
from cubeling.characters.motion.curves import ease
from cubeling.characters.motion.layers import lay_over
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.skeleton.way_round import WayRound
from cubeling.characters.smoothing import SpringValue
from cubeling.characters.synthesis.gestures.playing import PlannedGestureMotion

CUT_S = 0.3
"""How long hands take to leave a speech that is cut off [s]."""

JOIN_S = 0.15
"""How long hands take to join in a speech that has begun before [s]."""

HANDS_FREE = {"idle": 1.0, "hop": 1.0, "walk": 0.8, "run": 0.3}
"""Share of gestures that is shown while a character does something; none in its actions."""

FREE_LAG_S = 0.4
"""Lag with which hands become free, and are taken [s]: what is laid over an action that takes over
may not go faster than the action."""

HANDS_SHARE = 0.4
"""Share of the head's beats that is left to a character whose hands beat too."""


UNDER_GESTURE = 0.5
"""Share of what arms do besides that is taken off them by a gesture."""


class SpokenSpeech:
    """What the body does with one speech."""

    def __init__(self, character: Character, speech: SpeechIntent, now: float) -> None:
        said, profile = speech.utterance, speech.profile
        self.speech = speech
        self.body = SpokenBody(speech, character.seed, own_shifts=character.standing is None)
        """What it does besides gestures."""
        self._joined = now
        self._cut: float | None = None
        self._beats: PlannedGestureMotion | None = None
        self._way = WayRound()
        self.end = speech.start + self.body.end
        """When it is at rest again [s]."""
        if character.gestures is not None:
            asked = spans_with_hands(character, said.gestures)
            free = [a for a in said.accents if not any(s.start <= a.time <= s.end for s in asked)]
            seed = speech_seed(speech, character.seed)
            planner = profile.planner(character.gestures)
            plan = planner.plan(free, said.duration, profile.gesture_emphasis, seed)
            self._beats = plan.motion()
            self.end = max(self.end, speech.start + self._beats.duration)

    def cut(self, now: float) -> None:
        """Let it fade from a time on [s], if it is not over."""
        if self._cut is None and now < self.speech.end:
            self._cut = now
            self.end = min(self.end, now + CUT_S)

    def share(self, now: float) -> float:
        """Return how much of it is left at a time [s], 0…1."""
        share = 1.0 if self._cut is None else 1.0 - ease((now - self._cut) / CUT_S, "gonio")
        return share * ease((now - self._joined) / JOIN_S, "gonio")

    def over(self, pose: Pose, share: float) -> tuple[Pose, float]:
        """Return a pose with `share` of the gestures laid over it, and how much they cover it."""
        if self._beats is None:
            return pose, 0.0
        own = self.body.gesture_time
        weight = share * self._beats.weight(own)
        if weight <= 0.0:
            return pose, 0.0
        # A copy: what is laid over is overwritten, and these may be rows of the library.
        turns = self._beats.turns(own).copy()
        return lay_over(pose, self._beats.joints, turns, weight, self._way), weight


class SpeechLayer:
    """Lays gestures over the body of a character that speaks; it comes before posture and gaze."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        self._character = replace(character, seed=seed)
        self._arms = ArmJoints(character.skeleton, character.anatomy)
        self._spoken: list[SpokenSpeech] = []
        self._free = SpringValue(1.0)

    def update(self, pose: Pose, context: FrameContext) -> Pose | Found:
        """Return the pose with gestures and living arms, and what other layers do with a speech."""
        speech, now = context.command.speech, context.command.timestamp
        free = HANDS_FREE.get(context.frame.state, 0.0)
        free = self._free.follow(free, context.elapsed, FREE_LAG_S)
        if speech is None and not self._spoken:
            return pose
        self._follow(speech, now)
        emphasis = 2.0 ** (0.0 if speech is None else speech.emphasis)
        size = context.expressivity.amplitude * emphasis
        nods = emphasis * (1.0 if self._character.gestures is None else HANDS_SHARE)
        state, arms = NOT_SPEAKING, np.zeros(2 * len(ARM_MOVEMENTS))
        for number, spoken in enumerate(self._spoken):
            body, share = spoken.body, free * spoken.share(now)
            body.advance(now - spoken.speech.start)
            pose, covered = spoken.over(pose, share * min(emphasis, 1.0))
            arms += body.arms * ((1.0 - UNDER_GESTURE * covered) * share * size)
            own = body.state(context.elapsed, share * size * context.rest, share * nods)
            state = state.with_later(own) if number else own
        if arms.any():
            pose = self._arms.turn(pose, arms)
        return Found(pose, context.found(speaking=state))

    def _follow(self, speech: SpeechIntent | None, now: float) -> None:
        """Begin what is new, cut off what is interrupted, and forget what is over."""
        current = self._spoken[-1].speech if self._spoken else None
        if speech is not None and (current is None or speech.start != current.start):
            for spoken in self._spoken:
                spoken.cut(now)
            self._spoken.append(SpokenSpeech(self._character, speech, now))
        elif speech is None and self._spoken:
            self._spoken[-1].cut(now)
        start = None if speech is None else speech.start
        self._spoken = [s for s in self._spoken if now < s.end or s.speech.start == start]
