"""Where the motions of a plan stand on a page: trees from left to right, a line for each leaf."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal

from characters.motion.trees.plan import KINDS, Machine, Node, Plan

Group = Literal["state", "mix", "layer", "change", "clip"]
"""What a box stands for."""

HIGH = 40.0
"""Height of a box [px]."""

LETTER, SMALL = 9.3, 6.5
"""Mean width of a letter of a title, 14 px and bold, and of a note, 11.5 px [px]."""

_ROW, _GAP = 54.0, 96.0  # [px]: from line to line, and between columns
_MIXES, _LAYERS = ("blend", "space", "plane", "crossfade", "schedule"), ("layer", "add")


@dataclass
class Box:
    """A node on the page."""

    title: str
    """Its name."""

    note: str
    """What it does."""

    group: Group
    """What it stands for."""

    label: str = ""
    """On the line that leads to it."""

    children: list["Box"] = field(default_factory=list)
    """What it is made of."""

    seen: bool = False
    """Whether it was drawn before, and its children there."""

    x: float = 0.0
    """Of its left side [px]."""

    y: float = 0.0
    """Of its upper side [px]."""

    @property
    def width(self) -> float:
        """Width [px]."""
        return 24 + max(LETTER * len(self.title), SMALL * len(self.note), 40.0)

    def everyone(self) -> Iterator["Box"]:
        """Yield this box and all below it."""
        yield self
        for child in self.children:
            yield from child.everyone()


def boxes_of(plan: Plan) -> list[Box]:
    """Return a tree of boxes for each state, or for the only motion, not placed yet."""
    drawn: set[int] = set()
    if plan.machine is None:
        return [_box(root, "", drawn) for root in plan.roots]
    return [_state(name, node, plan.machine, drawn) for name, node in plan.machine.states.items()]


def described(node: Node) -> str:
    """Return what a node does, in a few words."""
    said = {key: value for key, value in node.said.items() if value not in ("", None)}
    by = said.get("by")
    if node.kind == "space":
        return f"over {by}"
    if node.kind == "plane":
        return f"over {by[0]} and {by[1]}" if by else "plane"
    if node.kind == "clip":
        return "clip"
    usual = KINDS[node.kind].optional
    told = [
        f"{key.removesuffix('_deg')} {plain(value)}"
        for key, value in said.items()
        if key not in usual or usual[key] != value
    ]
    return " ".join([node.kind, *told])


def plain(value: object) -> str:
    """Return a value as it is read best."""
    if isinstance(value, float):
        return f"{value:g}".replace("-", "−")
    if isinstance(value, tuple):
        return ", ".join(map(plain, value))
    return str(value)


def _box(node: Node, label: str, drawn: set[int]) -> Box:
    seen = id(node) in drawn and bool(node.children)
    drawn.add(id(node))
    group: Group = "mix" if node.kind in _MIXES else "layer" if node.kind in _LAYERS else "change"
    box = Box(
        title=node.name or node.kind,
        note=described(node),
        group="clip" if node.kind == "clip" else group,
        label=label,
        seen=seen,
    )
    if seen:
        return box
    for key, child in node.motions.items():
        box.children.append(_box(child, "" if key == "of" else key, drawn))
    for row in node.rows:
        at = row.said.get("value", row.said.get("weight", ""))
        text = f"{plain(row.said['start'])} s" if "start" in row.said else plain(at)
        box.children.append(_box(row.motion, text, drawn))
    return box


def _state(name: str, node: Node, machine: Machine, drawn: set[int]) -> Box:
    note = "first state" if name == machine.start else "state"
    return Box(name, note, "state", children=[_box(node, "", drawn)])


def place(roots: Sequence[Box], left: float, top: float) -> float:
    """Give every box its place and return where the lowest one ends [px]."""
    columns: dict[int, float] = {}

    def measure(box: Box, depth: int) -> None:
        columns[depth] = max(columns.get(depth, 0.0), box.width)
        for child in box.children:
            measure(child, depth + 1)

    for root in roots:
        measure(root, 0)
    starts = {0: left}
    for depth in range(1, len(columns)):
        starts[depth] = starts[depth - 1] + columns[depth - 1] + _GAP
    line = top

    def put(box: Box, depth: int) -> None:
        nonlocal line
        box.x = starts[depth]
        if not box.children:
            box.y, line = line, line + _ROW
            return
        for child in box.children:
            put(child, depth + 1)
        box.y = (box.children[0].y + box.children[-1].y) / 2

    for root in roots:
        put(root, 0)
        line += 12
    return line
