"""What a browser loads of each page: its document, which loads nothing else."""

from cubeling.app.running.wizard.desk import desk_page
from cubeling.app.ui.web.page import Documents, page, view_page


def pages() -> dict[str, Documents]:
    """Return the page of each role, in its languages."""
    roles: dict[str, Documents] = dict.fromkeys(("play", "window", "camera"), page())
    return {**roles, "view": view_page(), "study": page(study=True), "desk": desk_page()}


def sizes() -> dict[str, int]:
    """Return the size of the page of each role, in the language in which it is larger [B]."""
    return {
        role: max(len(each.body) for each in documents.values())
        for role, documents in pages().items()
    }
