"""Cells of several texels, for passes that need not look at each; see `cells.glsl`."""

from typing import Any


def cell_count(size: tuple[int, int], stride: int) -> tuple[int, int]:
    """Return how many cells of stride × stride texels cover a part of a picture, (width, height).

    >>> cell_count((8, 7), 3)
    (3, 3)
    """
    return -(-size[0] // stride), -(-size[1] // stride)


def cell_uniforms(size: tuple[int, int], stride: int) -> dict[str, Any]:
    """Return the uniforms of `cells.glsl`; parameters as of `cell_count`."""
    (width, height), (columns, rows) = size, cell_count(size, stride)
    return {
        "last_texel": (width - 1, height - 1),
        "last_cell": (columns - 1, rows - 1),
        "stride": stride,
    }
