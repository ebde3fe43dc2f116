"""Spring bones: the extension VRMC_springBone of VRM 1.0, "secondaryAnimation" of VRM 0.x."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cubeling.characters.formats.gltf.document import Json, error_context, present
from cubeling.characters.formats.gltf.file import GltfFile
from cubeling.characters.formats.gltf.nodes import NodeTree
from cubeling.characters.model.springs import (
    LEAF_LENGTH_M,
    Point,
    SpringBone,
    SpringCollider,
    tail_of,
)

_DEFAULT_DRAG = 0.5
_LEAST_LENGTH_M = 1e-5  # of a bone; a shorter one has no direction


@dataclass(frozen=True)
class _Collider:
    """A collider of a node."""

    node: int
    """Number of the node; there may be no such node, which means no collider."""

    start: Point
    """Centre, or one end of the axis, in the node's frame [m]."""

    end: Point
    """The other end of the axis."""

    radius: float
    """Its radius [m]."""


_NO_COLLIDER = _Collider(-1, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0)


@dataclass(frozen=True)
class _Spring:
    """A node that swings; the numbers are those of `SpringBone`."""

    node: int
    tail: int | None
    """The node at its end; None to go on as the node lies from its parent."""
    stiffness: float
    drag: float
    gravity: Point
    radius: float
    colliders: tuple[_Collider, ...]
    center: int | None


@dataclass(frozen=True)
class VrmSprings:
    """The spring bones of a file, by numbers of nodes."""

    springs: tuple[_Spring, ...] = ()
    """The nodes that swing."""

    @property
    def nodes(self) -> set[int]:
        """All nodes on which they depend; they must be joints."""
        found: set[int] = set()
        for spring in self.springs:
            found |= {spring.node, *(each.node for each in spring.colliders)}
            found |= {node for node in (spring.tail, spring.center) if node is not None}
        return found

    def bones(self, tree: NodeTree) -> tuple[SpringBone, ...]:
        """Return them as spring bones of a skeleton; the first of a joint counts."""
        skeleton, joint_of = tree.skeleton, tree.joint_of_node
        names = {node: skeleton.names[joint] for node, joint in joint_of.items()}
        character_from_joint = skeleton.rest.globals(skeleton)
        bones: dict[str, SpringBone] = {}
        for spring in self.springs:
            joint = joint_of[spring.node]
            tail = tail_of(skeleton, joint, leaf_length=LEAF_LENGTH_M)
            if spring.tail is not None:
                with error_context(f"the spring bone {names[spring.node]!r}"):
                    end = character_from_joint[joint_of[spring.tail], :, 3]
                    x, y, z, _ = np.linalg.solve(character_from_joint[joint], end).tolist()
                tail = x, y, z
            name = names[spring.node]
            if np.linalg.norm(tail) < _LEAST_LENGTH_M or name in bones:
                continue
            bones[name] = SpringBone(
                name,
                tail,
                max(spring.stiffness, 0.0),
                min(max(spring.drag, 0.0), 1.0),
                spring.gravity,
                max(spring.radius, 0.0),
                tuple(
                    SpringCollider(names[each.node], each.start, each.end, each.radius)
                    for each in spring.colliders
                ),
                None if spring.center is None else names[spring.center],
            )
        return tuple(bones.values())


def read_springs(file: GltfFile) -> VrmSprings:
    """Return the spring bones of a file; none without them."""
    extensions = file.document.get("extensions", {})
    if "VRMC_springBone" in extensions:
        with error_context("VRMC_springBone"):
            return VrmSprings(tuple(_springs_1(file, extensions["VRMC_springBone"])))
    if "VRM" in extensions:
        with error_context("VRM.secondaryAnimation"):
            return VrmSprings(tuple(_springs_0(file, extensions["VRM"])))
    return VrmSprings()


