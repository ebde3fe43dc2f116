"""Text from outside the program, such as a robot's name, for the terminal."""

from rich.text import Text


def literal_text(text: str) -> Text:
    r"""Return text that the terminal shows as it is: neither as markup nor as control codes.

    Robots name themselves, their moods and their errors; the names may hold anything.

    >>> literal_text("[red]Rex \x1b[2J").plain
    '[red]Rex \\x1b[2J'
    """
    return Text("".join(map(_visible, text)))


def _visible(character: str) -> str:
    if character.isprintable():
        return character
    return character.encode("unicode_escape").decode("ascii")
