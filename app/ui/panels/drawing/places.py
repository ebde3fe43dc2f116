"""Where panels lie: next to each other, and inside the window whatever its size."""

from collections.abc import Sequence
from itertools import product

Size = tuple[float, float]
Rect = tuple[float, float, float, float]
"""Left, top, width and height [px]."""


def free_place(
    size: Size,
    others: Sequence[Rect],
    display: Size,
    top: float,
    gap: float,
) -> Size:
    """Return the top left corner of a panel where it covers as little of the others as it can.

    Of several such places it is the one nearest to the left or right edge, and of those the
    highest. Above `top` there is no panel, and `gap` lies between them.

    >>> free_place((300, 200), [], (1280, 720), 80, 10)
    (10, 80)
    >>> free_place((300, 200), [(10, 80, 300, 200)], (1280, 720), 80, 10)
    (10, 290)
    >>> free_place((300, 500), [(10, 80, 300, 200)], (1280, 720), 80, 10)
    (970, 80)
    """
    width, height = size
    last_column, last_row = display[0] - width - gap, display[1] - height - gap
    columns = {gap, last_column}
    rows = {top}
    for left, above, wide, high in others:
        columns |= {left + wide + gap, left - width - gap}
        rows.add(above + high + gap)
    candidates = [
        (left, above)
        for left, above in product(columns, rows)
        if gap <= left <= last_column and above <= last_row
    ]

    def cost(corner: Size) -> tuple[float, float, float, float]:
        rect = (*corner, *size)
        covered = sum(overlap(rect, each) for each in others)
        return covered, min(corner[0] - gap, last_column - corner[0]), *corner

    return min(candidates, key=cost, default=(gap, top))


def overlap(first: Rect, second: Rect) -> float:
    """Return the area that two rectangles share [px²]."""
    wide, high = (
        min(first[axis] + first[axis + 2], second[axis] + second[axis + 2])
        - max(first[axis], second[axis])
        for axis in (0, 1)
    )
    return max(wide, 0.0) * max(high, 0.0)


def place_of(text: str) -> tuple[str, Size | None]:
    """Return a panel's name and its place from an entry of `Preferences.panels`.

    >>> place_of("tracking@0.02:0.5"), place_of("tracking"), place_of("tracking@left")
    (('tracking', (0.02, 0.5)), ('tracking', None), ('tracking', None))
    """
    name, _, place = text.partition("@")
    left, _, above = place.partition(":")
    try:
        shares = float(left), float(above)
    except ValueError:
        return name, None
    return name, shares if all(0.0 <= share <= 1.0 for share in shares) else None


def entry_of(name: str, place: Size) -> str:
    """Return the entry of `Preferences.panels` for a panel at a place.

    >>> entry_of("tracking", (0.5, 0.0))
    'tracking@0.5:0'
    """
    return f"{name}@{place[0]:.3g}:{place[1]:.3g}"


def place_at(corner: Size, size: Size, display: Size) -> Size:
    """Return the place of a panel with its top left corner there, moved into the window.

    >>> place_at((490.0, -5.0), (300.0, 200.0), (1280.0, 720.0))
    (0.5, 0.0)
    """
    left, above = (
        min(max(at / max(whole - own, 1.0), 0.0), 1.0)
        for at, own, whole in zip(corner, size, display, strict=True)
    )
    return left, above


def corner_of(place: Size, size: Size, display: Size) -> Size:
    """Return the top left corner of a panel at a place; it is inside a window of any size."""
    left, above = (
        share * max(whole - own, 0.0)
        for share, own, whole in zip(place, size, display, strict=True)
    )
    return left, above
