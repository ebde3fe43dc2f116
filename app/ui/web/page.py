"""The documents that a browser gets: each is one file that loads nothing from elsewhere."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from importlib.resources.abc import Traversable

from cubeling.app.ui.local_pages import HTML
from cubeling.app.ui.page_document import assembled

MAX_PAGE_BYTES = 30_000
"""Size of the page [B]: it is there at once on any network."""

SCRIPT_FILES = ("words.js", "base.js", "link.js", "picture.js", "camera.js", "sound.js", "touch.js")
"""The parts of the page's script, in their order."""


@dataclass(frozen=True)
class Document:
    """A page in HTML, and what is sent with it."""

    body: bytes
    """It, in UTF-8, with its style and its script in it."""

    headers: Mapping[str, str]
    """Of HTTP: it runs its own script only, and nothing frames it."""


def document(
    name: str, styles: Iterable[str], scripts: Iterable[str], folder: Traversable | None = None
) -> Document:
    """Return a document made of files of a folder; None for that of the page.

    See `assembled`.
    """
    html, policy = assembled(
        folder or resources.files("cubeling.app.ui.web") / "page",
        name,
        styles,
        scripts,
        loads="img-src 'self' blob: data:; media-src 'self' blob:",
    )
    headers = {
        "Content-Type": HTML,
        "Content-Security-Policy": policy,
        "Permissions-Policy": "camera=(self), microphone=(), geolocation=()",
        "Referrer-Policy": "no-referrer",
        "X-Content-Type-Options": "nosniff",
        "Cache-Control": "no-store",
    }
    return Document(html.encode(), headers)


@lru_cache(maxsize=1)
def page() -> Document:
    """Return the page that plays."""
    return document("page.html", ["page.css"], SCRIPT_FILES)
