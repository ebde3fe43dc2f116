"""Blend trees and state machines as a file says them: `characters/trees/plan.py` has the words."""

from characters.trees.plan import KINDS, PARAMETERS, Change, Kind, Machine, Node, Plan, Row
from characters.trees.reading import read_plan

__all__ = [
    "KINDS",
    "PARAMETERS",
    "Change",
    "Kind",
    "Machine",
    "Node",
    "Plan",
    "Row",
    "read_plan",
]
