"""The layer that plays clips over their joints: `CharacterCommand.behaviour.clips`."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.behaviour.gesticon import Gesticon
from cubeling.characters.behaviour.intents import ClipIntent
from cubeling.characters.control.layers.layer import FrameContext
from cubeling.characters.model.character import Character
from cubeling.characters.motion.curves import FadeCurve
from cubeling.characters.motion.layers import lay_over
from cubeling.characters.motion.modifiers import Stretch
from cubeling.characters.motion.motion import Motion
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.skeleton.way_round import WayRound
from cubeling.characters.smoothing import SpringValue
from cubeling.characters.synthesis.gestures.library import gesture_joints

FADE = FadeCurve(0.25, 0.3)
"""How a clip comes and goes."""

LEAVE_S = 0.3
"""How long a clip takes to go that is left out before its end [s]."""

HANDS_FREE = {"idle": 1.0, "hop": 1.0, "walk": 0.8, "run": 0.3}
"""Share of clips that is shown while a character does something; none in its actions."""

FREE_LAG_S = 0.4
"""Lag with which hands become free, and are taken [s]: what is laid over an action that takes over
may not go faster than the action."""

MIN_MOVED_RAD = np.deg2rad(3.0)
"""A joint that a clip turns less than this is not one that it is for [rad]."""

MIN_MOVED_SHARE = 0.1
"""Nor one that it turns less than this share of what it turns most."""

EXAMINED_MOMENTS = 24
"""Moments at which a clip is looked at."""


@dataclass(eq=False)
class _Playing:
    intent: ClipIntent
    motion: Motion
    joints: NDArray[np.intp]
    present: float = 1.0
    way: WayRound = field(default_factory=WayRound)


class ClipLayer:
    """Lays clips over the body; it comes after gestures and before posture and gaze."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        self._character = character
        self._playing: list[_Playing] = []
        self._free = SpringValue(1.0)

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with its clips."""
        behaviour, now = context.command.behaviour, context.command.timestamp
        free = HANDS_FREE.get(context.frame.state, 0.0)
        free = self._free.follow(free, context.elapsed, FREE_LAG_S)
        asked = () if behaviour is None else behaviour.clips
        if not asked and not self._playing:
            return pose
        self._follow(asked, context.elapsed)
        for each in self._playing:
            own, length = now - each.intent.times.start, each.motion.duration
            weight = each.present * free * FADE.at(own, length)
            if 0.0 < own < length and weight > 0.0:
                turns = each.motion.sample(own).rotations.take(each.joints, 0)
                pose = lay_over(pose, each.joints, turns, weight, each.way)
        return pose

    def _follow(self, asked: Sequence[ClipIntent], elapsed: float) -> None:
        known = {each.intent.key: each for each in self._playing}
        going = []
        for intent in asked:
            each = known.pop(intent.key, None)
            if each is None or each.intent != intent:
                each = self._begin(intent, 1.0 if each is None else each.present)
            if each is not None:
                going.append(each)
        for each in known.values():
            each.present -= elapsed / LEAVE_S
        self._playing = [each for each in known.values() if each.present > 0.0] + going

    def _begin(self, intent: ClipIntent, present: float) -> _Playing | None:
        clip = self._character.clips.get(intent.name)
        if clip is None:
            return None
        end = intent.times.end
        length = clip.duration if end is None else max(end - intent.times.start, 1e-3)
        return _Playing(
            intent, Stretch(clip, length), clip_joints(self._character, intent.name), present
        )


def clip_joints(character: Character, name: str) -> NDArray[np.intp]:
    """Return the joints that a clip is for, (n,): those the gesticon names, or those it moves.

    They are joints of the upper body; on four legs, of neck, head and tail.
    """
    anatomy, skeleton = character.anatomy, character.skeleton
    joints = gesture_joints(skeleton, anatomy)
    part = Gesticon.bundled().clip_part(name)
    neck, head = anatomy.joint("neck"), anatomy.joint("head")
    above = set() if head is None else set(subtree(skeleton, head if neck is None else neck))
    if part == "head":
        return np.array([joint for joint in joints if joint in above], np.intp)
    if part == "arms":
        trunk = {anatomy.joint(each) for each in ("spine", "chest", "upperChest")}
        return np.array([joint for joint in joints if joint not in above | trunk], np.intp)
    clip = character.clips[name]
    times = np.linspace(0.0, clip.duration, EXAMINED_MOMENTS)
    turns = np.stack([clip.sample(time).rotations for time in times.tolist()])
    apart = rotations.to_rotation_vector(rotations.multiply(rotations.conjugate(turns[0]), turns))
    moved = np.linalg.norm(apart, axis=-1).max(axis=0)
    least = max(MIN_MOVED_RAD, MIN_MOVED_SHARE * float(moved.max(initial=0.0)))
    return np.array([joint for joint in joints if moved[joint] > least], np.intp)
