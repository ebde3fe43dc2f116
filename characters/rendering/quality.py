"""How much work goes into a picture."""

from dataclasses import dataclass


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
    """Whether characters are lit after all of them are drawn, with what that makes possible: light
    that other parts of the picture take away or add."""


QUALITIES = {
    each.name: each
    for each in (
        Quality("rich", 2, True, deferred=True),
        Quality("full", 2, True),
        Quality("reduced", 1, False),
    )
}
"""The qualities by name, the best first."""

FULL = QUALITIES["full"]
"""The quality without haste."""
