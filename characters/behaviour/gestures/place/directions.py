"""Words for where palms and fingers point, for either hand."""

from cubeling.characters.skeleton.scalar_quaternions import Vector, cross, dot, length

DIRECTIONS: dict[str, Vector] = {
    "up": (0.0, 1.0, 0.0),
    "down": (0.0, -1.0, 0.0),
    "in": (-1.0, 0.0, 0.0),
    "out": (1.0, 0.0, 0.0),
    "forward": (0.0, 0.0, 1.0),
    "back": (0.0, 0.0, -1.0),
}
"""Directions outward, up and forward: as x, y, z of the left hand."""


def direction(words: str, left: bool) -> Vector:
    """Return the unit vector of one or two words in the frame of the chest: left, up, forward.

    >>> direction("in", left=False)
    (1.0, 0.0, 0.0)
    """
    x, y, z = (sum(DIRECTIONS[word][axis] for word in words.split("-")) for axis in range(3))
    size = length((x, y, z)) or 1.0
    return (x if left else -x) / size, y / size, z / size


def words_of(vector: Vector, left: bool, without: str = "") -> str:
    """Return the one or two words whose direction is nearest to a vector.

    `without` names an axis's words that are not to be used: those of the palm, for the fingers.
    """
    single = list(DIRECTIONS)
    opposite = {"up": "down", "in": "out", "forward": "back"}
    pairs = [
        f"{a}-{b}"
        for number, a in enumerate(single)
        for b in single[number + 1 :]
        if opposite.get(a) != b
    ]
    choices = [each for each in (*single, *pairs) if not without or across(each, without, left)]
    return max(choices, key=lambda words: dot(direction(words, left), vector))


def across(words: str, others: str, left: bool) -> bool:
    """Return whether two directions are more than 30° apart, and less than 150°."""
    return length(cross(direction(words, left), direction(others, left))) > 0.5
