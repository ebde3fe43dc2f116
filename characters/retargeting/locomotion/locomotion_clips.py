"""The clips of the movement trees of a character, made from a few recordings.

Each recording is retargeted to the character, cut to one cycle and put on an arc at constant speed.
Every clip of a tree is then bent from the recording whose turn is nearest.
"""

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.locomotion.gaits import RUN_CLIPS, WALK_CLIPS
from cubeling.characters.model.bind_pose import with_bind_pose
from cubeling.characters.model.character import Character
from cubeling.characters.model.mirroring import mirror_of
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.mirror import Mirror
from cubeling.characters.retargeting.locomotion.cycle import (
    LoopCut,
    close_loop,
    find_pause,
    resample_loop,
)
from cubeling.characters.retargeting.locomotion.gait_cycle import ArcPath, GaitCycle
from cubeling.characters.retargeting.locomotion.grading import (
    YAW_RATE_PER_ANGULAR,
    GaitReport,
    angular_of,
)
from cubeling.characters.retargeting.locomotion.looking_ahead import face_ahead
from cubeling.characters.retargeting.locomotion.recorded_gait import (
    MAX_RATE_HZ,
    extract_gait,
    mirror_rigidly,
    on_character,
)
from cubeling.characters.retargeting.recording import Recording
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.retargeting.root import move_to_trajectory, with_root_joint
from cubeling.characters.skeleton.pose import Pose

_MAX_STRAIGHT_ANGULAR = 8.0  # degrees; less is straight
_MIRROR_COST = 1.0  # degrees of Angular by which a gait that needs no mirror is preferred
_IDLE_RATE_HZ, _IDLE_FRAMES = 30.0, 31
# Speed in a curve relative to straight on, by Angular: people slow down to turn.
_CURVE_SPEED: dict[str, tuple[tuple[float, ...], tuple[float, ...]]] = {
    "walk": ((0.0, 30.0, 60.0, 90.0), (1.0, 0.97, 0.86, 0.72)),
    "run": ((0.0, 45.0, 90.0), (1.0, 0.94, 0.82)),
}


@dataclass(frozen=True)
class LocomotionResult:
    """A character with locomotion clips, and how they were made."""

    character: Character
    """With the clips of the movement trees."""

    recordings: tuple[GaitReport, ...]
    """The gaits found in the recordings."""

    clips: tuple[GaitReport, ...]
    """One for each gait that was found or made."""


def make_locomotion(
    character: Character,
    walks: Sequence[Recording],
    runs: Sequence[Recording] = (),
    idle: Recording | None = None,
) -> LocomotionResult:
    """Return a character with the clips of the movement trees, made from recordings.

    Parameters
    ----------
    character
        Who is to walk; without a root joint on the ground, it gets one.
    walks, runs
        Recordings of walking, at least one, and of running: straight or curved. Without runs, the
        character runs with its walk.
    idle
        A recording of standing; left out, the character keeps its clip "idle", or gets a static
        one.

    Raises
    ------
    CharacterError
        If a recording does not fit the character, or contains no cycle.
    """
    original = character = character.with_stated_anatomy
    character = replace(character, skeleton=with_bind_pose(character))
    walker = with_root_joint(character)
    clips, recordings, made = dict(walker.clips), [], []
    mirror: Mirror | None = None
    with suppress(CharacterError):  # of characters that are not symmetric
        mirror = mirror_of(walker)
    for kind, names, given in (("walk", WALK_CLIPS, walks), ("run", RUN_CLIPS, runs)):
        gaits = [extract_gait(recording, character, walker, mirror) for recording in given]
        recordings += [GaitReport.of(gait.origin, gait, walker.meshes) for gait in gaits]
        for gait in gaits and _tree_gaits(kind, names, gaits, mirror):
            clips[gait.clip.name] = gait.clip
            made.append(GaitReport.of(gait.clip.name, gait, walker.meshes))
    if idle is not None:
        clips["idle"] = _idle_from(idle, character, walker)
    elif "idle" not in clips:
        clips["idle"] = _static_idle(clips["Walk"], Rig(walker.skeleton, walker.anatomy))
    rooted = replace(with_root_joint(original), clips=clips)
    return LocomotionResult(rooted, tuple(recordings), tuple(made))


