"""How a gesture is performed: six parameters (Huang 2013, section 8.7)."""

from dataclasses import dataclass


@dataclass(frozen=True)
class GestureExpressivity:
    """How a gesture is performed; 0.0 everywhere, and `openness` of 0.5, is as it is written."""

    spatial: float = 0.0
    """Size of the gesture space: its cells are scaled by 1 + this, and turns of the trunk by
    1 + half of it; −1…1."""

    openness: float = 0.5
    """Elbows close to the trunk, 0, to far from it, 1, by their swivel angle."""

    fluidity: float = 0.0
    """Corners at the keys (negative), the c of Kochanek and Bartels 1984, or hands that flow
    through their keys and wrists that trail (positive); −1…1."""

    bias: float = 0.0
    """Overshoot after keys (positive) or before them (negative), −1…1."""

    tension: float = 0.0
    """How tightly the path bends at its keys, −1…1: at 1 hands stop there, and rebound."""

    power: float = 0.0
    """Acceleration towards the stroke, and how much shoulders and trunk join in, 0…1."""


NEUTRAL = GestureExpressivity()
"""A gesture as it is written."""
