"""Constraints: joints that turn as others do, such as the twist bones of arms."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from cubeling.characters.errors import CharacterError
from cubeling.characters.model.springs import Point
from cubeling.characters.skeleton.pose import Skeleton

ConstraintKind = Literal["roll", "aim", "rotation"]
"""Turns about an axis as the source does; points with an axis to it; turns as it does."""


@dataclass(frozen=True)
class JointConstraint:
    """What another joint makes one do, as in the extension VRMC_node_constraint of glTF."""

    kind: ConstraintKind

    joint: str
    """Name of the joint that is turned."""

    source: str
    """Name of the joint that it follows."""

    axis: Point = (0.0, 0.0, 0.0)
    """Unit vector in the joint's frame, about which it rolls or with which it aims."""

    weight: float = 1.0
    """Part of the way from its rest pose, 0…1."""

    def with_names(self, names: Mapping[str, str]) -> "JointConstraint":
        """Return it for joints with new names, given by their old ones."""
        joint, source = (names.get(name, name) for name in (self.joint, self.source))
        return replace(self, joint=joint, source=source)


def constraint_levels(
    skeleton: Skeleton, constraints: Sequence[JointConstraint]
) -> list[list[JointConstraint]]:
    """Return constraints by the order in which they must be applied: those together that may be.

    Raises
    ------
    CharacterError
        If joints follow each other in a circle.
    """
    waiting, levels = list(constraints), []
    while waiting:
        pending = {each.joint for each in waiting}
        ready = [each for each in waiting if not _sources_of(skeleton, each) & pending]
        if not ready:
            names = ", ".join(sorted(pending))
            raise CharacterError(f"constraints of {names} follow each other; remove one of them")
        levels.append(ready)
        waiting = [each for each in waiting if each not in ready]
    return levels


def _sources_of(skeleton: Skeleton, constraint: JointConstraint) -> set[str]:
    """Return the joints whose turns a constraint needs."""
    if constraint.kind != "aim":
        return {constraint.source}
    ends = [skeleton.index(name) for name in (constraint.source, constraint.joint)]
    followed = {skeleton.names[joint] for joint in skeleton.with_ancestors(ends)}
    return followed - {constraint.joint}
