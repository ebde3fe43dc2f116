"""Questionnaires: their items, which answers they take, and their scores by published keys."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from cubeling.app.errors import AppError

FACES = "faces"
"""Names faces from angry to happy as the pictures of a scale."""

Answer = float | str | None
"""A number for scales and sliders, text for choices and free text, None for no answer."""


@dataclass(frozen=True)
class Item:
    """A question and the answers that it takes."""

    name: str
    """Its name in the tables."""

    text: str
    """The question as the participant reads it; "" between two opposites, which are its anchors."""

    kind: Literal["scale", "slider", "choice", "text"] = "scale"
    """Whole numbers, any number, one of some texts, or free text."""

    low: float = 1.0
    """Where a scale or a slider begins; a scale has every whole step from here."""

    high: float = 5.0
    """Where a scale or a slider ends, itself an answer."""

    anchors: tuple[str, ...] = ()
    """The words at both ends of a scale, or at each of its points."""

    options: tuple[str, ...] = ()
    """What a choice offers."""

    pictures: tuple[str, ...] = ()
    """A picture for each point of a scale, for those who do not read: files beside the protocol, or
    "faces" for faces from angry to happy."""

    optional: bool = False
    """Whether no answer is an answer."""

    simulated: tuple[float, ...] = ()
    """How often simulated participants give each answer; () for equally often."""

    def __post_init__(self) -> None:
        if self.kind == "choice" and len(self.options) < 2:
            raise AppError(f"the item '{self.name}' is a choice and needs two 'options' or more")
        if self.kind in ("scale", "slider") and not self.low < self.high:
            raise AppError(f"the scale of '{self.name}' must end above its beginning")
        points = len(self.answers)
        if self.anchors and len(self.anchors) not in (2, points):
            raise AppError(f"the item '{self.name}' needs 2 anchors, or one for each point")
        if self.pictures and (self.kind != "scale" or len(self.pictures) not in {1, points}):
            raise AppError(f"the item '{self.name}' needs a picture for each point of its scale")
        if len(self.pictures) == 1 < points and self.pictures != (FACES,):
            raise AppError(f"the item '{self.name}' has 1 picture: give one for each, or '{FACES}'")
        if self.simulated and (len(self.simulated) != points or min(self.simulated) < 0):
            raise AppError(f"the item '{self.name}' has {points} answers: give a share of each")

    @property
    def words(self) -> str:
        """What is asked, for tables.

        >>> Item("a", "", anchors=("fake", "natural")).words
        'fake / natural'
        """
        return self.text or " / ".join(self.anchors)

    @property
    def answers(self) -> tuple[Answer, ...]:
        """All answers that a scale or a choice takes; () for others."""
        if self.kind == "choice":
            return self.options
        if self.kind == "scale":
            return tuple(self.low + step for step in range(int(self.high - self.low) + 1))
        return ()

    def parse(self, text: str) -> Answer:
        """Return the answer that somebody typed; raises AppError with what is allowed."""
        text = text.strip()
        if not text:
            if self.optional or self.kind == "text":
                return None
            raise AppError("an answer is needed here")
        if self.kind == "text":
            return text
        if self.kind == "choice":
            if text.isdecimal() and 1 <= int(text) <= len(self.options):
                return self.options[int(text) - 1]
            if text in self.options:
                return text
            raise AppError(f"choose a number from 1 to {len(self.options)}")
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if not self.low <= number <= self.high:
            raise AppError(f"a number from {self.low:g} to {self.high:g}, please")
        if self.kind == "scale" and number not in self.answers:
            raise AppError("a whole number, please")
        return number


@dataclass(frozen=True)
class Score:
    """How answers make one figure."""

    name: str
    """Its name in the tables."""

    items: tuple[str, ...]
    """The items that count."""

    reversed: tuple[str, ...] = ()
    """Those of them that count from the upper end."""

    combine: Literal["mean", "sum"] = "mean"

    from_zero: bool = False
    """Whether the lower end counts 0 whatever its number."""

    factor: float = 1.0
    """What the result is multiplied by."""

    weighted_by: tuple[str, ...] = ()
    """Choices between pairs of the items' names: an item's weight is how often it was chosen."""


@dataclass(frozen=True)
class Questionnaire:
    """Questions that are asked together."""

    name: str
    title: str = ""
    """What stands above it; "" for nothing."""

    source: str = ""
    """The publication that it is from; "" for one of the protocol."""

    item: tuple[Item, ...] = ()
    """Its items, in their order."""

    score: tuple[Score, ...] = ()
    """What its answers add up to, by the published key."""

    def __post_init__(self) -> None:
        names = [each.name for each in self.item]
        if len(set(names)) < len(names):
            raise AppError(f"the questionnaire '{self.name}' has two items of one name")
        for score in self.score:
            for name in (*score.items, *score.reversed, *score.weighted_by):
                if name not in names:
                    raise AppError(f"the score '{score.name}' counts '{name}', which is no item")

    def scores(self, answers: Mapping[str, Answer]) -> dict[str, float]:
        """Return the scores; those that lack an answer are left out."""
        found = {}
        for score in self.score:
            value = self._score(score, answers)
            if value is not None:
                found[score.name] = value
        return found

    def _score(self, score: Score, answers: Mapping[str, Answer]) -> float | None:
        values: list[float] = []
        for item in self.item:
            if item.name in score.items:
                answer = answers.get(item.name)
                if not isinstance(answer, int | float):
                    return None
                value = float(answer)
                if item.name in score.reversed:
                    value = item.low + item.high - value
                values.append(value - item.low if score.from_zero else value)
        if score.weighted_by:
            chosen = [answers.get(name) for name in score.weighted_by]
            weights: Sequence[float] = [chosen.count(name) for name in score.items]
            if None in chosen:
                return None
            total = sum(w * v for w, v in zip(weights, values, strict=True))
            return score.factor * total / len(score.weighted_by)
        return score.factor * sum(values) / (len(values) if score.combine == "mean" else 1)
