"""What goes wrong in the program itself, said in one line."""

from cubeling.bad_input import BadInputError


class AppError(BadInputError):
    """Bad input to `app`: the message is one line for a person.

    It says what was wrong, where, and what to do.
    """
