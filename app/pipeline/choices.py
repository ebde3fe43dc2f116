"""What a player may choose of the picture, by name; needs no numpy, as the command line checks it.

`AppearanceMeter` measures what the realism needs, and `CubeWindow` shows the character inside.
"""

import re
from collections.abc import Iterable, Sequence

from cubeling.app.errors import AppError

REALISM_CHOICES = {
    "hand": "the hand that holds the cube hides what is behind it",
    "light": "light and shadow fall as on the cube",
    "softness": "characters are as soft, as noisy and as hazy as the picture",
    "room": "the room lights characters from all sides, and metal and wet eyes mirror it",
    "focus": "what is much nearer or further than the cube is out of focus, in the quality rich",
    "wrinkles": "skin wrinkles where a face moves",
    "blush": "a face flushes and pales with its emotion",
}
"""What makes the drawing belong in the picture, and what that means."""

NO_REALISM = "none"
"""The name of none of `REALISM_CHOICES`."""

INSIDE_CHOICES = {
    "auto": "while a face without a role is shown, and by the key I",
    "always": "from the beginning, until the key I",
    "never": "not at all",
}
"""When the character is inside the cube, and what that means."""


LOOK_CHOICES = ("auto", "cube", "hand", "camera", "none")
"""What the character's eyes may follow."""

SPEED_MAP_NAMES = ("corrected", "legacy")
"""Names of AvatAR's Speed maps: corrected, and as printed in the thesis."""


MAX_CAST = 5
"""Most characters on the table."""


def cast_of(text: str | None, character: str | None) -> tuple[str | None, tuple[str, ...]]:
    """Return the character that the cube leads, and the others, of a list with commas.

    Without a list that is `character`, alone; None is the scenario's own.

    >>> cast_of("human, vleo,vleo", None)
    ('human', ('vleo', 'vleo'))

    Raises
    ------
    AppError
        Both are given, a name is missing, or there are too many.
    """
    if text is None:
        return character, ()
    if character is not None:
        raise AppError("--cast names all characters, the first too: leave out --character")
    names = tuple(part.strip() for part in text.split(","))
    if not all(names) or len(names) > MAX_CAST:
        raise AppError(
            f"--cast takes one to {MAX_CAST} characters, separated by commas, not '{text:.60}'"
        )
    return names[0], names[1:]


def distinct_names(names: Iterable[str]) -> tuple[str, ...]:
    """Return names of a cast, or of players, with a number where two are the same.

    A name is a part of a channel's, so it has only letters, digits, "-" and "_".

    >>> distinct_names(["vleo", "my cube", "vleo"])
    ('vleo', 'my-cube', 'vleo_2')
    """
    found: list[str] = []
    for name in names:
        plain = re.sub(r"[^\w-]+", "-", name) or "unnamed"
        same = sum(1 for each in found if plain in (each, each.rpartition("_")[0]))
        found.append(f"{plain}_{same + 1}" if same else plain)
    return tuple(found)


MAX_PLAYERS = 2
"""Most players with a cube each: there is one more set of markers of the bundled cubes."""


def checked_players(number: float) -> int:
    """Return a number of players; raise AppError for one that cannot play."""
    if number not in range(1, MAX_PLAYERS + 1):
        raise AppError(f"one or {MAX_PLAYERS} can play at once, not {number:g}")
    return int(number)


ROBOT_NAMES = "robot", "robot_2"
"""Names of the robots of the first and the second player, unless they are given others."""


def robots_of(
    given: Sequence[str], players: int, names: tuple[str, str] = ROBOT_NAMES
) -> tuple[tuple[str, str], tuple[str, str]]:
    """Return URLs and names of the robots of the first and the second player.

    Each is given as URL or NAME=URL; `names` are those of robots without a name.

    >>> robots_of(["sim:pleo?drop=0.1"], 2)
    (('sim:pleo?drop=0.1', 'none'), ('robot', 'robot_2'))
    >>> robots_of(["rex=sim", "tim=sim:pleo"], 2)
    (('sim', 'sim:pleo'), ('rex', 'tim'))

    Raises
    ------
    AppError
        There are more robots than players, or both have the same name.
    """
    if len(given) > players:
        raise AppError(f"there are {len(given)} robots for {players}: --players 2 has two")
    found = [re.fullmatch(r"(?:([\w-]+)=)?(.*)", each, re.S) for each in given]
    urls = (*(each[2] for each in found if each), *("sim", "none")[len(given) :])
    named = [each[1] if each else None for each in found]
    first, second = (own or usual for own, usual in zip((*named, None, None), names, strict=False))
    if first == second:
        raise AppError(f"two robots have the name '{first}': give one another, NAME=URL")
    return (urls[0], urls[1]), (first, second)


def check_look(name: str) -> None:
    """Raise AppError for a name that is none of `LOOK_CHOICES`."""
    if name not in LOOK_CHOICES:
        known = ", ".join(LOOK_CHOICES)
        raise AppError(f"the character cannot look at '{name}': choose one of {known}")


def check_speed_map(name: str) -> None:
    """Raise AppError for a name that is none of `SPEED_MAP_NAMES`."""
    if name not in SPEED_MAP_NAMES:
        known = ", ".join(SPEED_MAP_NAMES)
        raise AppError(f"no speed map is called '{name}': choose one of {known}")


def check_turns(turns: float) -> None:
    """Raise AppError for full turns that are too few or too many to turn a cube."""
    if not 0.1 <= turns <= 20:
        raise AppError(f"the turns must be from 0.1 to 20, not {turns:g}")


def realism_of(text: str) -> tuple[str, ...]:
    """Return the choices in a text, separated by commas.

    >>> realism_of("hand, light")
    ('hand', 'light')
    >>> realism_of("none")
    ()

    Raises
    ------
    AppError
        One of them is none of `REALISM_CHOICES`.
    """
    names = tuple(part.strip() for part in text.split(","))
    if names == (NO_REALISM,):
        return ()
    for name in names:
        if name not in REALISM_CHOICES:
            known = ", ".join(REALISM_CHOICES)
            raise AppError(f"a picture cannot follow '{name}': choose of {known}, or {NO_REALISM}")
    return names


def inside_of(name: str) -> str:
    """Return one of `INSIDE_CHOICES`; raise AppError for another name."""
    if name not in INSIDE_CHOICES:
        known = ", ".join(INSIDE_CHOICES)
        raise AppError(f"the character cannot be inside '{name}': choose one of {known}")
    return name
