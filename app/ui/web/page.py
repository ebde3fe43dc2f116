"""The page: one document, made of its parts, that loads nothing from elsewhere."""

import base64
import hashlib
from functools import lru_cache
from importlib import resources

MAX_PAGE_BYTES = 30_000
"""Size of the page [B]: it is there at once on any network."""


def _part(name: str) -> str:
    return (resources.files("cubeling.app.ui.web") / "page" / name).read_text("utf-8")


@lru_cache(maxsize=1)
def page() -> bytes:
    """Return the page in UTF-8, with its style and its script in it."""
    document = _part("page.html")
    for place, name in (("/*STYLE*/", "page.css"), ("/*SCRIPT*/", "page.js")):
        document = document.replace(place, _part(name))
    return document.encode()


def _hash(name: str) -> str:
    return (
        "'sha256-" + base64.b64encode(hashlib.sha256(_part(name).encode()).digest()).decode() + "'"
    )


@lru_cache(maxsize=1)
def page_headers() -> dict[str, str]:
    """Return the headers of the document: it runs its own script only, and nothing frames it."""
    return {
        "Content-Security-Policy": "default-src 'none'; connect-src 'self'; img-src 'self' blob: "
        f"data:; media-src 'self' blob:; style-src {_hash('page.css')}; "
        f"script-src {_hash('page.js')}; base-uri 'none'; form-action 'none'; "
        "frame-ancestors 'none'",
        "Permissions-Policy": "camera=(self), microphone=(), geolocation=()",
        "Referrer-Policy": "no-referrer",
        "X-Content-Type-Options": "nosniff",
        "Cache-Control": "no-store",
    }
