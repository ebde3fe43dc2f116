"""The body of who speaks: gestures that beat the rhythm, and nods."""

import zlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cubeling.characters.body.head_joints import HeadJoints
from cubeling.characters.control.command import SpeechIntent
from cubeling.characters.control.layers.layer import FrameContext
from cubeling.characters.control.tagged_gestures import spans_with_hands
from cubeling.characters.model.character import Character
from cubeling.characters.motion.curves import Curve, Keyed, ease
from cubeling.characters.motion.layers import lay_over
from cubeling.characters.motion.motion import Motion
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.smoothing import low_pass
from cubeling.characters.speech.speech import Accent

CUT_S = 0.3
"""How long hands take to leave a speech that is cut off [s]."""

JOIN_S = 0.15
"""How long hands take to join in a speech that has begun before [s]."""

HANDS_FREE = {"idle": 1.0, "walk": 0.8, "run": 0.3}
"""Share of gestures that is shown while a character does something; none in its actions."""

FREE_LAG_S = 0.2
"""Lag with which hands become free, and are taken [s]."""

HANDS_SHARE = 0.4
"""Share of the head's beats that is left to a character whose hands beat too."""


@dataclass(frozen=True, eq=False)
class OverlaidMotion:
    """A motion of some joints that lies over another one."""

    motion: Motion

    start: float
    """When it begins [s]."""

    weight: Curve
    """How much of it shows over time, 0…1."""

    joints: tuple[int, ...]
    """The joints that it moves."""

    def over(self, pose: Pose, now: float, share: float) -> Pose:
        """Return a pose with the motion laid over it."""
        own = now - self.start
        weight = share * self.weight.at(own, self.motion.duration)
        if weight <= 0.0:
            return pose
        joints = np.array(self.joints)
        return lay_over(pose, joints, self.motion.sample(own).rotations.take(joints, 0), weight)


class SpeechGestures:
    """The gestures of one speech."""

    def __init__(self, character: Character, speech: SpeechIntent, now: float) -> None:
        said = speech.utterance
        seed = zlib.crc32(said.text.encode()) + character.seed
        self.speech = speech
        self._joined = now
        self._cut: float | None = None
        self._overlays: list[OverlaidMotion] = []
        self.head = HeadBeats(said.accents, seed)
        """The beats of its head."""
        if character.gestures is not None:
            asked = spans_with_hands(character, said.gestures)
            free = [a for a in said.accents if not any(s.start <= a.time <= s.end for s in asked)]
            profile = speech.profile
            planner = profile.planner(character.gestures)
            plan = planner.plan(free, said.duration, profile.gesture_emphasis, seed)
            beats = plan.motion()
            self._overlays.append(
                OverlaidMotion(beats, speech.start, beats.weights, character.gestures.joints)
            )
        ends = [
            speech.start + said.duration,
            *(o.start + o.motion.duration for o in self._overlays),
        ]
        self.end = max(ends)
        """When hands are in rest again [s]."""

    def cut(self, now: float) -> None:
        """Let them fade from a time on [s], if they are not over."""
        if self._cut is None and now < self.speech.end:
            self._cut = now
            self.end = min(self.end, now + CUT_S)

    def share(self, now: float) -> float:
        """Return how much of them is left at a time [s], 0…1."""
        share = 1.0 if self._cut is None else 1.0 - ease((now - self._cut) / CUT_S, "gonio")
        return share * ease((now - self._joined) / JOIN_S, "gonio")

    def over(self, pose: Pose, now: float, hands: float) -> Pose:
        """Return a pose with the gestures laid over it; `hands` is their share, 0…1."""
        share = self.share(now)
        for overlay in self._overlays:
            pose = overlay.over(pose, now, hands * share)
        return pose


class SpeechLayer:
    """Lays gestures over the body of a character that speaks; it comes before posture and gaze."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        self._character = replace(character, seed=seed)
        head = character.anatomy.joint("head")
        self._head = None
        if head is not None:
            self._head = HeadJoints(character.skeleton, character.anatomy, head)
        self._spoken: list[SpeechGestures] = []
        self._free = 1.0

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with gestures and nods."""
        speech, now = context.command.speech, context.command.timestamp
        free = HANDS_FREE.get(context.frame.state, 0.0)
        self._free = low_pass(self._free, free, context.elapsed, FREE_LAG_S)
        if speech is None and not self._spoken:
            return pose
        self._follow(speech, now)
        nod = np.zeros(3)
        for spoken in self._spoken:
            pose = spoken.over(pose, now, self._free)
            nod += spoken.share(now) * spoken.head.at(now - spoken.speech.start)
        if self._head is None or not nod.any():
            return pose
        nod *= self._free * (1.0 if self._character.gestures is None else HANDS_SHARE)
        self._head.place(pose)
        turns = pose.rotations.copy()
        x, y, z = nod.tolist()
        self._head.turn_head(turns, (x, y, z))
        return replace(pose, rotations=turns)

    def _follow(self, speech: SpeechIntent | None, now: float) -> None:
        """Begin what is new, cut off what is interrupted, and forget what is over."""
        current = self._spoken[-1].speech if self._spoken else None
        if speech is not None and (current is None or speech.start != current.start):
            for spoken in self._spoken:
                spoken.cut(now)
            self._spoken.append(SpeechGestures(self._character, speech, now))
        elif speech is None and self._spoken:
            self._spoken[-1].cut(now)
        self._spoken = [each for each in self._spoken if now < each.end or each.speech is speech]


WEAK_RAD, STRONG_RAD = np.deg2rad(1.5), np.deg2rad(6.5)
"""How far the head goes down for the weakest and the strongest accent [rad]."""

TILT_SHARE = 0.35
"""How far it tilts and turns to a side meanwhile, at most, as a share of that."""

LIFT_SHARE = 0.4
"""How far it is lifted before, as a share."""

LIFT_S, DOWN_S, BACK_S = -0.22, 0.03, 0.42
"""When it is lifted, down and back again, from the accent [s]."""

START_S = LIFT_S - 0.2
"""When a beat begins, from the accent [s]."""


class HeadBeats:
    """The head beats of one speech: small nods with which a head stresses what is said.

    That heads move with stressed syllables: Munhall et al., "Visual prosody and speech
    intelligibility", 2004; sizes and times are ours.
    """

    def __init__(self, accents: Sequence[Accent], seed: int) -> None:
        rng = np.random.default_rng(seed)
        self._beats = [
            (each.time, WEAK_RAD + (STRONG_RAD - WEAK_RAD) * each.strength, rng.uniform(-1, 1, 2))
            for each in accents
        ]

    def at(self, time: float) -> Array:
        """Return how the head is turned at a time of the speech [s]: a rotation vector (3,).

        Its axes are those of the body: x nods, y turns, z tilts.
        """
        turned = np.zeros(3)
        for accent, size, (turn, tilt) in self._beats:
            own = time - accent
            if START_S < own < BACK_S:
                nod = _NOD.at(own - START_S, BACK_S - START_S)
                aside = TILT_SHARE * abs(nod)
                turned += size * np.array([nod, aside * turn, aside * tilt])
        return turned


_NOD = Keyed(
    tuple(each - START_S for each in (START_S, LIFT_S, DOWN_S, BACK_S)),
    (0.0, -LIFT_SHARE, 1.0, 0.0),
    "gonio",
)
