"""Constraints of nodes: the extension VRMC_node_constraint of VRM 1.0."""

from dataclasses import dataclass, replace

from characters.formats.gltf.document import DamagedFileError, Json, error_context, label
from characters.formats.gltf.file import GltfFile
from characters.formats.gltf.nodes import NodeTree
from characters.model.constraints import JointConstraint, constraint_levels
from characters.model.springs import Point

_AXES: dict[str, Point] = {
    "X": (1.0, 0.0, 0.0),
    "Y": (0.0, 1.0, 0.0),
    "Z": (0.0, 0.0, 1.0),
    "PositiveX": (1.0, 0.0, 0.0),
    "NegativeX": (-1.0, 0.0, 0.0),
    "PositiveY": (0.0, 1.0, 0.0),
    "NegativeY": (0.0, -1.0, 0.0),
    "PositiveZ": (0.0, 0.0, 1.0),
    "NegativeZ": (0.0, 0.0, -1.0),
}


@dataclass(frozen=True)
class VrmConstraints:
    """The constraints of a file."""

    constraints: tuple[JointConstraint, ...] = ()
    """They name nodes instead of joints."""

    @property
    def nodes(self) -> set[int]:
        """All nodes that they name; they must be joints."""
        return {node for each in self.constraints for node in (each.joint, each.source)}

    def of_joints(self, tree: NodeTree) -> tuple[JointConstraint, ...]:
        """Return them for the joints of a skeleton; refuse circles."""
        joint_of = tree.joint_of_node
        found = tuple(
            replace(each, joint=joint_of[each.joint], source=joint_of[each.source])
            for each in self.constraints
        )
        with error_context("VRMC_node_constraint"):
            constraint_levels(tree.skeleton, found)
        return found


def read_constraints(file: GltfFile) -> VrmConstraints:
    """Return the constraints of a file; none without them."""
    found = []
    for number, node in enumerate(file.all("nodes")):
        extension = node.get("extensions", {}).get("VRMC_node_constraint")
        if extension is not None:
            with error_context(f"constraint of {label('node', number, node)}"):
                found.append(_constraint(number, extension["constraint"]))
    return VrmConstraints(tuple(found))


def _constraint(node: int, stated: Json) -> JointConstraint:
    if "roll" in stated:
        roll = stated["roll"]
        return JointConstraint("roll", node, roll["source"], _axis(roll["rollAxis"]), _weight(roll))
    if "aim" in stated:
        aim = stated["aim"]
        return JointConstraint("aim", node, aim["source"], _axis(aim["aimAxis"]), _weight(aim))
    if "rotation" in stated:
        copied = stated["rotation"]
        return JointConstraint("rotation", node, copied["source"], weight=_weight(copied))
    raise DamagedFileError("is neither roll, aim nor rotation")


def _axis(name: str) -> Point:
    if name not in _AXES:
        raise DamagedFileError(f"{name!r:.20} is no axis")
    return _AXES[name]


def _weight(stated: Json) -> float:
    return min(max(float(stated.get("weight", 1.0)), 0.0), 1.0)
