"""What all rooms refuse bad input by: an error whose message is one line that can be printed."""

SPACES = "\u00a0\u2009\u202f"
"""Spaces that Python calls unprintable, and that may stand in a message."""


class BadInputError(Exception):
    r"""Bad input; the base of the errors of all rooms.

    The message is one line for a person: what is wrong, where, and what to do. What it quotes may
    be of a damaged file; control characters are escaped.

    >>> print(BadInputError("no joint 'a\x1b[2J\n' here"))
    no joint 'a\x1b[2J\n' here
    """

    def __str__(self) -> str:
        return one_line(super().__str__())


def one_line(text: str) -> str:
    r"""Return a text with its control characters escaped, so that it is one line.

    >>> one_line("a\nb")
    'a\\nb'
    """
    if text.isprintable():
        return text
    return "".join(
        each if each.isprintable() or each in SPACES else ascii(each)[1:-1] for each in text
    )
