"""Exceptions and warnings of `characters`."""

from collections.abc import Collection
from itertools import islice

from cubeling.bad_input import BadInputError

MAX_LISTED = 12
"""Names that a message lists."""


class CharacterError(BadInputError):
    """Bad input. The message is one line for a person: what is wrong, where, and what to do."""


class CharacterWarning(UserWarning):
    """Bad input that was repaired. The message says what was wrong, where, and what was done."""


def name_list(names: Collection[str]) -> str:
    """Return names for a message: "a, b, c", and "…" for what is more than `MAX_LISTED`.

    >>> name_list(["start", "end"]), name_list([]), name_list("abcdefghijklmn")[-7:]
    ('start, end', '', 'k, l, …')
    """
    return ", ".join(islice(names, MAX_LISTED)) + (", …" if len(names) > MAX_LISTED else "")
