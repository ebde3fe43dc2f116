"""Conditions of state machines: comparisons of parameters.

They are parsed with Python's grammar, restricted to comparisons and logic; nothing is executed.
"""

import ast
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

Values = Mapping[str, "float | str | bool"]

_OPERATORS: dict[type[ast.cmpop], Callable[[float, float], bool]] = {
    ast.Lt: lambda a, b: a < b,
    ast.LtE: lambda a, b: a <= b,
    ast.Gt: lambda a, b: a > b,
    ast.GtE: lambda a, b: a >= b,
    ast.Eq: lambda a, b: a == b,
    ast.NotEq: lambda a, b: a != b,
}
_MAX_LENGTH = 500  # characters


class ConditionError(ValueError):
    """A condition that cannot be read; the message does not name its place in the file."""


@dataclass(frozen=True)
class Condition:
    """A condition over named values; see `Condition.read`."""

    text: str
    """Its text in the file."""

    _tree: ast.expr = field(compare=False, repr=False)

    @staticmethod
    def read(text: str, texts: frozenset[str], numbers: frozenset[str]) -> "Condition":
        """Return the condition in a text, such as "speed > 0.5 and not done".

        `texts` and `numbers` name the values by type; numbers may also be used as truth values.

        Raises
        ------
        ConditionError
            If it is not a condition, or names an unknown value.
        """
        if len(text) > _MAX_LENGTH:
            raise ConditionError(f"is longer than {_MAX_LENGTH} characters")
        try:
            tree = ast.parse(text.strip(), mode="eval").body
        except (SyntaxError, ValueError, MemoryError, RecursionError):
            raise ConditionError(
                f"{text!r} cannot be read; write for example speed > 0.5"
            ) from None
        _check(tree, text, texts, numbers)
        return Condition(text, tree)

    def holds(self, values: Values) -> bool:
        """Return whether it is true for given values.

        >>> numbers, texts = frozenset({"speed", "done"}), frozenset({"action"})
        >>> Condition.read('0 < speed <= 3 and action != "run"', texts, numbers).holds(
        ...     {"speed": 2.0, "action": "move"}
        ... )
        True
        """
        return bool(_value(self._tree, values))


def _check(tree: ast.expr, text: str, texts: frozenset[str], numbers: frozenset[str]) -> None:
    match tree:
        case ast.BoolOp(values=values):
            for each in values:
                _check(each, text, texts, numbers)
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            _check(operand, text, texts, numbers)
        case ast.Compare(left=left, ops=ops, comparators=others):
            kinds = {_operand(each, text, texts, numbers) for each in (left, *others)}
            ordered = any(not isinstance(op, (ast.Eq, ast.NotEq)) for op in ops)
            if any(type(op) not in _OPERATORS for op in ops):
                raise ConditionError(f"{text!r} uses a comparison other than < <= > >= == !=")
            if len(kinds) > 1 or (ordered and kinds == {str}):
                raise ConditionError(f"{text!r} compares a text with a number, or texts by order")
        case ast.Name(id=name) if name in numbers:
            pass
        case _:
            known = ", ".join(sorted(numbers | texts))
            raise ConditionError(f"{text!r} may only compare {known}, joined by and, or, not")


def _operand(tree: ast.expr, text: str, texts: frozenset[str], numbers: frozenset[str]) -> type:
    """Return whether one side of a comparison is a number or a text."""
    match tree:
        case ast.Constant(value=value) if isinstance(value, (int, float, str)):
            return str if isinstance(value, str) else float
        case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=value)) if isinstance(
            value, (int, float)
        ):
            return float
        case ast.Name(id=name) if name in numbers | texts:
            return str if name in texts else float
        case ast.Name(id=name):
            known = ", ".join(sorted(numbers | texts))
            raise ConditionError(f"{text!r} names {name!r}; there are {known}")
        case _:
            raise ConditionError(f"{text!r} compares something other than names, numbers and texts")


def _value(tree: ast.expr, values: Values) -> "float | str | bool":
    match tree:
        case ast.BoolOp(op=op, values=parts):
            together = all if isinstance(op, ast.And) else any
            return together(_value(part, values) for part in parts)
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            return not _value(operand, values)
        case ast.UnaryOp(operand=operand):
            return -float(_value(operand, values))
        case ast.Compare(left=left, ops=ops, comparators=others):
            sides = [_value(each, values) for each in (left, *others)]
            pairs = zip(ops, sides, sides[1:], strict=False)
            return all(_OPERATORS[type(op)](a, b) for op, a, b in pairs)  # type: ignore[arg-type]
        case ast.Name(id=name):
            return values[name]
        case ast.Constant(value=value):
            return value  # type: ignore[return-value]
    raise AssertionError("checked before")
