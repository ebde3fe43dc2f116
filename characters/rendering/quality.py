"""How much work goes into a picture."""

from dataclasses import dataclass
from enum import StrEnum


class Effect(StrEnum):
    """What deferred shading can add to the picture of a character."""

    SOFT_SHADOWS = "soft shadows"
    """Shadows that are softer further from what casts them, on characters too."""

    AMBIENT_OCCLUSION = "ambient occlusion"
    """Less of the light from all around in folds, below a chin and near the table."""

    SKIN_SCATTERING = "skin scattering"
    """Light that spreads below skin; it is seen close up."""

    DEPTH_OF_FIELD = "depth of field"
    """Blur of what is nearer or further than `View.focus`."""


@dataclass(frozen=True)
class Quality:
    """How finely characters are drawn."""

    name: str
    """Its name for the user."""

    fineness: int
    """Texels of the character layer for each pixel, along each side. A character's triangles are
    about as large as a pixel; multisampling costs software rendering more than finer texels do."""

    matched: bool
    """Whether characters get the blur and the noise of the picture."""

    deferred: bool = False
    """Whether characters are lit after all of them are drawn, which effects need."""

    effects: frozenset[Effect] = frozenset()
    """What deferred shading adds. Without any, the picture is that of forward shading."""

    max_error_px: float = 0.0
    """Error of a character's surface in the picture up to which its triangles are left out [px]."""


QUALITIES = {
    each.name: each
    for each in (
        Quality("rich", 2, True, deferred=True, effects=frozenset(Effect), max_error_px=0.85),
        Quality("full", 2, True, max_error_px=0.85),
        Quality("reduced", 1, False, max_error_px=3.0),
    )
}
"""The qualities by name, the best first."""

FULL = QUALITIES["full"]
"""The quality without haste."""
