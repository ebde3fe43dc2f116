"""From the TOML beside a character to a plan, checked: every complaint names file and place."""

import difflib
import math
from collections.abc import Collection, Mapping
from contextlib import suppress
from typing import Any, NoReturn, get_args

from characters.errors import CharacterError
from characters.motion.curves import Ease
from characters.motion.trees.conditions import Condition, ConditionError
from characters.motion.trees.plan import (
    KINDS,
    PARAMETERS,
    Change,
    Field,
    Kind,
    Machine,
    MaskPlan,
    Node,
    Plan,
    Row,
)

STATE_VALUES = {"time": "since the state was entered [s]", "done": "whether its motion has ended"}
"""What conditions may look at beside the parameters and the action."""

MOST_MOTIONS, DEEPEST = 1000, 30
"""Motions that one may be made of, counted as often as they are used, and how deep they nest:
a few lines that use each other twice would be more than fit in memory."""

TABLES = ("masks", "parameters", "motions", "machine", "play")
"""What a plan consists of in a file."""


def read_plan(document: Mapping[str, Any], source: str, clips: Collection[str]) -> Plan | None:
    """Return the plan in a document; None if there is none.

    Parameters
    ----------
    document
        As `tomllib` gives it.
    source
        Name of the file, for messages.
    clips
        What the character knows.

    Raises
    ------
    CharacterError
        If something in it is not as it should be.
    """
    if not any(key in document for key in ("motions", "machine", "play")):
        return None
    return _Reader(document, source, clips).plan()


