"""The documents that a browser gets: each is one file that loads nothing from elsewhere."""

import base64
import hashlib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from importlib.resources.abc import Traversable

MAX_PAGE_BYTES = 30_000
"""Size of the page [B]: it is there at once on any network."""

SCRIPTS = ("words.js", "base.js", "link.js", "picture.js", "camera.js", "sound.js", "touch.js")
"""The parts of the page's script, in their order."""

FOR_PEOPLE = re.compile(r"^\s+|^(//.*|/\*.*\*/)\n", re.MULTILINE)
"""What a browser does not need: indents, and lines that are comments."""


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

    In the HTML file `name`, the styles go where it says /*STYLE*/, the scripts where /*SCRIPT*/.
    """
    where = folder or resources.files("cubeling.app.ui.web") / "page"

    def joined(names: Iterable[str]) -> str:
        text = "".join((where / each).read_text("utf-8") for each in names)
        return FOR_PEOPLE.sub("", text)

    style, script = joined(styles), joined(scripts)
    html = joined([name]).replace("/*STYLE*/", style).replace("/*SCRIPT*/", script)
    headers = {
        "Content-Type": "text/html; charset=utf-8",
        "Content-Security-Policy": "default-src 'none'; connect-src 'self'; img-src 'self' blob: "
        f"data:; media-src 'self' blob:; style-src {_hash(style)}; script-src {_hash(script)}; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
        "Permissions-Policy": "camera=(self), microphone=(), geolocation=()",
        "Referrer-Policy": "no-referrer",
        "X-Content-Type-Options": "nosniff",
        "Cache-Control": "no-store",
    }
    return Document(html.encode(), headers)


@lru_cache(maxsize=1)
def page() -> Document:
    """Return the page that plays."""
    return document("page.html", ["page.css"], SCRIPTS)


def _hash(text: str) -> str:
    digest = hashlib.sha256(text.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"
