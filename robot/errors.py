"""What goes wrong in this room, said in one line."""


class RobotError(Exception):
    """Bad input to `robot`, or a robot that does not answer: the message is one line for a person."""
