"""Files and names that a command is given: looked for before the command loads what does the work.

Whoever reads a file refuses what is wrong with it; here a name with a slip is refused at once.
"""

from collections.abc import Iterable
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.files import check_regular


def check_input(path: str | Path | None, kind: str) -> None:
    """Refuse a file that is not there or is no file; None is one that was not named.

    Parameters
    ----------
    path
        The file.
    kind
        What it is, for the message, as its `FileKind` calls it: "motion capture", "sound" …

    Raises
    ------
    AppError
        With the line that the reader of the file would end in.
    """
    if path is not None:
        check_regular(path, kind, AppError)


def check_motions(names: Iterable[str]) -> None:
    """Refuse motions that are not there: files, characters with a clip (`fox.glb#Walk`), folders.

    The clip of a bundled character (`human#wave`) is left to who reads it.
    """
    for name in names:
        path = Path(name.partition("#")[0])
        if path.suffix and not path.is_dir():
            check_input(path, "motion")
        elif not path.is_dir() and not _is_bundled(str(path)):
            raise AppError(
                f"there are no motions '{name}': no file, folder or bundled character is called so"
            )


def check_character(name: str | None) -> None:
    """Refuse a character that is neither bundled nor a file; None is the scenario's own.

    Raises AppError, or CharacterError if it has no such name.
    """
    if name is None:
        return
    if Path(name).suffix:
        check_input(name, "character")
        return
    if not _is_bundled(name):
        from cubeling.characters import Character

        Character.load(name)  # says which there are


def _is_bundled(name: str) -> bool:
    """Return whether a bundled character has a name."""
    from cubeling.characters import Character  # it loads numpy

    return name in Character.bundled_names()
