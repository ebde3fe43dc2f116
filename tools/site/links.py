"""Whether every link within a site leads somewhere: to a file, and to a place in it."""

from collections.abc import Iterator
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class _Places(HTMLParser):
    """Collects the links of a page, and the places that others can link to."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.places: set[str] = set()

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        """Note the links and the places of one element."""
        for name, value in attributes:
            if name in ("href", "src") and value:
                self.links.append(value)
            elif name == "id" and value:
                self.places.add(value)


@cache
def _places(page: Path) -> _Places:
    found = _Places()
    found.feed(page.read_text("utf-8"))
    return found


def broken_links(folder: Path) -> list[str]:
    """Return what is wrong with the links within a site, one line for each broken one.

    What leads to another site is not tried: a build needs no network.
    """
    pages = sorted(folder.rglob("*.html"))
    return list(dict.fromkeys(line for page in pages for line in _broken(folder, page)))


def _broken(folder: Path, page: Path) -> Iterator[str]:
    for link in _places(page).links:
        parts = urlsplit(link)
        if parts.scheme or parts.netloc:
            continue
        target = page if not parts.path else (page.parent / unquote(parts.path)).resolve()
        where = f"{page.relative_to(folder)}: {link}"
        if not target.is_file() or not target.is_relative_to(folder.resolve()):
            yield f"{where}: there is no such file"
        elif parts.fragment and unquote(parts.fragment) not in _places(target).places:
            yield f"{where}: there is no such place in that page"
