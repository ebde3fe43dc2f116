"""Blend trees and state machines that are described in a file; `plan` defines the format."""

from characters.motion.trees.plan import (
    KINDS,
    PARAMETERS,
    Node,
    NodeKind,
    Plan,
    Row,
    StateGraph,
    Transition,
)
from characters.motion.trees.reading import read_plan

__all__ = [
    "KINDS",
    "PARAMETERS",
    "Node",
    "NodeKind",
    "Plan",
    "Row",
    "StateGraph",
    "Transition",
    "read_plan",
]
