"""Draws characters into the camera's picture: `Stage` and what it is given."""

from cubeling.characters.rendering.context import create_context, draws_in_software
from cubeling.characters.rendering.quality import FULL, QUALITIES, Effect, Quality
from cubeling.characters.rendering.scene import (
    RIM_SHARE,
    WALL_SHARE,
    Box,
    Cover,
    FloorPath,
    Focus,
    MeasuredLight,
    Scene,
    SceneCharacter,
    Softness,
    View,
)
from cubeling.characters.rendering.stage import Stage

__all__ = [
    "FULL",
    "QUALITIES",
    "RIM_SHARE",
    "WALL_SHARE",
    "Box",
    "Cover",
    "Effect",
    "FloorPath",
    "Focus",
    "MeasuredLight",
    "Quality",
    "Scene",
    "SceneCharacter",
    "Softness",
    "Stage",
    "View",
    "create_context",
    "draws_in_software",
]
