"""Blend trees and state machines as a file describes them; `plan` has the vocabulary."""

from characters.motion.trees.plan import KINDS, PARAMETERS, Change, Kind, Machine, Node, Plan, Row
from characters.motion.trees.reading import read_plan

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
