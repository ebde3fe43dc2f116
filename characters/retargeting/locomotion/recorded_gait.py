"""Extraction of one regular gait cycle from a recording, on a character."""

import math
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.locomotion.gaits import MIN_CYCLE_LENGTH
from cubeling.characters.model.character import Character
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.mirror import Mirror
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.retargeting.feet.footskate import FootContacts, find_foot_contacts
from cubeling.characters.retargeting.feet.ground_motion import find_ground_motion, transform
from cubeling.characters.retargeting.locomotion.cycle import (
    LoopCut,
    close_loop,
    cut_at,
    find_cycle,
    find_middle,
    resample_loop,
    symmetric_steps,
)
from cubeling.characters.retargeting.locomotion.gait_cycle import ArcPath, GaitCycle
from cubeling.characters.retargeting.locomotion.grading import (
    MAX_SEAM_CM,
    PERSON_LEG_M,
    refuse_lying,
    refuse_other_motion,
)
from cubeling.characters.retargeting.locomotion.looking_ahead import look_ahead
from cubeling.characters.retargeting.measures import knee_quantiles
from cubeling.characters.retargeting.recording import Recording
from cubeling.characters.retargeting.retarget import retarget
from cubeling.characters.retargeting.rig import Rig, leg_pairs
from cubeling.characters.retargeting.root import (
    clip_with_root,
    has_root_joint,
    move_to_trajectory,
    with_root_trajectory,
)
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

MAX_RATE_HZ = 60.0
"""Finer recordings are resampled."""

_MAX_STRAIGHT_TURN = math.radians(20.0)  # of a stride whose steps are made alike
_MAX_RIGID_TRAVEL = 1e-4  # leg lengths; so far do joints move in files that round their places
_MAX_REPEATED_SEAM = 0.1  # leg lengths; parts of a loop that differ more do not repeat


@dataclass(frozen=True)
class _Stride:
    """A stride of a recording on the walker, before it is closed."""

    steps: list[Pose]
    """All of it in place, or its two steps one by one."""

    contacts: FootContacts
    """When its feet stand; the last frame is the first again."""

    seam: float
    """See `LoopCut.seam` [leg lengths]."""

    delta: RootDelta
    """Its way."""

    knees: Array | None
    """See `GaitCycle.source_knees`."""


def extract_gait(
    recording: Recording, character: Character, walker: Character, mirror: Mirror | None = None
) -> GaitCycle:
    """Return the best cycle of a recording; `walker` is the character with a root joint.

    With its mirror, the steps of a take that hardly repeats are made alike.
    """
    refuse_lying(recording)
    rig = Rig(walker.skeleton, walker.anatomy, walker.meshes)
    clip, contacts = on_character(recording, character, walker)
    recorded = recording.clip, Rig(recording.skeleton, recording.anatomy)
    moved = _without_treadmill(clip, rig, contacts)
    # Whoever is to walk like it, a recording repeats where the recorded body does.
    cut = _cycle_of(*(recorded if moved is clip else (moved, rig)), contacts.any[:, :2])
    clip = moved
    if not clip.loop or cut.seam > 0.0:
        cut = cut_at(clip, rig, cut.start, cut.end)
    clip, delta = _along_its_way(clip, cut, rig)
    seconds = (cut.end - cut.start) / clip.rate
    path = ArcPath.of(delta, seconds)
    if path.speed * seconds < MIN_CYCLE_LENGTH * character.height:
        raise CharacterError(
            f"{recording.origin}: goes nowhere ({path.speed:.2f} m/s), and its feet do not stand "
            "as on a treadmill of constant speed; give a clip that walks"
        )
    frames = np.array([*range(cut.start, cut.end), cut.start])
    steps, knees = (
        [clip.in_place[slice(cut.start, cut.end + 1)]],
        _source_knees(recording, rig, cut),
    )
    stride = _Stride(steps, contacts.at(frames), cut.seam, delta, knees)
    if 100 * PERSON_LEG_M * cut.seam > MAX_SEAM_CM and abs(delta.yaw) < _MAX_STRAIGHT_TURN:
        image = _image_of(clip, recording, character, walker, mirror)
        stride = _with_like_steps(stride, clip, image, rig, cut, contacts)
    loop, contacts, delta = close_loop(clip, stride.steps), stride.contacts, stride.delta
    down = contacts.any[:-1, 0]
    landing = int(np.argmax(down & ~np.roll(down, 1)))  # of the left foot; 0 if it never lands
    order = (np.arange(len(loop)) + landing) % (len(loop) - 1)
    loop, contacts = replace(loop, poses=loop.poses[order]), contacts.at(order)
    if clip.rate > MAX_RATE_HZ:
        fine = len(loop)
        loop = resample_loop(loop, MAX_RATE_HZ)
        contacts = contacts.at(np.linspace(0, fine - 1, len(loop)).round().astype(int))
    path = ArcPath.of(delta, loop.duration)
    times = np.arange(len(loop)) / loop.rate
    poses = move_to_trajectory(loop.poses, path.at(times))
    loop = replace(loop, poses=poses, root_motion=True)
    seam = stride.seam * rig.leg_length
    gait = GaitCycle(recording.origin, loop, rig, contacts, path, seam, stride.knees)
    gait = gait.with_held_feet()
    refuse_other_motion(gait)
    return gait


