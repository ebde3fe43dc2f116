"""In which order a participant meets conditions, tasks and stimuli."""

from collections.abc import Hashable, Mapping, Sequence
from typing import TypeVar

import numpy as np

T = TypeVar("T")
K = TypeVar("K", bound=Hashable)

MAX_CONDITIONS = 8
"""Most conditions that a Latin square orders here: with more, a study needs a plan of its own."""


def latin_square(count: int) -> list[tuple[int, ...]]:
    """Return orders in which each condition follows each other one equally often.

    E. J. Williams (1949). Each condition is equally often in each place. There are `count` orders
    for an even number of conditions; for an odd one twice as many, as each is also reversed.

    >>> latin_square(4)
    [(0, 1, 3, 2), (1, 2, 0, 3), (2, 3, 1, 0), (3, 0, 2, 1)]
    """
    if not 1 <= count <= MAX_CONDITIONS:
        raise ValueError(f"a Latin square here has 1 to {MAX_CONDITIONS} conditions, not {count}")
    zigzag = [(place + 1) // 2 if place % 2 else -(place // 2) for place in range(count)]
    rows = [tuple((start + step) % count for step in zigzag) for start in range(count)]
    return rows if count % 2 == 0 or count == 1 else [*rows, *(row[::-1] for row in rows)]


def balanced_order(items: Sequence[T], participant: int) -> tuple[T, ...]:
    """Return the items in the order of a participant, counted from 0, by a Latin square.

    >>> balanced_order("abc", 1)
    ('b', 'c', 'a')
    """
    rows = latin_square(len(items))
    return tuple(items[index] for index in rows[participant % len(rows)])


def random_order(items: Sequence[T], rng: np.random.Generator) -> tuple[T, ...]:
    """Return the items in a random order."""
    return tuple(items[int(index)] for index in rng.permutation(len(items)))


def random_sides(count: int, rng: np.random.Generator) -> tuple[bool, ...]:
    """Return for each of so many pairs whether its first member is on the left."""
    return tuple(bool(side) for side in rng.integers(0, 2, count))


def block_draw(
    groups: Mapping[K, Sequence[T]], each: int, participant: int, seed: int
) -> dict[K, tuple[T, ...]]:
    """Return so many items of each group, without repeats, so that all are shown equally often.

    Each group is dealt out like a pack of cards: participants take the next cards, and a new pack
    is shuffled when one is used up. A participant who gets the end of one pack and the beginning of
    the next does not get an item twice, as the new pack begins with others.

    Parameters
    ----------
    groups
        The items of each group.
    each
        How many of each; at most as many as there are.
    participant
        Their number, from 0.
    seed
        Of the study.

    Raises
    ------
    ValueError
        A group has fewer items.
    """
    drawn: dict[K, tuple[T, ...]] = {}
    for number, (group, items) in enumerate(groups.items()):
        if each > len(items):
            raise ValueError(f"'{group}' has {len(items)} stimuli, and {each} are to be drawn")
        rng = np.random.default_rng([seed, number])
        start, end = participant * each, (participant + 1) * each
        cards: list[int] = []
        while len(cards) < end:
            pack = [int(index) for index in rng.permutation(len(items))]
            held = cards[len(cards) // each * each :]  # by who is in the middle of drawing
            missing = (each - len(held)) % each if held else 0
            fresh = [card for card in pack if card not in held]
            cards += [*fresh[:missing], *(card for card in pack if card not in fresh[:missing])]
        drawn[group] = tuple(items[card] for card in cards[start:end])
    return drawn
