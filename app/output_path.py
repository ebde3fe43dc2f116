"""Where files go: checked before a command does the work, and named for a key."""

import glob
import os
import shlex
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from datetime import datetime
from pathlib import Path

from cubeling.app.errors import AppError


def check_output(
    path: Path,
    kind: str,
    suffixes: tuple[str, ...],
    *,
    overwrite: bool,
    remedy: str = "add --overwrite",
) -> None:
    """Refuse a file that cannot be written, or that exists unless `overwrite` allows it.

    Parameters
    ----------
    path
        The file.
    kind
        What it is, for the message: "video", "plot" …
    suffixes
        The suffixes that say what can be written, in lower case.
    overwrite
        Whether the file may exist.
    remedy
        What the user can do about a file that exists, besides choosing another name.

    Raises
    ------
    AppError
        The suffix is another one, the file is a folder or exists, or its folder is missing or
        cannot be written to.
    """
    if path.exists() and not path.is_file():
        raise AppError(f"'{path}' is not a file: name a file for the {kind}")
    if path.suffix.lower() not in suffixes:
        article = "an" if kind[0] in "aeiou" else "a"
        raise AppError(
            f"{article} {kind} is written as {', '.join(suffixes)}, not as '{path.name}'"
        )
    if not path.parent.is_dir():
        raise AppError(f"there is no folder '{path.parent}' for the {kind} '{path.name}'")
    if path.exists() and not overwrite:
        raise AppError(f"the {kind} '{path}' exists already: choose another name or {remedy}")
    for place in (path.parent, path):
        if place.exists() and not os.access(place, os.W_OK):
            raise AppError(f"'{place}' cannot be written to: choose another place for the {kind}")


def check_output_folder(folder: Path, files: Iterable[str], kind: str, *, overwrite: bool) -> None:
    """Refuse a folder that cannot be written to, or that holds some of the files already.

    Parameters
    ----------
    folder
        The folder; it may be missing, but not the one that it is in.
    files
        Names of the files that are to be written.
    kind
        What they are, for the message: "tables", "sounds" …
    overwrite
        Whether they may exist.

    Raises
    ------
    AppError
        The folder is a file, cannot be made or written to, or holds one of the files.
    """
    if folder.exists() and not folder.is_dir():
        raise AppError(f"'{folder}' is a file: name a folder with --output")
    if not folder.parent.is_dir():
        raise AppError(f"there is no folder '{folder.parent}' for the folder '{folder.name}'")
    if not os.access(folder if folder.exists() else folder.parent, os.W_OK):
        raise AppError(f"'{folder}' cannot be written to: choose another place")
    if not overwrite and any((folder / name).exists() for name in files):
        raise AppError(f"'{folder}' holds {kind} already: choose another one or add --overwrite")


@contextmanager
def output_folder(folder: Path) -> Iterator[None]:
    """Make a folder to write files into; after an error, none is left that is new and empty."""
    existed = folder.exists()
    folder.mkdir(exist_ok=True)
    try:
        yield
    except BaseException:
        with suppress(OSError):  # it holds something
            if not existed:
                folder.rmdir()
        raise


def default_folder() -> Path:
    """Return the folder for snapshots and recordings that are made by a key."""
    return Path.home() / "Cubeling"


def dated_file(folder: Path, name: str, suffix: str, when: datetime) -> Path:
    """Return a file in a folder, which is made if it is missing, with a time in its name.

    The name is that of no other file. Raises AppError if the folder cannot be made.

    >>> from tempfile import gettempdir
    >>> dated_file(Path(gettempdir()), "follow", ".png", datetime(2026, 5, 4, 15, 3, 9)).name
    'follow-2026-05-04-150309.png'
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise AppError(f"cannot make the folder '{folder}': {error.strerror}") from error
    stem = f"{name}-{when:%Y-%m-%d-%H%M%S}"
    names = (stem, *(f"{stem}-{number}" for number in range(2, 1000)))
    return next(path for each in names if not (path := folder / f"{each}{suffix}").exists())


def part_path(path: Path, number: int) -> Path:
    """Return the file of a part of a recording, by its number from 1.

    >>> part_path(Path("today.mcap"), 2).name
    'today-002.mcap'
    """
    return path if number == 1 else path.with_stem(f"{path.stem}-{number:03}")


def later_parts(path: Path) -> list[Path]:
    """Return the files in a recording's folder that are called as its parts but the first."""
    return sorted(path.parent.glob(f"{glob.escape(path.stem)}-[0-9][0-9][0-9]{path.suffix}"))


def short_path(path: Path) -> str:
    """Return a path as a shell takes it, with ~ for the home folder."""
    text = str(path)
    home = str(Path.home())
    if os.sep == "/" and text.startswith(home + os.sep):
        text = "~" + text[len(home) :]
    return text if shlex.quote(text.lstrip("~")) == text.lstrip("~") else shlex.quote(str(path))
