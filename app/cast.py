"""Draws the bundled characters, to look at and to judge: `python -m app.cast`.

Each is drawn from all sides, with the faces that it makes, and its clips frame by frame.
"""

from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from pathlib import Path

from rich.console import Console

from app.album import Album, Image, save
from characters import Character
from characters.rendering import create_context

FOLDER = Path(__file__).parent.parent / "docs" / "pictures" / "cast"

ROWS = 8
"""Clips on a page."""

MOST = 300_000
"""Bytes of a picture."""


def draw_cast(cast: Iterable[Character], folder: Path = FOLDER) -> Iterator[Path]:
    """Draw some characters, and yield each file when it is written."""
    with ExitStack() as closing:
        context = create_context()
        closing.callback(context.release)
        album = Album(context)
        closing.callback(album.release)
        for character in cast:
            for kind, picture in _pages(album, character):
                path = folder / f"{character.name}{kind}.jpg"
                save(picture, path, MOST)
                yield path


def _pages(album: Album, character: Character) -> Iterator[tuple[str, Image]]:
    yield "", album.turntable(character)
    if character.morphs and character.anatomy.joint("head") is not None:
        yield "-face", album.faces(character)
    clips = list(character.clips.values())
    for page, first in enumerate(range(0, len(clips), ROWS), start=1):
        yield f"-clips-{page}", album.clips(character, clips[first : first + ROWS])


if __name__ == "__main__":
    for path in draw_cast(map(Character.load, Character.bundled())):
        Console().print(f"{path.name}: {path.stat().st_size / 1e3:.0f} kB")