class _Reader:
    """Reads one document."""

    def __init__(self, document: Mapping[str, Any], source: str, clips: Collection[str]) -> None:
        self._document = document
        self._source = source
        self._clips = clips
        self._motions = self._table(document.get("motions", {}), "motions")
        self._masks = self._table(document.get("masks", {}), "masks")
        self._open: list[str] = []  # motions that are being read, to find circles
        self._known: dict[str, Node] = {}
        self._depth = 0  # of the motion that is being read in others

    def plan(self) -> Plan:
        """Return the plan."""
        masks = {name: self._mask(table, f"masks.{name}") for name, table in self._masks.items()}
        for name in self._motions:  # also those that nothing uses: a mistake is a mistake
            self._named(name, f"motions.{name}")
        machine = self._machine() if "machine" in self._document else None
        root = None
        if "play" in self._document:
            root = self._motion(self._document["play"], "play")
        if (root is None) == (machine is None):
            self._refuse("play", 'write either play = "a motion" or a [machine]')
        return Plan(self._source, root, machine, masks, self._lags())

    def _machine(self) -> Machine:
        table = self._table(self._document["machine"], "machine")
        self._only(table, ("start", "states", "changes"), "machine")
        states = {
            name: self._motion(each, f"machine.states.{name}")
            for name, each in self._table(table.get("states", {}), "machine.states").items()
        }
        if not states:
            self._refuse("machine.states", 'name at least one state: idle = "a motion"')
        start = table.get("start", next(iter(states)))
        self._one_of(start, states, "machine.start", "state")
        changes = table.get("changes", [])
        if not isinstance(changes, list):
            self._refuse("machine.changes", "write each change as [[machine.changes]]")
        read = tuple(
            self._change(each, states, f"machine.changes[{number}]")
            for number, each in enumerate(changes)
        )
        return Machine(states, start, read)

    def _change(self, given: object, states: Mapping[str, Node], place: str) -> Change:
        table = self._table(given, place)
        self._only(table, ("from", "to", "when", "seconds", "crossfade"), place)
        for key in ("to", "when"):
            if key not in table:
                self._refuse(place, f"lacks {key!r}")
        start, end = table.get("from", "*"), table["to"]
        self._one_of(start, ["*", *states], f"{place}.from", "state")
        self._one_of(end, states, f"{place}.to", "state")
        if not isinstance(table["when"], str):
            self._refuse(f"{place}.when", 'write the condition as a text: "speed > 0.5"')
        numbers = frozenset([*PARAMETERS, *STATE_VALUES])
        try:
            when = Condition.read(table["when"], frozenset({"action"}), numbers)
        except ConditionError as error:
            self._refuse(f"{place}.when", str(error))
        seconds = self._number(table.get("seconds", 0.25), f"{place}.seconds")
        if not 0.0 < seconds <= 10.0:
            self._refuse(f"{place}.seconds", f"{seconds} s; give more than 0 and at most 10")
        crossfade = self._field(table.get("crossfade", False), "flag", f"{place}.crossfade")
        return Change(start, end, when, seconds, bool(crossfade))

    def _lags(self) -> dict[str, float]:
        table = self._table(self._document.get("parameters", {}), "parameters")
        lags: dict[str, float] = {}
        for name, given in table.items():
            place = f"parameters.{name}"
            self._one_of(name, PARAMETERS, place, "parameter")
            inner = self._table(given, place)
            self._only(inner, ("lag",), place)
            lags[name] = self._number(inner.get("lag", 0.0), f"{place}.lag")
            if lags[name] < 0.0:
                self._refuse(f"{place}.lag", f"{lags[name]} s; give 0 or more")
        return lags

    def _mask(self, given: object, place: str) -> MaskPlan:
        table = self._table(given, place)
        self._only(table, ("subtrees", "joints", "default"), place)
        subtrees, joints = (
            {
                name: self._number(weight, f"{place}.{key}.{name}")
                for name, weight in self._table(table.get(key, {}), f"{place}.{key}").items()
            }
            for key in ("subtrees", "joints")
        )
        default = self._number(table.get("default", 0.0), f"{place}.default")
        return MaskPlan(subtrees, joints, default)

    def _motion(self, given: object, place: str) -> Node:
        """Return the motion that a name or a table stands for."""
        if self._depth >= DEEPEST:
            self._refuse(place, f"motions nest more than {DEEPEST} deep; use fewer")
        self._depth += 1
        if not isinstance(given, str):
            node = self._node(self._table(given, place), place, "")
        elif given in self._motions:
            node = self._named(given, place)
        else:
            self._one_of(given, [*self._clips, *self._motions], place, "motion or clip")
            node = Node("clip", place, given, {"clip": given})
        self._depth -= 1
        return node

    def _named(self, name: str, place: str) -> Node:
        """Return one of the named motions; it may not be made of itself."""
        if name in self._open:
            circle = " -> ".join([*self._open[self._open.index(name) :], name])
            self._refuse(place, f"{circle}: a motion cannot be made of itself")
        if name not in self._known:
            self._open.append(name)
            where = f"motions.{name}"
            given = self._motions[name]
            self._known[name] = (
                self._motion(given, where)
                if isinstance(given, str)
                else self._node(self._table(given, where), where, name)
            )
            self._open.pop()
        return self._known[name]

    def _node(self, table: Mapping[str, Any], place: str, name: str) -> Node:
        kind_name = table.get("kind")
        if kind_name is None:
            self._refuse(place, f"lacks kind; choose one of {', '.join(KINDS)}")
        self._one_of(kind_name, KINDS, f"{place}.kind", "kind")
        kind = KINDS[kind_name]
        self._only(table, ("kind", *kind.fields, *([kind.rows] if kind.rows else [])), place)
        said, motions = self._fields(table, kind.fields, kind.optional, place)
        rows = self._rows(table, kind, place) if kind.rows else ()
        node = Node(kind_name, place, name, said, motions, rows)
        if node.size > MOST_MOTIONS:
            self._refuse(place, f"made of more than {MOST_MOTIONS} motions; use fewer")
        return node

    def _rows(self, table: Mapping[str, Any], kind: Kind, place: str) -> tuple[Row, ...]:
        given = table.get(kind.rows)
        if not isinstance(given, list) or not given:
            self._refuse(f"{place}.{kind.rows}", "give a list of one table for each motion")
        rows = []
        for number, each in enumerate(given):
            where = f"{place}.{kind.rows}[{number}]"
            row = self._table(each, where)
            self._only(row, ("motion", *kind.row_fields), where)
            fields: dict[str, Field] = {"motion": "motion", **kind.row_fields}
            said, motions = self._fields(row, fields, kind.optional, where)
            rows.append(Row(motions["motion"], said))
        return tuple(rows)

    def _fields(
        self,
        table: Mapping[str, Any],
        fields: Mapping[str, Field],
        optional: Mapping[str, object],
        place: str,
    ) -> tuple[dict[str, object], dict[str, Node]]:
        said: dict[str, object] = {}
        motions: dict[str, Node] = {}
        for key, kind in fields.items():
            if key not in table:
                if key not in optional:
                    self._refuse(place, f"lacks {key!r}")
                said[key] = optional[key]
            elif kind == "motion":
                motions[key] = self._motion(table[key], f"{place}.{key}")
            else:
                said[key] = self._field(table[key], kind, f"{place}.{key}")
        return said, motions

    def _field(self, given: object, kind: Field, place: str) -> object:
        if kind == "number":
            return self._number(given, place)
        if kind == "numbers":
            listed = given if isinstance(given, list) else self._refuse(place, "give a list")
            return tuple(self._number(each, f"{place}[{n}]") for n, each in enumerate(listed))
        if kind == "weight" and not isinstance(given, str):
            return self._number(given, place)
        if kind == "flag":
            return given if isinstance(given, bool) else self._refuse(place, "give true or false")
        if kind == "names":
            listed = given if isinstance(given, list) else self._refuse(place, "give two names")
            if len(listed) != 2 or listed[0] == listed[1]:
                self._refuse(place, "give two different parameters")
            for number, each in enumerate(listed):
                self._one_of(each, PARAMETERS, f"{place}[{number}]", "parameter")
            return tuple(listed)
        choices: dict[str, Collection[str]] = {
            "mask": self._masks,
            "shape": get_args(Ease),
            "name": self._clips if place.endswith(".clip") else PARAMETERS,
            "weight": PARAMETERS,
        }
        what = {"name": "clip" if place.endswith(".clip") else "parameter", "weight": "parameter"}
        self._one_of(given, choices[kind], place, what.get(kind, kind))
        return given

    def _number(self, given: object, place: str) -> float:
        if isinstance(given, (int, float)) and not isinstance(given, bool):
            with suppress(OverflowError):  # whole numbers in TOML may have any number of digits
                if math.isfinite(number := float(given)):
                    return number
        self._refuse(place, f"{_shown(given)} is not a finite number")

    def _table(self, given: object, place: str) -> Mapping[str, Any]:
        if not isinstance(given, dict):
            self._refuse(place, f"{_shown(given)} is not a table")
        return given

    def _only(self, table: Mapping[str, Any], keys: Collection[str], place: str) -> None:
        for key in table:
            if key not in keys:
                self._one_of(key, keys, place, "field")

    def _one_of(self, given: object, choices: Collection[str], place: str, what: str) -> None:
        if isinstance(given, str) and given in choices:
            return
        near = difflib.get_close_matches(str(given), choices, 1)
        hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(choices) or 'none'}"
        self._refuse(place, f"no {what} {given!r}; {hint}")

    def _refuse(self, place: str, what: str) -> NoReturn:
        raise CharacterError(f"{self._source}: {place}: {what}")


def _shown(given: object) -> str:
    """Return what a file says as it may stand in a message of one line."""
    text = repr(given)
    return text if len(text) <= 60 else text[:57] + "..."
