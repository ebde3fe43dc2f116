"""Plain skeletons: whole limbs for all; for bodies without clips, toes and bones without scales.

Rigs for inverse kinematics often have the feet below the armature, so that a foot stays where it is
while its shin swings. Its own clips move both; whatever else moves the shin tears them apart.
"""

from dataclasses import replace

import numpy as np

from cubeling.characters.ik.legs import find_legs
from cubeling.characters.model.character import Character
from cubeling.characters.model.limb_ends import with_more_joints
from cubeling.characters.retargeting.feet.leg_ik import place_ankle
from cubeling.characters.retargeting.measures import foot_gap
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.detached import leaders_of_detached
from cubeling.characters.skeleton.pose import Pose, Skeleton

_MAX_UNEVEN = 1e-3  # of scales along three axes
_MAX_GAP = 0.001  # between shin and foot, in parts of the leg: nobody sees it


def with_attached_limbs(character: Character) -> Character:
    """Return a character whose detached parts move with their limbs.

    Nothing moves at rest and in its own clips. A character whose parts are all below their limbs is
    returned as it is.
    """
    skeleton = character.skeleton
    leaders = leaders_of_detached(skeleton, character.anatomy)
    if not leaders:
        return character
    parents = [leaders.get(joint, parent) for joint, parent in enumerate(skeleton.parents)]
    order = _parents_first(parents)
    number = {old: new for new, old in enumerate(order)} | {-1: -1}
    rest = _led(skeleton.rest, skeleton, leaders, order)
    places_of_old = np.array([number[joint] for joint in range(len(skeleton))])
    return replace(
        character,
        skeleton=Skeleton(
            tuple(skeleton.names[joint] for joint in order),
            tuple(number[parents[joint]] for joint in order),
            rest,
        ),
        clips={
            name: replace(clip, poses=_led(clip.poses, skeleton, leaders, order))
            for name, clip in character.clips.items()
        },
        meshes=tuple(
            replace(
                mesh,
                joints=places_of_old[mesh.joints].astype(mesh.joints.dtype),
                inverse_bind=mesh.inverse_bind[order],
            )
            for mesh in character.meshes
        ),
    )


def with_whole_limbs(character: Character) -> Character:
    """Return a character with clips whose legs reach their detached feet, and then lead them.

    Where a leg of a clip ends elsewhere, the knee bends so that it ends at the foot, or the foot is
    where the stretched leg ends. A character whose parts are all below their limbs is returned as
    it is.
    """
    if not leaders_of_detached(character.skeleton, character.anatomy):
        return character
    rig = Rig(character.skeleton, character.anatomy)
    clips = {
        name: replace(clip, poses=_with_reached_feet(clip.poses, rig))
        for name, clip in character.clips.items()
    }
    return with_attached_limbs(replace(character, clips=clips))


def _with_reached_feet(poses: Pose, rig: Rig) -> Pose:
    """Return poses (frames, …) in which detached feet are where their legs end."""
    for leg in rig.legs:
        if not leg.attached and foot_gap(poses, rig, [leg]) > _MAX_GAP:
            feet = rig.placements(poses, [leg.foot])[:, leg.foot, :3, 3]
            poses = place_ankle(poses, rig, leg, feet)
    return poses


def without_rest_scales(character: Character) -> Character:
    """Return a character without clips whose joints have no scales: its bones are as long as seen.

    Legs with scales cannot be bent to hold their feet. Scales that differ by axis, and those of a
    body with springs, whose sizes they would change, stay.
    """
    skeleton = character.skeleton
    if skeleton.rest.scales is None or character.springs:
        return character
    places = skeleton.rest.globals(skeleton)
    sizes = np.linalg.norm(places[:, :3, :3], axis=1)
    if np.ptp(sizes, axis=1).max() > _MAX_UNEVEN * sizes.max() or sizes.min() <= 0.0:
        return character
    size = sizes.mean(1)
    above = np.array([1.0 if parent < 0 else size[parent] for parent in skeleton.parents])
    rest = Pose(
        skeleton.rest.translations * above[:, None],
        skeleton.rest.rotations,
        None,
        skeleton.rest.morphs,
    )
    enlarge = np.tile(np.eye(4), (len(size), 1, 1))
    enlarge[:, :3, :3] *= size[:, None, None]
    return replace(
        character,
        skeleton=replace(skeleton, rest=rest),
        meshes=tuple(
            replace(mesh, inverse_bind=enlarge @ mesh.inverse_bind) for mesh in character.meshes
        ),
    )


def with_toe_ends(character: Character) -> Character:
    """Return a person without clips whose feet end in toes, so that legs can hold them in place.

    A foot without such a joint gets one where its sole rolls, which moves no skin.
    """
    skeleton = character.skeleton
    if character.anatomy.kind != "humanoid" or find_legs(skeleton) is not None:
        return character
    rig, rest = Rig(skeleton, character.anatomy, character.meshes), skeleton.rest
    places, back = rest.globals(skeleton), rotations.conjugate(rig.common_from_skeleton)
    feet = {
        f"{rig.anatomy.parts[leg.foot].removesuffix('Foot')}Toes": leg
        for leg in rig.legs
        if leg.toes is None
    }
    if not feet or rest.scales is not None or feet.keys() & {*skeleton.names}:
        return character
    offsets = [
        places[leg.foot, :3, :3].T @ rotations.rotate(back, rig.sole(leg).ball)
        for leg in feet.values()
    ]
    parents = [leg.foot for leg in feet.values()]
    longer, meshes = with_more_joints(
        skeleton, character.meshes, [*feet], parents, np.array(offsets)
    )
    return replace(character, skeleton=longer, meshes=meshes)


def _parents_first(parents: list[int]) -> list[int]:
    """Return the joints in an order in which parents come before their children."""
    order: list[int] = []
    done = {-1}
    while len(order) < len(parents):
        ready = [j for j, parent in enumerate(parents) if j not in done and parent in done]
        # One at a time from the front keeps the order of the file where it can.
        order.append(ready[0])
        done.add(ready[0])
    return order


def _led(poses: Pose, skeleton: Skeleton, leaders: dict[int, int], order: list[int]) -> Pose:
    """Return poses (…, joints) that look the same, with joints below their leaders, in an order."""
    places = poses.globals(skeleton)
    translations, turns = poses.translations.copy(), poses.rotations.copy()
    scales = None if poses.scales is None else poses.scales.copy()
    for joint, leader in leaders.items():
        local = np.linalg.inv(places[..., leader, :, :]) @ places[..., joint, :, :]
        sizes = np.linalg.norm(local[..., :3, :3], axis=-2)
        translations[..., joint, :] = local[..., :3, 3]
        turned = local[..., :3, :3] / np.maximum(sizes, 1e-12)[..., None, :]
        turns[..., joint, :] = rotations.from_matrix(turned)
        if scales is not None:
            scales[..., joint, :] = sizes
    return Pose(
        translations[..., order, :],
        turns[..., order, :],
        None if scales is None else scales[..., order, :],
        poses.morphs,
    )