def _tree_gaits(
    kind: str, names: Mapping[float, str], gaits: Sequence[GaitCycle], mirror: Mirror | None
) -> list[GaitCycle]:
    """Return the gaits of a tree, each bent from the one with the nearest turn."""
    knots, speeds = _CURVE_SPEED[kind]
    made: list[GaitCycle] = []
    for angular, name in names.items():
        gait, mirrored = _nearest_gait(angular, gaits, mirror)
        sign = -1.0 if mirrored else 1.0
        own_angular = sign * angular_of(gait.path)
        share = np.interp(abs(angular), knots, speeds) / np.interp(abs(own_angular), knots, speeds)
        yaw_rate = -math.radians(YAW_RATE_PER_ANGULAR * angular)
        bent = gait.bend_to(ArcPath(gait.path.speed * float(share), sign * yaw_rate))
        changes = "" if abs(own_angular - angular) < _MAX_STRAIGHT_ANGULAR else ", bent"
        bent = replace(bent, clip=replace(bent.clip, name=name))
        if mirrored and mirror is not None:
            bent = _mirror(bent, mirror)
            changes += ", mirrored"
        made.append(replace(bent, origin=gait.origin + changes))
    return made


def _nearest_gait(
    angular: float, gaits: Sequence[GaitCycle], mirror: Mirror | None
) -> tuple[GaitCycle, bool]:
    """Return the gait with the nearest turn, and whether to mirror it.

    Curved gaits are mirrored if that brings the turn to the right side. Straight gaits are bent to
    the left and mirrored for the right, so that both sides are alike.
    """
    options: list[tuple[float, int, bool]] = []
    for number, gait in enumerate(gaits):
        own = angular_of(gait.path)
        straight = abs(own) < _MAX_STRAIGHT_ANGULAR
        difference = max(abs(own - angular), _MAX_STRAIGHT_ANGULAR)  # the first of similar ones
        options.append((difference, number, straight and angular > 0 and mirror is not None))
        if mirror is not None and not straight:
            options.append((abs(-own - angular) + _MIRROR_COST, number, True))
    _, number, mirrored = min(options)
    return gaits[number], mirrored


def _mirror(gait: GaitCycle, mirror: Mirror) -> GaitCycle:
    """Return a gait mirrored and shifted by half a cycle, so that it begins with the left foot."""
    clip = gait.clip
    image = mirror_rigidly(clip, mirror, gait.rig)
    count = len(image) - 1
    order = (np.arange(len(image)) + count // 2) % count
    poses = move_to_trajectory(image.in_place[order], image.track)
    mirrored = replace(
        gait,
        clip=replace(image, poses=poses),
        path=ArcPath(gait.path.speed, -gait.path.yaw_rate),
        contacts=gait.contacts.at(order).mirrored,
    )
    # A body that is not exactly symmetric steps elsewhere.
    return mirrored.with_held_feet()


def _idle_from(recording: Recording, character: Character, walker: Character) -> Clip:
    """Return a recording of standing as a loop in place."""
    clip, _ = on_character(recording, character, walker)
    rig = Rig(walker.skeleton, walker.anatomy)
    cut = LoopCut(0, len(clip) - 1, 0.0) if clip.loop else find_pause(clip, rig)
    loop = close_loop(clip, [clip.in_place[slice(cut.start, cut.end + 1)]])
    loop = resample_loop(loop, MAX_RATE_HZ) if loop.rate > MAX_RATE_HZ else loop
    return face_ahead(replace(loop, name="idle", root_motion=True), rig)


def _static_idle(walk: Clip, rig: Rig) -> Clip:
    """Return a standing clip: legs and trunk at rest, arms in their mean pose of a walk."""
    rest = rig.skeleton.rest
    mean = walk.in_place.rotations.sum(0)
    mean /= np.maximum(np.linalg.norm(mean, axis=-1, keepdims=True), 1e-9)
    arms = {
        j for side in ("left", "right") if (j := rig.anatomy.joint(side + "UpperArm")) is not None
    }
    arm_joints = [j for j in range(len(rig.skeleton)) if set(rig.chain_to(j)) & arms]
    turns = rest.rotations.copy()
    turns[arm_joints] = mean[arm_joints]
    scales = None if rest.scales is None else rest.scales[None]
    poses = Pose(rest.translations[None], turns[None], scales)[np.zeros(_IDLE_FRAMES, np.intp)]
    return Clip("idle", _IDLE_RATE_HZ, poses, loop=True, root_motion=True)
