"""Where a command writes: checked before it does the work, and written whole or not at all."""

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from app.errors import AppError


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
        raise AppError(f"a {kind} is written as {', '.join(suffixes)}, not as '{path.name}'")
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
def whole_file(path: Path) -> Iterator[Path]:
    """Yield the path to write a file at until it is whole: `PATH.partial`, with the same suffix.

    Leaving the block renames it; leaving it with an error, such as Ctrl-C or a full disk, removes
    it and leaves a file of that name as it was.
    """
    partial = path.with_name(f"{path.stem}.partial{path.suffix}")
    try:
        yield partial
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)
