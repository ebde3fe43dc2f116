"""What goes wrong in the program itself, said in one line."""


class AppError(Exception):
    """Bad input to `app`: the message is one line for a person.

    It says what was wrong, where, and what to do.
    """
