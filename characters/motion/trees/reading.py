"""Reads and checks plans from TOML; every message names the file and the place in it."""

from collections.abc import Collection, Mapping
from typing import get_args

from cubeling.characters.motion.curves import Ease
from cubeling.characters.motion.trees.conditions import Condition, ConditionError
from cubeling.characters.motion.trees.plan import (
    NODE_KINDS,
    PARAMETERS,
    Field,
    MaskPlan,
    Node,
    NodeKind,
    Plan,
    Row,
    StateGraph,
    StateTransition,
)
from cubeling.toml_file import TomlTable

STATE_VALUES = {"time": "since the state was entered [s]", "done": "whether its motion has ended"}
"""Values for conditions, besides the parameters and the action."""

MAX_MOTIONS, MAX_DEPTH = 1000, 30
"""Limits of a motion: its motions, counted as often as they are used, and the nesting depth.

Without them a few lines that use each other twice could exhaust the memory."""

PLAN_TABLES = ("masks", "parameters", "motions", "machine", "play")
"""The tables of a plan in a file."""


def read_plan(file: TomlTable, clips: Collection[str]) -> Plan | None:
    """Return the plan in a TOML file; None if there is none.

    `clips` are the names of the character's clips.

    Raises
    ------
    CharacterError
        If a part of it is invalid.
    """
    if not any(key in file for key in ("motions", "machine", "play")):
        return None
    return _PlanReader(file, clips).plan()


class _PlanReader:
    def __init__(self, file: TomlTable, clips: Collection[str]) -> None:
        self._file = file
        self._clips = clips
        self._motions = file.table("motions")
        self._masks = file.table("masks")
        self._reading: list[str] = []  # names of motions that are being read, to find cycles
        self._finished: dict[str, Node] = {}
        self._depth = 0  # nesting of the motion that is being read

    def plan(self) -> Plan:
        """Return the plan of the whole document, checked."""
        masks = {name: _mask(self._masks.table(name)) for name in self._masks}
        for name in self._motions:  # unused motions are checked too
            self._named_motion(self._motions, name, name)
        machine = self._state_graph() if "machine" in self._file else None
        root = self._motion(self._file, "play") if "play" in self._file else None
        if (root is None) == (machine is None):
            raise self._file.wrong("play", 'write either play = "a motion" or a [machine]')
        return Plan(self._file.source, root, machine, masks, _time_constants(self._file))

    def _state_graph(self) -> StateGraph:
        table = self._file.table("machine", "start", "states", "changes")
        motions = table.table("states")
        states = {name: self._motion(motions, name) for name in motions}
        if not states:
            raise table.wrong("states", 'name at least one state: idle = "a motion"')
        start = table.choice("start", states, next(iter(states)))
        changes = tuple(_transition(each, [*states]) for each in table.rows("changes"))
        return StateGraph(states, start, changes)

    def _motion(self, table: TomlTable, key: str) -> Node:
        if key not in table:
            raise table.unlike(key, "a motion or clip")
        if self._depth >= MAX_DEPTH:
            raise table.wrong(key, f"motions nest more than {MAX_DEPTH} deep; use fewer")
        self._depth += 1
        given = table.value(key)
        if not isinstance(given, str):
            node = self._node(table.table(key), "")
        elif given in self._motions:
            node = self._named_motion(table, key, given)
        else:
            name = table.choice(key, [*self._clips, *self._motions])
            node = Node("clip", table.at(key), name, {"clip": name})
        self._depth -= 1
        return node

    def _named_motion(self, table: TomlTable, key: str, name: str) -> Node:
        """Return one of the named motions, which a key names, and refuse cycles."""
        if name in self._reading:
            cycle = " -> ".join([*self._reading[self._reading.index(name) :], name])
            raise table.wrong(key, f"{cycle}: a motion cannot be made of itself")
        if name not in self._finished:
            self._reading.append(name)
            self._finished[name] = (
                self._motion(self._motions, name)
                if isinstance(self._motions.value(name), str)
                else self._node(self._motions.table(name), name)
            )
            self._reading.pop()
        return self._finished[name]

    def _node(self, table: TomlTable, name: str) -> Node:
        kind_name = table.choice("kind", NODE_KINDS)
        kind = NODE_KINDS[kind_name]
        table.only("kind", *kind.fields, *([kind.rows] if kind.rows else []))
        fields, motions = self._fields(table, kind.fields, kind.optional)
        rows = self._rows(table, kind) if kind.rows else ()
        node = Node(kind_name, table.place, name, fields, motions, rows)
        if node.size > MAX_MOTIONS:
            raise table.wrong("", f"made of more than {MAX_MOTIONS} motions; use fewer")
        return node

    def _rows(self, table: TomlTable, kind: NodeKind) -> tuple[Row, ...]:
        tables = table.rows(kind.rows, "motion", *kind.row_fields)
        if not tables:
            raise table.wrong(kind.rows, "give a list of one table for each motion")
        types: dict[str, Field] = {"motion": "motion", **kind.row_fields}
        rows = []
        for each in tables:
            fields, motions = self._fields(each, types, kind.optional)
            rows.append(Row(motions["motion"], fields))
        return tuple(rows)

    def _fields(
        self, table: TomlTable, types: Mapping[str, Field], optional: Mapping[str, object]
    ) -> tuple[dict[str, object], dict[str, Node]]:
        """Return the fields of a table that are not motions, and those that are."""
        fields: dict[str, object] = {}
        motions: dict[str, Node] = {}
        for key, kind in types.items():
            if key not in table and key in optional:
                fields[key] = optional[key]
            elif kind == "motion":
                motions[key] = self._motion(table, key)
            else:
                fields[key] = self._field(table, key, kind)
        return fields, motions

    def _field(self, table: TomlTable, key: str, kind: Field) -> object:
        """Return the value of a field that is not a motion."""
        match kind:
            case "number":
                return table.number(key)
            case "weight" if not isinstance(table.value(key), str):
                return table.number(key)
            case "numbers":
                return table.numbers(key)
            case "flag":
                return table.truth(key)
            case "names":
                return _two_parameters(table, key)
            case "mask":
                return table.choice(key, [*self._masks])
            case "shape":
                return table.choice(key, get_args(Ease))
            case "name" if key == "clip":
                return table.choice(key, self._clips)
            case _:
                return table.choice(key, PARAMETERS)