def _along_its_way(clip: Clip, cut: LoopCut, rig: Rig) -> tuple[Clip, RootDelta]:
    """Return a clip whose root looks along the way of a cycle, and that way."""
    start, end = (RootDelta(*clip.track[frame]) for frame in (cut.start, cut.end))
    way = start.inverse().then(end).then(cut.drift)
    # The root looks along the arc: half of the turn is before the middle of its chord.
    first = RootDelta(yaw=math.atan2(way.x, way.z) - way.yaw / 2)
    last = cut.drift.then(first)
    x, z, yaw = (
        np.interp(np.arange(len(clip)), [cut.start, cut.end], ends)
        for ends in ((first.x, last.x), (first.z, last.z), (first.yaw, last.yaw))
    )
    moved = transform(clip.track, np.stack([x, np.zeros_like(x), z], axis=-1))
    track = np.stack([moved[:, 0], moved[:, 2], clip.track[:, 2] + yaw], axis=-1)
    children = np.flatnonzero(np.array(rig.skeleton.parents) == 0)
    return replace(clip, poses=with_root_trajectory(clip.poses, children, track)), way


def _image_of(
    clip: Clip,
    recording: Recording,
    character: Character,
    walker: Character,
    mirror: Mirror | None,
) -> Clip | None:
    """Return the mirror image of a clip; None if neither body nor recording is symmetric.

    Who is not symmetric does what the mirror image of the recorded person does.
    """
    if walker.anatomy.kind != "humanoid":
        return None
    if mirror is not None:
        return mirror_rigidly(clip, mirror, Rig(walker.skeleton, walker.anatomy))
    with suppress(CharacterError):
        other = Mirror.of(recording.skeleton).clip(recording.clip)
        image, _ = on_character(replace(recording, clip=other), character, walker)
        children = np.flatnonzero(np.array(walker.skeleton.parents) == 0)
        track = clip.track * [-1.0, 1.0, -1.0]
        return replace(image, poses=with_root_trajectory(image.poses, children, track))
    return None


def mirror_rigidly(clip: Clip, mirror: Mirror, rig: Rig) -> Clip:
    """Return a mirrored clip whose bones keep their lengths, also on a slightly uneven body."""
    image = mirror.clip(clip)
    travel = np.ptp(clip.in_place.translations, axis=0).max(-1)
    rigid = np.flatnonzero(travel < _MAX_RIGID_TRAVEL * rig.leg_length)
    rigid = rigid[rigid > 0]
    image.poses.translations[:, rigid] = clip.poses.translations[:, rigid]
    return image


