"""Plain skeletons for bodies without clips: whole limbs, with toes, and bones without scales.

Rigs for inverse kinematics often have the feet below the armature, so that a foot stays where it is
while its shin swings. A body without clips of its own does not need that.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from cubeling.characters.ik.legs import find_legs
from cubeling.characters.model.character import Character
from cubeling.characters.model.limb_ends import with_more_joints
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

_LIMBS = (
    *(("Foot", ("LowerLeg",)), ("FrontFoot", ("FrontLowerLeg",)), ("Hand", ("LowerArm",))),
    *(("Toes", ("Foot",)), ("FrontToes", ("FrontFoot",))),
)
_MAX_UNEVEN = 1e-3  # of scales along three axes
_TRUNK = ("neck", "upperChest", "chest", "spine", "hips")


def with_attached_limbs(character: Character) -> Character:
    """Return a character without clips whose detached parts move with their limbs.

    Nothing moves at rest. A character whose parts are all below their limbs is returned as it is.
    """
    skeleton = character.skeleton
    leaders = dict(_leaders(skeleton, character.anatomy))
    if not leaders:
        return character
    parents = [leaders.get(joint, parent) for joint, parent in enumerate(skeleton.parents)]
    order = _parents_first(parents)
    number = {old: new for new, old in enumerate(order)} | {-1: -1}
    places = skeleton.rest.globals(skeleton)
    rest = _with_local_placements(skeleton.rest, places, leaders)
    places_of_old = np.array([number[joint] for joint in range(len(skeleton))])
    return replace(
        character,
        skeleton=Skeleton(
            tuple(skeleton.names[joint] for joint in order),
            tuple(number[parents[joint]] for joint in order),
            Pose(
                rest.translations[order],
                rest.rotations[order],
                None if rest.scales is None else rest.scales[order],
                rest.morphs,
            ),
        ),
        meshes=tuple(
            replace(
                mesh,
                joints=places_of_old[mesh.joints].astype(mesh.joints.dtype),
                inverse_bind=mesh.inverse_bind[order],
            )
            for mesh in character.meshes
        ),
    )


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


def _leaders(skeleton: Skeleton, anatomy: Anatomy) -> Iterator[tuple[int, int]]:
    """Yield each detached joint and the joint that is to lead it."""
    joints, parents = anatomy.joints, [*skeleton.parents]

    def with_ancestors(joint: int) -> Iterator[int]:
        while joint >= 0:
            yield joint
            joint = parents[joint]

    wanted = [(s + part, tuple(s + a for a in above)) for part, above in _LIMBS for s in SIDES]
    wanted += [("head", _TRUNK), *((f"{side}Eye", ("head",)) for side in SIDES)]
    for part, above in wanted:
        joint = joints.get(part)
        leader = next((joints[name] for name in above if name in joints), None)
        if joint is None or leader is None or leader in with_ancestors(joint):
            continue
        if joint not in with_ancestors(leader):  # else it would lead itself
            parents[joint] = leader  # the next ones see it, or two could lead each other
            yield joint, leader


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


def _with_local_placements(rest: Pose, places: Array, leaders: dict[int, int]) -> Pose:
    """Return a rest pose in which joints are placed relative to their leaders."""
    translations, turns, scales = rest.translations.copy(), rest.rotations.copy(), rest.scales
    scales = None if scales is None else scales.copy()
    for joint, leader in leaders.items():
        local = np.linalg.inv(places[leader]) @ places[joint]
        sizes = np.linalg.norm(local[:3, :3], axis=0)
        translations[joint] = local[:3, 3]
        turns[joint] = rotations.from_matrix(local[:3, :3] / np.maximum(sizes, 1e-12))
        if scales is not None:
            scales[joint] = sizes
    return replace(rest, translations=translations, rotations=turns, scales=scales)
