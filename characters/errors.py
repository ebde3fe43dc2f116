"""What goes wrong in this room, said in one line."""


class CharacterError(Exception):
    """Bad input to `characters`: the message is one line for a person.

    It says what was wrong, where, and what to do.
    """


class CharacterWarning(UserWarning):
    """Bad input that was repaired: one line that says what was wrong, where, and what was done."""
