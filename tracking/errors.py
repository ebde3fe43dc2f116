"""What goes wrong in this room, said in one line."""


class TrackingError(Exception):
    """Bad input to `tracking`: the message is one line for a person.

    It says what was wrong, where, and what to do.
    """
