"""What was made of cards, kept as long as they stay the same."""

from collections.abc import Callable
from typing import Generic, TypeVar

from cubeling.app.ui.canvas import Card

Made = TypeVar("Made")


class KeptCards(Generic[Made]):
    """Makes something of each card once, and drops it when a picture did not need it.

    `make` is called with a card, and `drop` with what it returned.
    """

    def __init__(self, make: Callable[[Card], Made], drop: Callable[[Made], object]) -> None:
        self._make, self._drop = make, drop
        # A card is kept with what was made of it: its arrays are then those of no other card.
        self._kept: dict[tuple[int, int], tuple[Card, Made]] = {}
        self._used: dict[tuple[int, int], tuple[Card, Made]] = {}

    def begin(self) -> None:
        """Begin a picture: what the last one did not use is dropped."""
        for key in self._kept.keys() - self._used.keys():
            self._drop(self._kept.pop(key)[1])
        self._used = {}

    def of(self, card: Card) -> Made:
        """Return what was made of a card; its place may be another one."""
        key = id(card.color), id(card.opacity)
        if key not in self._kept:
            self._kept[key] = card, self._make(card)
        self._used[key] = kept = self._kept[key]
        return kept[1]

    def clear(self) -> None:
        """Drop what is kept of every card."""
        self._used = {}
        self.begin()
