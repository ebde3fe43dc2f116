"""Exceptions and warnings of `characters`."""

from cubeling.bad_input import BadInputError


class CharacterError(BadInputError):
    """Bad input. The message is one line for a person: what is wrong, where, and what to do."""


class CharacterWarning(UserWarning):
    """Bad input that was repaired. The message says what was wrong, where, and what was done."""