def _springs_1(file: GltfFile, extension: Json) -> list[_Spring]:
    nodes = len(file.all("nodes"))
    colliders = [_collider_1(each) for each in extension.get("colliders", ())]
    groups = [
        [colliders[n] for n in (group or {}).get("colliders", ()) if 0 <= n < len(colliders)]
        for group in extension.get("colliderGroups", ())
    ]
    springs: list[_Spring] = []
    for chain in present(extension, "springs"):
        own = _of_groups(groups, chain.get("colliderGroups", ()), nodes)
        joints = chain.get("joints", ())
        for joint, following in pairwise(joints):
            x, y, z = joint.get("gravityDir", (0.0, -1.0, 0.0))
            springs.append(
                _Spring(
                    joint["node"],
                    following["node"],
                    float(joint.get("stiffness", 1.0)),
                    float(joint.get("dragForce", _DEFAULT_DRAG)),
                    _scale((x, y, z), joint.get("gravityPower", 0.0)),
                    float(joint.get("hitRadius", 0.0)),
                    own,
                    _node(chain.get("center"), nodes),
                )
            )
    return springs


def _collider_1(collider: Json | None) -> _Collider:
    if collider is None:
        return _NO_COLLIDER
    shape = collider["shape"]
    ball = shape.get("sphere") or shape.get("capsule") or {}
    x, y, z = ball.get("offset", (0.0, 0.0, 0.0))
    end_x, end_y, end_z = ball.get("tail", (x, y, z)) if "sphere" not in shape else (x, y, z)
    radius = float(ball.get("radius", 0.0))
    return _Collider(collider["node"], (x, y, z), (end_x, end_y, end_z), radius)


def _springs_0(file: GltfFile, extension: Json) -> list[_Spring]:
    nodes = file.all("nodes")
    animation = extension.get("secondaryAnimation", {})
    groups = [_colliders_0(group or {}) for group in animation.get("colliderGroups", ())]
    springs: list[_Spring] = []
    for group in present(animation, "boneGroups"):
        own = _of_groups(groups, group.get("colliderGroups", ()), len(nodes))
        # Its coordinates are those of Unity, where characters face +z and their left is −x.
        down = group.get("gravityDir", {"y": -1.0})
        gravity = -down.get("x", 0.0), down.get("y", 0.0), down.get("z", 0.0)
        for node in _with_descendants(group.get("bones", ()), nodes):
            springs.append(
                _Spring(
                    node,
                    next(iter(nodes[node].get("children", ())), None),
                    float(group.get("stiffiness", 1.0)),
                    float(group.get("dragForce", _DEFAULT_DRAG)),
                    _scale(gravity, group.get("gravityPower", 0.0)),
                    float(group.get("hitRadius", 0.0)),
                    own,
                    _node(group.get("center"), len(nodes)),
                )
            )
    return springs


def _colliders_0(group: Json) -> list[_Collider]:
    colliders = []
    for collider in present(group, "colliders"):
        offset = collider.get("offset", {})
        # Unity's z is the other way round.
        center = offset.get("x", 0.0), offset.get("y", 0.0), -offset.get("z", 0.0)
        radius = float(collider.get("radius", 0.0))
        colliders.append(_Collider(group.get("node", -1), center, center, radius))
    return colliders


def _with_descendants(roots: Sequence[int], nodes: Sequence[Json]) -> list[int]:
    """Return nodes and all below them; numbers without a node are left out."""
    found = [root for root in dict.fromkeys(roots) if 0 <= root < len(nodes)]
    seen = set(found)
    for node in found:
        below = [child for child in nodes[node].get("children", ()) if child not in seen]
        seen |= set(below)
        found += below
    return found


def _of_groups(
    groups: Sequence[Sequence[_Collider]], wanted: Sequence[int], nodes: int
) -> tuple[_Collider, ...]:
    """Return the colliders of some groups; numbers that do not exist are left out."""
    found = [each for index in wanted if 0 <= index < len(groups) for each in groups[index]]
    return tuple(each for each in found if 0 <= each.node < nodes)


def _node(number: int | None, nodes: int) -> int | None:
    return number if number is not None and 0 <= number < nodes else None


def _scale(direction: Point, length: float) -> Point:
    x, y, z = direction
    return x * length, y * length, z * length
