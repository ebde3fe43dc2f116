"""The page of the desk: one document, made of its parts, that loads nothing from elsewhere."""

from functools import lru_cache
from importlib import resources

from cubeling.app.ui.local_pages import HTML, PageReply
from cubeling.app.ui.page_document import assembled


@lru_cache(maxsize=1)
def desk_page() -> PageReply:
    """Return the page, which runs its own script only."""
    folder = resources.files("cubeling.app.running.wizard") / "assets"
    document, policy = assembled(
        folder, "desk.html", ["desk.css"], ["desk.js"], loads="img-src 'self'"
    )
    return PageReply(HTML, document.encode(), policy)
