"""The errors that this room raises."""

from cubeling.bad_input import BadInputError


class TrackingError(BadInputError):
    """Bad input: the message says in one line what was wrong, where, and what to do."""


class NoCameraError(TrackingError):
    """A live source that gives no first frame: it is not there, or does not open."""
