"""Upper bodies that reach: torso, arms, hands and the shapes of hands."""

from cubeling.characters.ik.reaching.effort import reach_effort
from cubeling.characters.ik.reaching.hand_shapes import HAND_SHAPES, HandShapes
from cubeling.characters.ik.reaching.targets import NEUTRAL_REACH, HandTarget, ReachKind, ReachStyle
from cubeling.characters.ik.reaching.upper_body import ReachedPose, UpperBody

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
