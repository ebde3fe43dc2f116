"""What goes wrong in this room, said in one line."""

from cubeling.bad_input import BadInputError


class RobotError(BadInputError):
    """Bad input to `robot`, or a robot that does not answer.

    The message is one line for a person: what was wrong, where, and what to do.
    """
