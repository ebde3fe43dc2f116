"""Draws characters into the camera's picture: `Stage` and what it is given."""

from characters.rendering.context import create_context
from characters.rendering.scene import Actor, Box, FloorPath, View
from characters.rendering.stage import Stage

__all__ = ["Actor", "Box", "FloorPath", "Stage", "View", "create_context"]
