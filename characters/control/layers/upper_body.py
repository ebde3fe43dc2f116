"""Layers for characters that play motions of others, and gestures of few joints."""

import numpy as np

from characters.body.capsules import CapsuleBody
from characters.body.dependent_joints import DependentJoints
from characters.body.self_collision import SafeRanges
from characters.control.layers.layer import FrameContext
from characters.model.character import Character
from characters.skeleton.pose import Pose
from characters.synthesis.idle.posture_space import PostureVectors


class SelfCollisionLayer:
    """Damps the upper body before it reaches through itself; humanoids with an idle clip only.

    The ranges are those of its own clips.
    """

    def __init__(self, character: Character, seed: int = 0) -> None:
        self._ranges: SafeRanges | None = None
        if character.anatomy.kind == "humanoid" and "idle" in character.clips:
            skeleton, anatomy = character.skeleton, character.anatomy
            clear = character.clips["idle"].poses
            body = CapsuleBody.of(skeleton, anatomy, character.meshes, clear)
            kind = PostureVectors.of(skeleton, anatomy, "upper")
            clips = [clip.poses for clip in character.clips.values()]
            self._ranges = SafeRanges.of(clips, kind, body, clear[:1])

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with its upper body in its safe ranges."""
        return pose if self._ranges is None else self._ranges.keep(pose)


class DependentJointsLayer:
    """Lets spine, shoulders and head join in the actions of a humanoid."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        self._filter: DependentJoints | None = None
        if character.anatomy.kind == "humanoid" and character.clips:
            kind = PostureVectors.of(character.skeleton, character.anatomy, "upper")
            clips = [clip.poses for clip in character.clips.values()]
            self._filter = DependentJoints.of(clips, kind)

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with what the action moves along; as it was without an action."""
        if self._filter is None or not context.frame.acting:
            return pose
        kind = self._filter.kind
        own = kind.vectors(pose[None])[0]
        share = float(np.clip(1.0 - context.rest, 0.0, 1.0))
        return kind.poses(own + share * (self._filter.apply(own) - own), pose)
