"""Reading questionnaires: bundled ones, those of a protocol, and those that a researcher brings.

A file that its licence keeps us from bundling holds the words; the scoring key is bundled.
"""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.app.workshop.study.protocols.questionnaires import Item, Questionnaire, Score
from cubeling.toml_file import TomlTable, bundled, read, toml_kind

QUESTIONNAIRE_FILE = toml_kind(
    "questionnaire", AppError, "cubeling.app.workshop.study.protocols.forms:read_questionnaire"
)
"""A questionnaire that the researcher brings."""

FORM_FOLDER, KEY_FOLDER = (Path(__file__).parent / name for name in ("forms", "keys"))


@dataclass(frozen=True)
class KeyScore:
    """A score of a published key."""

    name: str
    items: tuple[int, ...]
    """Numbers of the items whose mean it is, from 1, as they are published."""


@dataclass(frozen=True)
class ScoringKey:
    """How a questionnaire is scored whose words are not ours to give away."""

    source: str

    items: int
    """How many there are, in the published order."""

    low: float
    """Left end of the scale of each item."""

    high: float
    """Right end of the scale of each item."""

    reversed: tuple[int, ...] = ()
    """Items whose better word is on the left."""

    score: tuple[KeyScore, ...] = ()

    def on(self, items: tuple[Item, ...]) -> tuple[tuple[Item, ...], tuple[Score, ...]]:
        """Return items with the scales of the key, and its scores; raises AppError."""
        if len(items) != self.items:
            raise AppError(f"the key is for {self.items} items, and there are {len(items)}")
        names = [each.name for each in items]
        turned = {names[number - 1] for number in self.reversed}
        scores = []
        for score in self.score:
            own = tuple(names[number - 1] for number in score.items)
            scores.append(Score(score.name, own, tuple(each for each in own if each in turned)))
        scaled = (replace(each, kind="scale", low=self.low, high=self.high) for each in items)
        return tuple(scaled), tuple(scores)


@dataclass(frozen=True)
class Weighting:
    """Weights of items by which of each two a participant chooses."""

    score: str
    """Name of the weighted mean."""

    ask: str
    """What is asked about each two."""

    def on(self, items: tuple[Item, ...]) -> tuple[tuple[Item, ...], Score]:
        """Return a choice between each two of some items, and their weighted mean."""
        names = tuple(each.name for each in items)
        pairs = tuple(
            Item(f"{one}_or_{other}", self.ask, "choice", options=(one, other))
            for one, other in itertools.combinations(names, 2)
        )
        return pairs, Score(self.score, names, weighted_by=tuple(each.name for each in pairs))


def names_in(folder: Path) -> tuple[str, ...]:
    """Return the names of the forms or keys that come with the program."""
    return tuple(sorted(path.stem for path in folder.glob("*.toml")))


def bundled_questionnaire(name: str) -> Questionnaire:
    """Return a questionnaire that comes with the program; raises AppError if there is none."""
    return questionnaire_of(_bundled(name, FORM_FOLDER, "questionnaire"), FORM_FOLDER)


def read_questionnaire(path: Path) -> Questionnaire:
    """Read a questionnaire from a file; raises AppError."""
    table = TomlTable(read(path, QUESTIONNAIRE_FILE), str(path), "", AppError)
    if "file" in table:
        raise table.wrong("file", "a questionnaire's own file holds its items")
    return questionnaire_of(table, path.parent)


def questionnaire_of(row: TomlTable, folder: Path) -> Questionnaire:
    """Return the questionnaire of a table, which has items or names what has them.

    Parameters
    ----------
    row
        What a file holds, or a row of a protocol.
    folder
        Where a `file` lies that it names.

    Raises
    ------
    AppError
        It is none.
    """
    row.only("name", "title", "source", "bundled", "file", "each", "item", "opposites", "score",
             "key", "weighted")  # fmt: skip
    places = [key for key in ("bundled", "file", "item", "opposites") if key in row]
    if len(places) != 1:
        raise row.wrong("", "needs one of 'bundled', 'file', 'item' and 'opposites'")
    if places[0] == "bundled":
        found = bundled_questionnaire(row.line("bundled"))
    elif places[0] == "file":
        found = read_questionnaire(folder / row.line("file"))
    else:
        found = Questionnaire("", item=_items(row))
    items, scores = found.item, (*found.score, *(each.fill(Score) for each in row.rows("score")))
    name, title = row.line("name", found.name or None), row.line("title", found.title)
    source = row.line("source", found.source)
    try:
        if "key" in row:
            key = _bundled(row.line("key"), KEY_FOLDER, "key").fill(ScoringKey)
            items, keyed = key.on(items)
            scores, source = (*scores, *keyed), source or key.source
        if "weighted" in row:
            pairs, weighted = row.table("weighted").fill(Weighting).on(items)
            items, scores = (*items, *pairs), (*scores, weighted)
        return Questionnaire(name, title, source, items, scores)
    except AppError as error:
        raise row.wrong("", str(error)) from None


def _items(row: TomlTable) -> tuple[Item, ...]:
    """Return the items of a table; what `each` says holds for those that do not say it."""
    usual = row.table("each")
    shared = {key: usual.value(key) for key in usual}
    given: list[Mapping[str, object]] = [
        {key: each.value(key) for key in each} for each in row.rows("item")
    ]
    for number, pair in enumerate(row.list("opposites", "pairs of words"), 1):
        if not isinstance(pair, list) or len(pair) != 2:
            raise row.unlike("opposites", "pairs of words", pair)
        given.append({"name": f"item_{number}", "text": "", "anchors": pair})
    if not given:
        raise row.wrong("item", "a questionnaire needs at least one")
    rows = [{**shared, **each} for each in given]
    return TomlTable({"item": rows}, row.source, row.place, AppError).fill(_Items).item


@dataclass(frozen=True)
class _Items:
    item: tuple[Item, ...] = ()


def _bundled(name: str, folder: Path, what: str) -> TomlTable:
    if name not in names_in(folder):
        known = ", ".join(names_in(folder))
        raise AppError(f"no {what} '{name}' is bundled: choose from {known}")
    path = folder / f"{name}.toml"
    return TomlTable(bundled(path), path.name, "", AppError)
