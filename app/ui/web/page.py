"""The documents that a browser gets: each is one file that loads nothing from elsewhere."""

import base64
import hashlib
import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from cubeling.app.ui.web.language import LANGUAGES, PAGE_FOLDER
from cubeling.toml_file import bundled

HTML = "text/html; charset=utf-8"

MAX_PAGE_BYTES = 30_000
"""Size of a page [B]: it is there at once on any network."""

FOR_PEOPLE = re.compile(r"^\s+|^(//.*|/\*[^*]*\*/)\n| // .*$", re.MULTILINE)
"""What a browser does not need: indents and comments."""

PLACED = re.compile(r"\{\{(\w+)(?:: ([\w ]+))?\}\}")
"""Where HTML has a word of the page's language, or icons: {{picture}}, {{icons: go again}}."""


@dataclass(frozen=True)
class Document:
    """A page in HTML, and what is sent with it."""

    body: bytes
    """It, in UTF-8, with its style and its script in it."""

    headers: Mapping[str, str]
    """Of HTTP: it runs its own script only, and nothing frames it."""


Documents = Mapping[str, Document]
"""A page in each of `LANGUAGES`, by its code."""


def document(
    name: str, styles: Iterable[str], scripts: Iterable[str], words: Iterable[str] = ()
) -> Documents:
    """Return a document made of files of the folder `page`, in each language.

    In the HTML file `name`, the styles go where it says /*STYLE*/, the scripts where /*SCRIPT*/.
    `words` are tables of `words.toml`: the script has them as `T`, and the HTML places them.
    """
    html, style, script = _joined([name]), _joined(styles), _joined(scripts)
    tables = bundled(PAGE_FOLDER / "words.toml")
    known = {key: word for table in words for key, word in tables[table].items()}
    return {
        language: _document(
            html, style, script, language, {key: each[language] for key, each in known.items()}
        )
        for language in LANGUAGES
    }


def _document(html: str, style: str, script: str, language: str, words: dict[str, Any]) -> Document:
    def place(found: re.Match[str]) -> str:
        if found[1] == "icons":
            return _icons(found[2].split())
        return language if found[1] == "language" else str(words[found[1]])

    said = json.dumps(words, ensure_ascii=False, separators=(",", ":"))
    script = f'"use strict";\nconst LANGUAGE = "{language}", T = {said};\n{script}'
    html = PLACED.sub(place, html).replace("/*STYLE*/", style).replace("/*SCRIPT*/", script)
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
def page(*, study: bool = False) -> Documents:
    """Return the page that plays; in a study, the one that asks, and on which tasks are played."""
    own = "study" if study else "play"
    return document(
        f"{own}.html",
        ["base.css", "picture.css", "page.css", f"{own}.css"],
        ["base.js", "link.js", "picture.js", "sound.js", "camera.js", "touch.js", f"{own}.js"],
        ["view", "page", own],
    )


@lru_cache(maxsize=1)
def view_page() -> Documents:
    """Return the page that only shows the picture, as for OBS or a projector."""
    scripts = ["base.js", "link.js", "picture.js", "sound.js", "view.js"]
    return document("view.html", ["base.css", "picture.css"], scripts, ["view"])


def _read(name: str) -> str:
    return (PAGE_FOLDER / name).read_text("utf-8")


def _joined(names: Iterable[str]) -> str:
    return FOR_PEOPLE.sub("", "".join(map(_read, names)))


def _icons(names: Iterable[str]) -> str:
    """Return the lines of the named icons, in their order: one may use one that is above it."""
    found = {
        line.partition('"')[2].partition('"')[0]: line for line in _read("icons.svg").splitlines()
    }
    return "\n".join(found[f"i-{name}"] for name in names)


def _hash(text: str) -> str:
    digest = hashlib.sha256(text.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"