def _with_like_steps(
    stride: _Stride, clip: Clip, image: Clip | None, rig: Rig, cut: LoopCut, contacts: FootContacts
) -> _Stride:
    """Return a stride straight ahead whose steps are mirror images of each other, if it can be."""
    middle = None if image is None else find_middle(clip, image, rig, cut, contacts.any[:, :2])
    if image is None or middle is None:
        return stride
    steps = symmetric_steps(clip, image, cut, middle)
    frames = np.linspace(cut.start, middle, len(steps[0].rotations)).round().astype(int)
    knees = None if stride.knees is None else np.tile(stride.knees.mean(0), (len(stride.knees), 1))
    return _Stride(
        steps,
        contacts.at(frames).then_mirrored(),
        stride.seam / 2,  # a step's end and the next one's beginning share one of their two frames
        RootDelta(z=stride.delta.length),
        knees,
    )


def _source_knees(recording: Recording, rig: Rig, cut: LoopCut) -> Array | None:
    """Return how far the knees of a person's recording are bent in a cycle, (legs, 5)."""
    if rig.anatomy.kind == "quadruped":
        return None
    source = Rig(recording.skeleton, recording.anatomy)
    cycle = recording.clip.poses[slice(cut.start, cut.end + 1)]
    return np.array([knee_quantiles(cycle, source, leg) for leg, _ in leg_pairs(source, rig)])


def _cycle_of(clip: Clip, rig: Rig, contacts: NDArray[np.bool_]) -> LoopCut:
    """Return the best cycle of a recording, or all of a loop unless it holds several."""
    if not clip.loop:
        return find_cycle(clip, rig, contacts)
    whole = LoopCut(0, len(clip) - 1, 0.0)
    steady = contacts[:-1]
    landings = (steady & ~np.roll(steady, 1, axis=0)).sum(0)
    if landings.max() > 1:
        with suppress(CharacterError):
            one = find_cycle(replace(clip, loop=False), rig, contacts)
            return one if one.seam < _MAX_REPEATED_SEAM else whole
    return whole


def on_character(
    recording: Recording, character: Character, walker: Character
) -> tuple[Clip, FootContacts]:
    """Return a recording as a clip of the walker, and its foot contacts."""
    source = Rig(recording.skeleton, recording.anatomy)
    target = Rig(walker.skeleton, walker.anatomy)
    for name, rig in ((recording.origin, source), (character.name, target)):
        if rig.anatomy.joint("hips") is None:
            raise CharacterError(
                f"{name}: no hips found in its skeleton; name them in a [joints] table, see "
                "docs/your-own-character.md"
            )
    legs = [leg for leg, _ in leg_pairs(source, target)]
    try:
        contacts = find_foot_contacts(recording.clip, source, legs)
    except CharacterError as error:
        raise CharacterError(f"{recording.origin}: {error}") from None
    if not _are_same(recording.skeleton, character.skeleton):
        args = (recording.skeleton, recording.anatomy, walker.skeleton, walker.anatomy)
        clip = retarget(recording.clip, *args, meshes=walker.meshes)
        return look_ahead(clip, target), contacts
    if has_root_joint(character.skeleton, character.anatomy):
        return replace(recording.clip, root_motion=True), contacts
    return clip_with_root(recording.clip, character.skeleton, character.anatomy), contacts


def _are_same(one: Skeleton, other: Skeleton) -> bool:
    """Return whether clips of one skeleton fit the other without retargeting."""
    return (
        one.names == other.names
        and one.parents == other.parents
        and np.allclose(one.rest.translations, other.rest.translations, atol=1e-4)
        and np.allclose(one.rest.rotations, other.rest.rotations, atol=1e-4)
    )


def _without_treadmill(clip: Clip, rig: Rig, contacts: FootContacts) -> Clip:
    """Return a clip that walks in place as one that moves over the ground."""
    legs = rig.legs[: contacts.ball.shape[1]]
    once = replace(clip, loop=False)
    frame_poses = find_ground_motion(once, rig, legs, contacts.ball, 1.0).frame_poses
    if not frame_poses.any():
        return clip
    deltas = [
        RootDelta(*frame).then(RootDelta(*root))
        for frame, root in zip(frame_poses, clip.track, strict=True)
    ]
    trajectory = np.array([[delta.x, delta.z, delta.yaw] for delta in deltas])
    return replace(clip, poses=move_to_trajectory(clip.in_place, trajectory))
