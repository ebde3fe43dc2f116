"""The motion of one body on another: turns as they are, ways in proportion to the legs.

Every joint turns away from the common reference pose as its partner does, seen in the axes that
both bodies share. Which way the axes of a joint point, and how it rests, therefore does not matter.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from characters.motion.clip import Clip
from characters.motion.contacts import find_contacts
from characters.retargeting.body import Body, Leg, turns_of
from characters.retargeting.mapping import Mapping
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose


def turned(clip: Clip, source: Body, target: Body, mapping: Mapping) -> Array:
    """Return how each joint of the target is turned, (frames, joints, 4), in the common axes."""
    globals_ = clip.poses.globals(source.skeleton)
    used, places = np.unique(mapping.sources, return_inverse=True)
    now = rotations.multiply(source.upright, turns_of(globals_[:, used]))
    away = rotations.multiply(now, rotations.conjugate(source.rest_turns[used]))
    first, second = (away[:, column] for column in places.reshape(-1, 2).T)
    moved = np.where(
        mapping.shares[:, None] > 0, rotations.slerp(first, second, mapping.shares), first
    )
    reference = rotations.multiply(mapping.corrections, target.rest_turns[mapping.joints])
    moved = rotations.multiply(moved, reference)
    # What has no partner rides on the nearest ancestor that has one.
    carrier = _carriers(target, mapping.joints)
    every = np.tile(target.rest_turns, (len(clip), 1, 1))
    rides = carrier >= 0
    above = mapping.joints[carrier[rides]]
    own = rotations.multiply(
        rotations.conjugate(target.rest_turns[above]), target.rest_turns[rides]
    )
    every[:, rides] = rotations.multiply(moved[:, carrier[rides]], own)
    return every


def _carriers(body: Body, joints: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return for each joint the place in `joints` of its nearest ancestor or itself, or −1."""
    place = {int(joint): number for number, joint in enumerate(joints)}
    carriers = np.full(len(body.skeleton), -1)
    for joint, parent in enumerate(body.skeleton.parents):
        carriers[joint] = place.get(joint, carriers[parent] if parent >= 0 else -1)
    return carriers


def hips_way(clip: Clip, source: Body, target: Body, heights: Array) -> Array:
    """Return where the target's hips are, (frames, 3) [m], in the common axes.

    Parameters
    ----------
    heights
        How high the source's and the target's ankles are above the ground when they stand, (2,).
    """
    ratio = target.leg_length / source.leg_length
    places = clip.poses.globals(source.skeleton)[:, source.anatomy.joints["hips"], :3, 3]
    way = rotations.rotate(source.upright, places)
    mine, theirs = _seat(target), _seat(source)
    way = way * ratio
    way[:, 1] += mine + heights[1] - ratio * (theirs + heights[0])
    return way


def _seat(body: Body) -> float:
    """Return how high the hips' joint is above those of the thighs [m]; for a beast, its ankles.

    Where people differ in how they stand at rest their legs are laid along each other; beasts
    keep their stance, so the whole height of it counts.
    """
    hips = body.rest_places[body.anatomy.joints["hips"], 1]
    low = [leg.upper if body.anatomy.kind == "humanoid" else leg.foot for leg in body.legs[:2]]
    return float(hips - body.rest_places[low, 1].mean())


def ankle_heights(clip: Clip, source: Body, target: Body) -> Array:
    """Return how high the ankles are above the ground when they stand, of both bodies, (2,) [m].

    Of a body that stands at rest, as there; of a recorded skeleton, whose rest pose hangs in the
    air, as in the clip.
    """
    ratio = target.leg_length / source.leg_length
    theirs = _rest_height(source)
    if theirs is None:
        theirs = _height_in(clip, source)
    mine = _rest_height(target)
    return np.array([theirs, ratio * theirs if mine is None else mine])


def _rest_height(body: Body) -> float | None:
    if not body.stands:
        return None
    return float(np.mean([body.rest_places[leg.foot, 1] for leg in body.legs[:2]]))


def _height_in(clip: Clip, body: Body) -> float:
    """Return how high the ankles are in a clip while they stand [m]."""
    legs = body.legs[:2]
    clip = upright_clip(clip, body)
    feet = [leg.foot for leg in legs]
    heights = clip.poses.globals(body.skeleton)[:, feet, 1, 3]
    down = find_contacts(clip, body.skeleton, [[foot] for foot in feet])
    return float(np.median(heights[down] if down.any() else heights.min(0)))


def upright_clip(clip: Clip, body: Body) -> Clip:
    """Return a clip with its root turned so that +y is up and +z ahead."""
    if np.allclose(body.upright, rotations.IDENTITY):
        return clip
    roots = np.flatnonzero(np.array(body.skeleton.parents) < 0)
    poses = clip.poses
    translations, turns = poses.translations.copy(), poses.rotations.copy()
    translations[:, roots] = rotations.rotate(body.upright, translations[:, roots])
    turns[:, roots] = rotations.multiply(body.upright, turns[:, roots])
    return replace(clip, poses=replace(poses, translations=translations, rotations=turns))


def posed(body: Body, turns: Array, hips: Array, root: Array | None) -> Pose:
    """Return poses from turns (frames, joints, 4) and the hips' way (frames, 3), common axes.

    Parameters
    ----------
    root
        Where the root is on the ground, (frames, 3): x, z [m] and yaw [rad]; None without root
        motion.
    """
    skeleton, frames = body.skeleton, len(turns)
    own = rotations.multiply(rotations.conjugate(body.upright), turns)
    translations = np.tile(skeleton.rest.translations, (frames, 1, 1))
    scales = skeleton.rest.scales
    if scales is not None:
        scales = np.tile(scales, (frames, 1, 1))
    if root is not None:
        own[:, 0] = rotations.multiply(rotations.about("y", root[:, 2]), skeleton.rest.rotations[0])
        translations[:, 0] = np.stack([root[:, 0], 0 * root[:, 0], root[:, 1]], axis=-1)
    pose = Pose(translations, locals_of(own, skeleton.parents), scales)
    joint = body.anatomy.joints["hips"]
    place(pose, body, joint, rotations.rotate(rotations.conjugate(body.upright), hips))
    for leg in body.legs:
        if not leg.attached:
            place(pose, body, leg.foot, ankle(pose.globals(skeleton), body, leg))
    return pose


def place(pose: Pose, body: Body, joint: int, at: Array) -> None:
    """Put a joint of poses at places (frames, 3) [m] of the skeleton's axes."""
    parent = body.skeleton.parents[joint]
    if parent >= 0:
        above: Array = pose.globals(body.skeleton)[:, parent]
        from_parent = (at - above[:, :3, 3])[..., None]
        at = np.asarray(np.linalg.solve(above[:, :3, :3], from_parent)[..., 0], float)
    pose.translations[:, joint] = at


def ankle(globals_: Array, body: Body, leg: Leg) -> Array:
    """Return where the ankle is, (frames, 3) [m]: a point that is fast to the shin."""
    rest = body.skeleton.rest.globals(body.skeleton)
    local = np.linalg.inv(rest[leg.lower]) @ rest[leg.foot, :, 3]
    point: Array = globals_[..., leg.lower, :3, :] @ local
    return point


def locals_of(turns: Array, parents: tuple[int, ...]) -> Array:
    """Return rotations relative to the parent (frames, joints, 4) from those in the character."""
    above = np.array(parents)
    relative = turns.copy()
    below = above >= 0
    relative[:, below] = rotations.multiply(
        rotations.conjugate(turns[:, above[below]]), turns[:, below]
    )
    return rotations.continuous(relative)
