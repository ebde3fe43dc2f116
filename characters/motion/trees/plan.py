"""What a file says of how motions are put together: a tree of plain nodes, checked.

The kinds of nodes and what each may say stand in one table, `KINDS`. From it files are read and
checked, and diagrams drawn.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

from characters.motion.trees.conditions import Condition

PARAMETERS: Mapping[str, str] = {
    "speed": "AvatAR's Speed that is asked for, 0 to 5; 0 where it has arrived",
    "angular": "how far to the right of where it looks the target is, twice, −90 to 90 degrees",
    "distance": "to the target, in metres of the character",
    "bearing": "to the left of where it looks, −180 to 180 degrees: the point to look at",
    "weight": "intensity of the action, −1 to 1",
}
"""What steers a tree: numbers that follow from each command."""

Field = Literal["motion", "number", "numbers", "weight", "mask", "name", "names", "flag", "shape"]
"""What a field of a node holds; "weight" is a number or the name of a parameter."""


@dataclass(frozen=True)
class Kind:
    """What nodes of a kind may say."""

    fields: Mapping[str, Field]
    """Of the node."""

    rows: str = ""
    """Name of the field that holds a list of tables, one for each motion; "" if there is none."""

    row_fields: Mapping[str, Field] = field(default_factory=dict)
    """Of each of them, besides `motion`."""

    optional: Mapping[str, object] = field(default_factory=dict)
    """Fields that may be left out, with what they are then."""


KINDS: Mapping[str, Kind] = {
    "clip": Kind({"clip": "name"}),
    "hold": Kind({"of": "motion", "at": "number"}, optional={"at": 0.0}),
    "stretch": Kind({"of": "motion", "seconds": "number"}),
    "window": Kind({"of": "motion", "start": "number", "end": "number"}, optional={"start": 0.0}),
    "loop": Kind({"of": "motion"}),
    "mirror": Kind({"of": "motion"}),
    "displace": Kind(
        {"of": "motion", "x": "number", "z": "number", "yaw_deg": "number"},
        optional={"x": 0.0, "z": 0.0, "yaw_deg": 0.0},
    ),
    "warp": Kind({"of": "motion", "times": "numbers", "sources": "numbers"}),
    "pace": Kind(
        {"of": "motion", "rate": "number", "stride": "number"},
        optional={"rate": 1.0, "stride": 1.0},
    ),
    "blend": Kind({}, "of", {"weight": "number"}),
    "space": Kind({"by": "name"}, "at", {"value": "number"}),
    "plane": Kind({"by": "names"}, "at", {"value": "numbers"}),
    "layer": Kind(
        {"base": "motion", "over": "motion", "mask": "mask", "weight": "weight"},
        optional={"mask": "", "weight": 1.0},
    ),
    "add": Kind(
        {"base": "motion", "over": "motion", "mask": "mask", "weight": "weight"},
        optional={"mask": "", "weight": 1.0},
    ),
    "crossfade": Kind(
        {
            "first": "motion",
            "second": "motion",
            "start": "number",
            "seconds": "number",
            "shape": "shape",
        },
        optional={"seconds": 0.25, "shape": "gonio"},
    ),
    "schedule": Kind(
        {},
        "actions",
        {
            "start": "number",
            "weight": "number",
            "mask": "mask",
            "fade_in": "number",
            "fade_out": "number",
            "shape": "shape",
            "always": "flag",
        },
        {
            "start": 0.0,
            "weight": 1.0,
            "mask": "",
            "fade_in": 0.0,
            "fade_out": 0.0,
            "shape": "gonio",
            "always": False,
        },
    ),
}
"""Every kind of node. What stands in `optional` may be left out of nodes and of rows."""


@dataclass(frozen=True)
class Row:
    """One of several motions of a node."""

    motion: "Node"
    """What is played."""

    said: Mapping[str, Any]
    """What the row says of it."""


@dataclass(frozen=True)
class Node:
    """A motion in a plan."""

    kind: str
    """One of `KINDS`."""

    place: str
    """Where it stands in the file, as "motions.walk.at[2].motion"."""

    name: str = ""
    """What the file calls it; "" if it stands where it is used."""

    said: Mapping[str, Any] = field(default_factory=dict)
    """Its fields but for motions."""

    motions: Mapping[str, "Node"] = field(default_factory=dict)
    """Its fields that are motions."""

    rows: tuple[Row, ...] = ()
    """Its list of motions."""

    @property
    def children(self) -> tuple["Node", ...]:
        """What it is made of."""
        return (*self.motions.values(), *(row.motion for row in self.rows))

    @cached_property
    def size(self) -> int:
        """How many motions it is, itself and each in it counted as often as it is used."""
        return 1 + sum(child.size for child in self.children)

    @property
    def parametric(self) -> bool:
        """Whether a parameter changes it or something in it."""
        own = self.kind in ("space", "plane") or isinstance(self.said.get("weight"), str)
        return own or any(child.parametric for child in self.children)


@dataclass(frozen=True)
class Change:
    """A way from one state to another."""

    start: str
    """The state that is left; "*" for any."""

    end: str
    """The state that is entered."""

    when: Condition
    """What must hold."""

    seconds: float
    """How long it takes [s]."""

    crossfade: bool = False
    """Whether both play meanwhile and are mixed; else the new state takes over at once and what
    the two differ by fades (inertialisation)."""


@dataclass(frozen=True)
class Machine:
    """States and how they follow each other."""

    states: Mapping[str, Node]
    """What plays in each."""

    start: str
    """The first."""

    changes: tuple[Change, ...]
    """Tried in this order."""


@dataclass(frozen=True)
class MaskPlan:
    """Which joints a layer moves."""

    subtrees: Mapping[str, float]
    """Joint to the weight of it and all below."""

    joints: Mapping[str, float]
    """Joint to the weight of it alone."""

    default: float
    """Of all others."""


@dataclass(frozen=True)
class Plan:
    """How the motions of a character are put together."""

    source: str
    """The file that says so, for messages."""

    root: Node | None
    """What plays all the time; None where a machine does."""

    machine: Machine | None
    """What plays by states; None where one motion does."""

    masks: Mapping[str, MaskPlan] = field(default_factory=dict)
    """By name."""

    lags: Mapping[str, float] = field(default_factory=dict)
    """How slowly parameters follow [s]; of others `characters.control.tree.LAGS` says so."""

    @property
    def roots(self) -> tuple[Node, ...]:
        """Return the motions that nothing else is made of."""
        states = () if self.machine is None else tuple(self.machine.states.values())
        return (*(() if self.root is None else (self.root,)), *states)
