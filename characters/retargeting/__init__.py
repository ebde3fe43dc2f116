"""A motion of one skeleton on another, by what their joints are; feet hold where they held."""

from characters.retargeting.retarget import retarget

__all__ = ["retarget"]
