"""Layers for characters that play motions of others, and gestures of few joints."""

from cubeling.characters.body.capsules import CapsuleBody
from cubeling.characters.body.dependent_joints import DependentJoints
from cubeling.characters.body.self_collision import SafeRanges
from cubeling.characters.control.layers.layer import FrameContext
from cubeling.characters.errors import CharacterError
from cubeling.characters.model.character import Character
from cubeling.characters.model.standing import idle_clips
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.smoothing import SpringValue
from cubeling.characters.synthesis.idle.posture_space import PostureVectors

JOIN_LAG_S = 0.3
"""Lag with which a body joins in a gesture [s]."""

LEAST_SHARE = 1e-4
"""Share of joining in below which it is none."""


def dependent_joints_of(character: Character) -> DependentJoints:
    """Return the filter of a humanoid's own clips.

    Raises
    ------
    CharacterError
        If it is no humanoid, or has no clips.
    """
    if character.anatomy.kind != "humanoid" or not character.clips:
        raise CharacterError(f"{character.name}: dependent joints need a person with clips")
    kind = PostureVectors.of(character.skeleton, character.anatomy, "upper")
    return DependentJoints.of([clip.poses for clip in character.clips.values()], kind)


def safe_ranges_of(character: Character) -> SafeRanges:
    """Return the ranges of a humanoid in which it does not reach through itself.

    They are within the postures of its own clips, and about the first one of its idle clip.

    Raises
    ------
    CharacterError
        If it is no humanoid, or has no clip of idling or no skin.
    """
    idle = idle_clips(character.clips)
    if character.anatomy.kind != "humanoid" or not idle or not character.meshes:
        raise CharacterError(
            f"{character.name}: self-collision needs a person with a skin and a clip called idle"
        )
    skeleton, anatomy = character.skeleton, character.anatomy
    body = CapsuleBody.of(skeleton, anatomy, character.meshes, idle[0].poses)
    kind = PostureVectors.of(skeleton, anatomy, "upper")
    clips = [clip.poses for clip in character.clips.values()]
    return SafeRanges.of(clips, kind, body, idle[0].poses[:1])


class SelfCollisionLayer:
    """Damps the upper body before it reaches through itself; see `safe_ranges_of`."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        self._ranges = safe_ranges_of(character)

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with its upper body in its safe ranges."""
        return self._ranges.keep(pose)


class DependentJointsLayer:
    """Lets spine, shoulders and head join in actions and gestures; see `dependent_joints_of`."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        self._filter = dependent_joints_of(character)
        self._gesturing = SpringValue(0.0)

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with what they move along; as it was without an action or gesture."""
        behaviour, now = context.command.behaviour, context.command.timestamp
        gestures = () if behaviour is None else behaviour.gestures
        times = [each.times for each in gestures]
        under_way = any(
            each.start <= now and (each.end is None or now < each.end) for each in times
        )
        share = self._gesturing.follow(float(under_way), context.elapsed, JOIN_LAG_S)
        if context.frame.acting:
            share = max(share, 1.0 - context.rest)
        return self._filter.move(pose, min(share, 1.0)) if share > LEAST_SHARE else pose
