"""Upper bodies that reach: torso, arms, hands and the shapes of hands."""

from characters.ik.reaching.effort import reach_effort
from characters.ik.reaching.hand_shapes import HAND_SHAPES, HandShapes
from characters.ik.reaching.targets import NEUTRAL_REACH, HandTarget, ReachKind, ReachStyle
from characters.ik.reaching.upper_body import ReachedPose, UpperBody

__all__ = [
    "HAND_SHAPES",
    "NEUTRAL_REACH",
    "HandShapes",
    "HandTarget",
    "ReachKind",
    "ReachStyle",
    "ReachedPose",
    "UpperBody",
    "reach_effort",
]
