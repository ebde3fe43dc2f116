"""What goes wrong in this room, said in one line."""

from cubeling.bad_input import BadInputError


class AffectError(BadInputError):
    """Bad input to `affect`: the message is one line for a person.

    It says what was wrong, where, and what to do.
    """