def _transition(table: TomlTable, states: Collection[str]) -> StateTransition:
    table.only("from", "to", "when", "seconds", "crossfade")
    start, end = table.choice("from", ["*", *states], "*"), table.choice("to", states)
    numbers = frozenset([*PARAMETERS, *STATE_VALUES])
    try:
        when = Condition.read(table.text("when"), frozenset({"action"}), numbers)
    except ConditionError as error:
        raise table.wrong("when", str(error)) from None
    seconds = table.number("seconds", 0.0, 10.0, 0.25)
    if seconds == 0.0:
        raise table.unlike("seconds", "more than 0 and at most 10")
    return StateTransition(start, end, when, seconds, table.truth("crossfade", False))


def _time_constants(file: TomlTable) -> dict[str, float]:
    tables = file.table("parameters", *PARAMETERS)
    return {name: tables.table(name, "lag").number("lag", 0.0, default=0.0) for name in tables}


def _mask(table: TomlTable) -> MaskPlan:
    table.only("subtrees", "joints", "default")
    subtrees, joints = (
        {name: weights.number(name) for name in weights}
        for weights in (table.table("subtrees"), table.table("joints"))
    )
    return MaskPlan(subtrees, joints, table.number("default", default=0.0))


def _two_parameters(table: TomlTable, key: str) -> tuple[str, ...]:
    names = table.texts(key)
    if len({*names}) != 2 or len(names) != 2 or not {*names} <= {*PARAMETERS}:
        raise table.unlike(key, f"two different parameters of {', '.join(PARAMETERS)}")
    return names
