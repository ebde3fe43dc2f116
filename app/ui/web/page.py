"""The documents that a browser gets: each is one file that loads nothing from elsewhere."""

import base64
import hashlib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources

HTML = "text/html; charset=utf-8"

MAX_PAGE_BYTES = 30_000
"""Size of a page [B]: it is there at once on any network."""

SCRIPT_FILES = ("base.js", "words.js", "link.js", "picture.js", "camera.js", "sound.js", "touch.js")
"""The parts of the script of the page that plays, in their order."""

FOR_PEOPLE = re.compile(r"^\s+|^(//.*|/\*.*\*/)\n", re.MULTILINE)
"""What a browser does not need: indents, and lines that are comments."""


@dataclass(frozen=True)
class Document:
    """A page in HTML, and what is sent with it."""

    body: bytes
    """It, in UTF-8, with its style and its script in it."""

    headers: Mapping[str, str]
    """Of HTTP: it runs its own script only, and nothing frames it."""


def document(name: str, styles: Iterable[str], scripts: Iterable[str]) -> Document:
    """Return a document made of files of the folder `page`.

    In the HTML file `name`, the styles go where it says /*STYLE*/, the scripts where /*SCRIPT*/.
    """
    style, script = _joined(styles), _joined(scripts)
    html = _joined([name]).replace("/*STYLE*/", style).replace("/*SCRIPT*/", script)
    policy = (
        "default-src 'none'; connect-src 'self'; img-src blob: data:; media-src blob:; "
        f"style-src {_hash(style)}; script-src {_hash(script)}; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
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


@lru_cache(maxsize=2)
def page(*, study: bool = False) -> Document:
    """Return the page that plays; with a study, also that on which its questions are."""
    if not study:
        return document("page.html", ["base.css", "page.css"], SCRIPT_FILES)
    styles = ["base.css", "page.css", "study.css"]
    return document("page.html", styles, [*SCRIPT_FILES, "study.js"])


def _joined(names: Iterable[str]) -> str:
    folder = resources.files("cubeling.app.ui.web") / "page"
    return FOR_PEOPLE.sub("", "".join((folder / each).read_text("utf-8") for each in names))


def _hash(text: str) -> str:
    digest = hashlib.sha256(text.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"
