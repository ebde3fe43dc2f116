"""Parts of a body that its skeleton has elsewhere than at the ends of their limbs.

Rigs for inverse kinematics often have the feet below the armature.
"""

from collections.abc import Iterator

from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.pose import Skeleton

_LIMBS = (
    *(("Foot", ("LowerLeg",)), ("FrontFoot", ("FrontLowerLeg",)), ("Hand", ("LowerArm",))),
    *(("Toes", ("Foot",)), ("FrontToes", ("FrontFoot",))),
)
_TRUNK = ("neck", "upperChest", "chest", "spine", "hips")


def leaders_of_detached(skeleton: Skeleton, anatomy: Anatomy) -> dict[int, int]:
    """Return the joint that is to lead each detached one: the shin a foot, the forearm a hand."""
    joints, parents = anatomy.joints, [*skeleton.parents]
    leaders: dict[int, int] = {}

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
            leaders[joint] = leader
    return leaders
