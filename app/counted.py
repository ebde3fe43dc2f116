"""Numbers of things, in words."""


def quantity(number: int, one: str, many: str = "") -> str:
    """Return a number with its noun; `many` is for nouns whose plural does not only add an s.

    >>> quantity(1, "frame"), quantity(1200, "frame"), quantity(2, "mesh", "meshes")
    ('1 frame', '1,200 frames', '2 meshes')
    """
    return f"{number:,} {one if number == 1 else many or one + 's'}"
