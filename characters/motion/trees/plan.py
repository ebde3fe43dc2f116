"""Plans: descriptions of blend trees and state machines, as read from a file and checked."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

from cubeling.characters.motion.trees.conditions import Condition

PARAMETERS: Mapping[str, str] = {
    "speed": "requested Speed of AvatAR, 0 to 5; 0 after arrival",
    "angular": "twice the angle to the target, −90 to 90 degrees, to the right",
    "distance": "distance of the target, in metres of the character",
    "bearing": "direction of the point to look at, −180 to 180 degrees, to the left",
    "weight": "intensity of the action, −1 to 1",
}
"""Parameters of trees; their values follow from each command."""

Field = Literal["motion", "number", "numbers", "weight", "mask", "name", "names", "flag", "shape"]
"""Type of a field of a node; "weight" is a number or the name of a parameter."""

Group = Literal["clip", "mix", "layer", "modifier"]
"""What a kind of node does with its motions."""


@dataclass(frozen=True)
class NodeKind:
    """The fields that nodes of a kind have."""

    fields: Mapping[str, Field]
    """Fields of the node."""

    rows: str = ""
    """Name of the field with a list of tables, one for each motion; "" if there is none."""

    row_fields: Mapping[str, Field] = field(default_factory=dict)
    """Fields of each of these tables, besides `motion`."""

    optional: Mapping[str, object] = field(default_factory=dict)
    """Default values of optional fields, of nodes and of rows."""

    group: Group = "modifier"
    """What it does with its motions."""


_LAYER_KIND = NodeKind(
    {"base": "motion", "over": "motion", "mask": "mask", "weight": "weight"},
    optional={"mask": "", "weight": 1.0},
    group="layer",
)

NODE_KINDS: Mapping[str, NodeKind] = {
    "clip": NodeKind({"clip": "name"}, group="clip"),
    "hold": NodeKind({"of": "motion", "at": "number"}, optional={"at": 0.0}),
    "stretch": NodeKind({"of": "motion", "seconds": "number"}),
    "window": NodeKind(
        {"of": "motion", "start": "number", "end": "number"}, optional={"start": 0.0}
    ),
    "loop": NodeKind({"of": "motion"}),
    "mirror": NodeKind({"of": "motion"}),
    "displace": NodeKind(
        {"of": "motion", "x": "number", "z": "number", "yaw_deg": "number"},
        optional={"x": 0.0, "z": 0.0, "yaw_deg": 0.0},
    ),
    "warp": NodeKind({"of": "motion", "times": "numbers", "sources": "numbers"}),
    "pace": NodeKind(
        {"of": "motion", "rate": "number", "stride": "number"},
        optional={"rate": 1.0, "stride": 1.0},
    ),
    "blend": NodeKind({}, "of", {"weight": "number"}, group="mix"),
    "space": NodeKind({"by": "name"}, "at", {"value": "number"}, group="mix"),
    "plane": NodeKind({"by": "names"}, "at", {"value": "numbers"}, group="mix"),
    "layer": _LAYER_KIND,
    "add": _LAYER_KIND,
    "crossfade": NodeKind(
        {
            "first": "motion",
            "second": "motion",
            "start": "number",
            "seconds": "number",
            "shape": "shape",
        },
        optional={"seconds": 0.25, "shape": "gonio"},
        group="mix",
    ),
    "schedule": NodeKind(
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
        group="mix",
    ),
}
"""All kinds of nodes. `cubeling.characters.motion.trees.building` builds a motion for each."""


@dataclass(frozen=True)
class Row:
    """One of several motions of a node."""

    motion: "Node"

    fields: Mapping[str, Any]
    """Its other fields, such as "value" or "weight"."""


@dataclass(frozen=True)
class Node:
    """A motion in a plan."""

    kind: str
    """One of `NODE_KINDS`."""

    path: str
    """Its place in the file, such as "motions.walk.at[2].motion"."""

    name: str = ""
    """Its name in the file, or "" for a motion that is defined where it is used."""

    fields: Mapping[str, Any] = field(default_factory=dict)
    """Its fields that are not motions."""

    motions: Mapping[str, "Node"] = field(default_factory=dict)
    """Its fields that are motions."""

    rows: tuple[Row, ...] = ()
    """Its list of motions."""

    @property
    def children(self) -> tuple["Node", ...]:
        """The motions that it uses."""
        return (*self.motions.values(), *(row.motion for row in self.rows))

    @property
    def labels(self) -> tuple[str, ...]:
        """The role of each of the `children`, such as "base", "2.75" or "0.5 s"; "" if trivial."""
        return (
            *("" if key == "of" else key for key in self.motions),
            *(_row_label(row.fields) for row in self.rows),
        )

    @property
    def group(self) -> Group:
        """What it does with its motions."""
        return NODE_KINDS[self.kind].group

    @property
    def description(self) -> str:
        """Kind and fields in a few words, without fields of default value."""
        if "by" in self.fields:
            by = self.fields["by"]
            return "over " + (by if isinstance(by, str) else " and ".join(by))
        if self.kind == "clip":
            return "clip"
        defaults = NODE_KINDS[self.kind].optional
        fields = [
            f"{key.removesuffix('_deg')} {_format(value)}"
            for key, value in self.fields.items()
            if value not in ("", None) and (key not in defaults or defaults[key] != value)
        ]
        return " ".join([self.kind, *fields])

    @cached_property
    def size(self) -> int:
        """Number of motions in it and itself, each counted as often as it is used."""
        return 1 + sum(child.size for child in self.children)

    @property
    def parametric(self) -> bool:
        """Whether it depends on a parameter, itself or through its motions."""
        own = "by" in self.fields or isinstance(self.fields.get("weight"), str)
        return own or any(child.parametric for child in self.children)


@dataclass(frozen=True)
class StateTransition:
    """A transition from one state to another."""

    start: str
    """The state that it leaves; "*" for any."""

    end: str
    """The state that it enters."""

    when: Condition

    seconds: float
    """Its length [s]."""

    crossfade: bool = False
    """Whether both states play and are mixed; otherwise inertialization is used."""


@dataclass(frozen=True)
class StateGraph:
    """States and transitions of a state machine."""

    states: Mapping[str, Node]
    """The motion of each state."""

    start: str
    """Name of the state that it begins in."""

    transitions: tuple[StateTransition, ...]
    """Tried in this order."""


@dataclass(frozen=True)
class MaskPlan:
    """Arguments of `mask_of`: the joints that a layer moves."""

    subtrees: Mapping[str, float]
    """Weight of a joint and all its descendants."""

    joints: Mapping[str, float]
    """Weight of a joint alone."""

    default: float
    """Weight of all other joints."""


@dataclass(frozen=True)
class Plan:
    """How the motions of a character are composed: of one motion, or of states."""

    source: str
    """The file it is from, for messages."""

    root: Node | None
    """The only motion; None if there is a state graph."""

    machine: StateGraph | None
    """The state graph; None if there is only one motion."""

    masks: Mapping[str, MaskPlan] = field(default_factory=dict)
    """Masks of joints by the name that layers use."""

    lags: Mapping[str, float] = field(default_factory=dict)
    """Time constants of parameters by name [s]; defaults are
    `cubeling.characters.control.controllers.tree.DEFAULT_LAGS_S`."""

    @property
    def roots(self) -> tuple[Node, ...]:
        """The motions that no other motion uses."""
        states = () if self.machine is None else tuple(self.machine.states.values())
        return (*(() if self.root is None else (self.root,)), *states)


def _row_label(fields: Mapping[str, Any]) -> str:
    """Return the position, start or weight of a row's motion."""
    if "start" in fields:
        return f"{_format(fields['start'])} s"
    return _format(fields.get("value", fields.get("weight", "")))


def _format(value: object) -> str:
    if isinstance(value, float):
        return f"{value:g}".replace("-", "−")
    if isinstance(value, tuple):
        return ", ".join(map(_format, value))
    return str(value)
