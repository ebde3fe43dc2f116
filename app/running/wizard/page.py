"""The page of the desk: one document, made of its parts, that loads nothing from elsewhere."""

import base64
import hashlib
from functools import lru_cache
from importlib import resources

from cubeling.app.ui.local_pages import HTML, PageReply


def _part(name: str) -> str:
    return (resources.files("cubeling.app.running.wizard") / "assets" / name).read_text("utf-8")


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


@lru_cache(maxsize=1)
def desk_page() -> PageReply:
    """Return the page, which runs its own script only."""
    style, script = _part("desk.css"), _part("desk.js")
    document = _part("desk.html").replace("/*STYLE*/", style).replace("/*SCRIPT*/", script)
    policy = (
        f"default-src 'none'; connect-src 'self'; img-src 'self'; style-src {_hash(style)}; "
        f"script-src {_hash(script)}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
    return PageReply(HTML, document.encode(), policy)
