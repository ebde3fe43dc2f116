"""Reads and checks plans from TOML; every message names the file and the place in it."""

import difflib
import math
from collections.abc import Collection, Mapping
from contextlib import suppress
from typing import Any, NoReturn, get_args

from cubeling.characters.errors import CharacterError
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

STATE_VALUES = {"time": "since the state was entered [s]", "done": "whether its motion has ended"}
"""Values for conditions, besides the parameters and the action."""

MAX_MOTIONS, MAX_DEPTH = 1000, 30
"""Limits of a motion: its motions, counted as often as they are used, and the nesting depth.

Without them a few lines that use each other twice could exhaust the memory."""

PLAN_TABLES = ("masks", "parameters", "motions", "machine", "play")
"""The tables of a plan in a file."""


def read_plan(document: Mapping[str, Any], source: str, clips: Collection[str]) -> Plan | None:
    """Return the plan in a parsed TOML document; None if there is none.

    `source` names the file in messages; `clips` are the names of the character's clips.

    Raises
    ------
    CharacterError
        If a part of it is invalid.
    """
    if not any(key in document for key in ("motions", "machine", "play")):
        return None
    return _PlanReader(document, source, clips).plan()


class _PlanReader:
    def __init__(self, document: Mapping[str, Any], source: str, clips: Collection[str]) -> None:
        self._document = document
        self._source = source
        self._clips = clips
        self._motions = self._table(document.get("motions", {}), "motions")
        self._masks = self._table(document.get("masks", {}), "masks")
        self._reading: list[str] = []  # names of motions that are being read, to find cycles
        self._finished: dict[str, Node] = {}
        self._depth = 0  # nesting of the motion that is being read

    def plan(self) -> Plan:
        """Return the plan of the whole document, checked."""
        masks = {name: self._mask(table, f"masks.{name}") for name, table in self._masks.items()}
        for name in self._motions:  # unused motions are checked too
            self._named_motion(name, f"motions.{name}")
        machine = self._state_graph() if "machine" in self._document else None
        root = None
        if "play" in self._document:
            root = self._motion(self._document["play"], "play")
        if (root is None) == (machine is None):
            self._refuse("play", 'write either play = "a motion" or a [machine]')
        return Plan(self._source, root, machine, masks, self._time_constants())

    def _state_graph(self) -> StateGraph:
        table = self._table(self._document["machine"], "machine")
        self._check_keys(table, ("start", "states", "changes"), "machine")
        states = {
            name: self._motion(each, f"machine.states.{name}")
            for name, each in self._table(table.get("states", {}), "machine.states").items()
        }
        if not states:
            self._refuse("machine.states", 'name at least one state: idle = "a motion"')
        start = table.get("start", next(iter(states)))
        self._check_choice(start, states, "machine.start", "state")
        changes = table.get("changes", [])
        if not isinstance(changes, list):
            self._refuse("machine.changes", "write each change as [[machine.changes]]")
        read = tuple(
            self._transition(each, states, f"machine.changes[{number}]")
            for number, each in enumerate(changes)
        )
        return StateGraph(states, start, read)

    def _transition(self, given: object, states: Mapping[str, Node], path: str) -> StateTransition:
        table = self._table(given, path)
        self._check_keys(table, ("from", "to", "when", "seconds", "crossfade"), path)
        for key in ("to", "when"):
            if key not in table:
                self._refuse(path, f"lacks {key!r}")
        start, end = table.get("from", "*"), table["to"]
        self._check_choice(start, ["*", *states], f"{path}.from", "state")
        self._check_choice(end, states, f"{path}.to", "state")
        if not isinstance(table["when"], str):
            self._refuse(f"{path}.when", 'write the condition as a text: "speed > 0.5"')
        numbers = frozenset([*PARAMETERS, *STATE_VALUES])
        try:
            when = Condition.read(table["when"], frozenset({"action"}), numbers)
        except ConditionError as error:
            self._refuse(f"{path}.when", str(error))
        seconds = self._number(table.get("seconds", 0.25), f"{path}.seconds")
        if not 0.0 < seconds <= 10.0:
            self._refuse(f"{path}.seconds", f"{seconds} s; give more than 0 and at most 10")
        crossfade = self._field(table.get("crossfade", False), "flag", f"{path}.crossfade")
        return StateTransition(start, end, when, seconds, bool(crossfade))

    def _time_constants(self) -> dict[str, float]:
        table = self._table(self._document.get("parameters", {}), "parameters")
        lags: dict[str, float] = {}
        for name, given in table.items():
            path = f"parameters.{name}"
            self._check_choice(name, PARAMETERS, path, "parameter")
            inner = self._table(given, path)
            self._check_keys(inner, ("lag",), path)
            lags[name] = self._number(inner.get("lag", 0.0), f"{path}.lag")
            if lags[name] < 0.0:
                self._refuse(f"{path}.lag", f"{lags[name]} s; give 0 or more")
        return lags

    def _mask(self, given: object, path: str) -> MaskPlan:
        table = self._table(given, path)
        self._check_keys(table, ("subtrees", "joints", "default"), path)
        subtrees, joints = (
            {
                name: self._number(weight, f"{path}.{key}.{name}")
                for name, weight in self._table(table.get(key, {}), f"{path}.{key}").items()
            }
            for key in ("subtrees", "joints")
        )
        default = self._number(table.get("default", 0.0), f"{path}.default")
        return MaskPlan(subtrees, joints, default)

    def _motion(self, given: object, path: str) -> Node:
        if self._depth >= MAX_DEPTH:
            self._refuse(path, f"motions nest more than {MAX_DEPTH} deep; use fewer")
        self._depth += 1
        if not isinstance(given, str):
            node = self._node(self._table(given, path), path, "")
        elif given in self._motions:
            node = self._named_motion(given, path)
        else:
            self._check_choice(given, [*self._clips, *self._motions], path, "motion or clip")
            node = Node("clip", path, given, {"clip": given})
        self._depth -= 1
        return node

    def _named_motion(self, name: str, path: str) -> Node:
        """Return one of the named motions, and refuse cycles."""
        if name in self._reading:
            cycle = " -> ".join([*self._reading[self._reading.index(name) :], name])
            self._refuse(path, f"{cycle}: a motion cannot be made of itself")
        if name not in self._finished:
            self._reading.append(name)
            where = f"motions.{name}"
            given = self._motions[name]
            self._finished[name] = (
                self._motion(given, where)
                if isinstance(given, str)
                else self._node(self._table(given, where), where, name)
            )
            self._reading.pop()
        return self._finished[name]

    def _node(self, table: Mapping[str, Any], path: str, name: str) -> Node:
        kind_name = table.get("kind")
        if kind_name is None:
            self._refuse(path, f"lacks kind; choose one of {', '.join(NODE_KINDS)}")
        self._check_choice(kind_name, NODE_KINDS, f"{path}.kind", "kind")
        kind = NODE_KINDS[kind_name]
        self._check_keys(table, ("kind", *kind.fields, *([kind.rows] if kind.rows else [])), path)
        fields, motions = self._fields(table, kind.fields, kind.optional, path)
        rows = self._rows(table, kind, path) if kind.rows else ()
        node = Node(kind_name, path, name, fields, motions, rows)
        if node.size > MAX_MOTIONS:
            self._refuse(path, f"made of more than {MAX_MOTIONS} motions; use fewer")
        return node

    def _rows(self, table: Mapping[str, Any], kind: NodeKind, path: str) -> tuple[Row, ...]:
        given = table.get(kind.rows)
        if not isinstance(given, list) or not given:
            self._refuse(f"{path}.{kind.rows}", "give a list of one table for each motion")
        rows = []
        for number, each in enumerate(given):
            where = f"{path}.{kind.rows}[{number}]"
            row = self._table(each, where)
            self._check_keys(row, ("motion", *kind.row_fields), where)
            types: dict[str, Field] = {"motion": "motion", **kind.row_fields}
            fields, motions = self._fields(row, types, kind.optional, where)
            rows.append(Row(motions["motion"], fields))
        return tuple(rows)

    def _fields(
        self,
        table: Mapping[str, Any],
        types: Mapping[str, Field],
        optional: Mapping[str, object],
        path: str,
    ) -> tuple[dict[str, object], dict[str, Node]]:
        """Return the fields of a table that are not motions, and those that are."""
        fields: dict[str, object] = {}
        motions: dict[str, Node] = {}
        for key, kind in types.items():
            if key not in table:
                if key not in optional:
                    self._refuse(path, f"lacks {key!r}")
                fields[key] = optional[key]
            elif kind == "motion":
                motions[key] = self._motion(table[key], f"{path}.{key}")
            else:
                fields[key] = self._field(table[key], kind, f"{path}.{key}")
        return fields, motions

    def _field(self, given: object, kind: Field, path: str) -> object:
        """Return the value of a field that is not a motion."""
        match kind:
            case "number":
                return self._number(given, path)
            case "weight" if not isinstance(given, str):
                return self._number(given, path)
            case "numbers":
                listed = given if isinstance(given, list) else self._refuse(path, "give a list")
                return tuple(self._number(each, f"{path}[{n}]") for n, each in enumerate(listed))
            case "flag":
                flag = isinstance(given, bool)
                return given if flag else self._refuse(path, "give true or false")
            case "names":
                return self._two_parameters(given, path)
            case "mask":
                self._check_choice(given, self._masks, path, "mask")
            case "shape":
                self._check_choice(given, get_args(Ease), path, "shape")
            case "name" if path.endswith(".clip"):
                self._check_choice(given, self._clips, path, "clip")
            case _:
                self._check_choice(given, PARAMETERS, path, "parameter")
        return given

    def _two_parameters(self, given: object, path: str) -> tuple[str, ...]:
        listed = given if isinstance(given, list) else self._refuse(path, "give two names")
        if len(listed) != 2 or listed[0] == listed[1]:
            self._refuse(path, "give two different parameters")
        for number, each in enumerate(listed):
            self._check_choice(each, PARAMETERS, f"{path}[{number}]", "parameter")
        return tuple(listed)

    def _number(self, given: object, path: str) -> float:
        if isinstance(given, (int, float)) and not isinstance(given, bool):
            with suppress(OverflowError):  # whole numbers in TOML may have any number of digits
                if math.isfinite(number := float(given)):
                    return number
        self._refuse(path, f"{_abbreviate(given)} is not a finite number")

    def _table(self, given: object, path: str) -> Mapping[str, Any]:
        if not isinstance(given, dict):
            self._refuse(path, f"{_abbreviate(given)} is not a table")
        return given

    def _check_keys(self, table: Mapping[str, Any], keys: Collection[str], path: str) -> None:
        for key in table:
            if key not in keys:
                self._check_choice(key, keys, path, "field")

    def _check_choice(self, given: object, choices: Collection[str], path: str, what: str) -> None:
        if isinstance(given, str) and given in choices:
            return
        near = difflib.get_close_matches(str(given), choices, 1)
        hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(choices) or 'none'}"
        self._refuse(path, f"no {what} {given!r}; {hint}")

    def _refuse(self, path: str, what: str) -> NoReturn:
        raise CharacterError(f"{self._source}: {path}: {what}")


def _abbreviate(given: object) -> str:
    text = repr(given)
    return text if len(text) <= 60 else text[:57] + "..."
