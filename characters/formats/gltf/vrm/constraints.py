"""Constraints of nodes: the extension VRMC_node_constraint of VRM 1.0."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from cubeling.characters.errors import CharacterError
from cubeling.characters.formats.gltf.document import DamagedFileError, Json, label
from cubeling.characters.formats.gltf.file import GltfFile
from cubeling.characters.formats.gltf.nodes import NodeTree
from cubeling.characters.model.constraints import ConstraintKind, JointConstraint, constraint_levels
from cubeling.characters.model.springs import Point

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


_AXIS_OF: dict[ConstraintKind, str] = {"roll": "rollAxis", "aim": "aimAxis", "rotation": ""}
"""Member with the axis of each kind."""


class _NodeConstraint(NamedTuple):
    """A constraint of a node; source is the number of a node, the rest as in `JointConstraint`."""

    kind: ConstraintKind
    source: int
    axis: Point
    weight: float


@dataclass(frozen=True)
class VrmConstraints:
    """The constraints of a file."""

    constraints: Mapping[int, _NodeConstraint]
    """Constraint by number of the node that it turns."""

    @property
    def nodes(self) -> set[int]:
        """All nodes that they name; they must be joints."""
        return set(self.constraints) | {each.source for each in self.constraints.values()}

    def of_joints(self, file: GltfFile, tree: NodeTree) -> tuple[JointConstraint, ...]:
        """Return them for the joints of a skeleton; none, with a warning, if they go in circles."""
        name_of = {node: tree.skeleton.names[joint] for node, joint in tree.joint_of_node.items()}
        found = tuple(
            JointConstraint(each.kind, name_of[node], name_of[each.source], each.axis, each.weight)
            for node, each in self.constraints.items()
        )
        try:
            constraint_levels(tree.skeleton, found)
        except CharacterError as error:
            file.warn(f"constraints of nodes: {error}; left them out")
            return ()
        return found


def read_constraints(file: GltfFile) -> VrmConstraints:
    """Return the constraints of a file; none without them."""
    found: dict[int, _NodeConstraint] = {}
    for number, node in enumerate(file.all("nodes")):
        extension = node.get("extensions", {}).get("VRMC_node_constraint")
        if extension is not None:
            try:
                found[number] = _constraint(extension["constraint"])
            except (DamagedFileError, KeyError) as error:
                where = f"the constraint of {label('node', number, node)}"
                file.warn(f"{where} is not as in the standard ({error}); left it out")
    return VrmConstraints(found)


def _constraint(stated: Json) -> _NodeConstraint:
    for kind, axis in _AXIS_OF.items():
        if kind in stated:
            own = stated[kind]
            weight = min(max(float(own.get("weight", 1.0)), 0.0), 1.0)
            direction = _axis(own[axis]) if axis else (0.0, 0.0, 0.0)
            return _NodeConstraint(kind, own["source"], direction, weight)
    raise DamagedFileError("is neither roll, aim nor rotation")


def _axis(name: str) -> Point:
    if name not in _AXES:
        raise DamagedFileError(f"{name!r:.20} is no axis")
    return _AXES[name]
