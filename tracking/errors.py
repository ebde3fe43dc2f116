"""What goes wrong in this room, said in one line."""


class TrackingError(Exception):
    """Bad input: the message says in one line what was wrong, where, and what to do."""
