"""The error that this room raises."""


class TrackingError(Exception):
    """Bad input: the message says in one line what was wrong, where, and what to do."""
