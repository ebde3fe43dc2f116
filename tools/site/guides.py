"""The Markdown pages of the repository as HTML, at the same paths, so that their links hold.

A link to another file of the repository leads to a page that shows it: a source file with its
colours, a folder as a list. Only what a page links to is in the site.
"""

import html
import os
import shutil
from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from string import Template
from urllib.parse import unquote, urlsplit

from markdown_it import MarkdownIt
from markdown_it.token import Token

from tools.site.highlighting import code_colours, colour_code

DESIGN = Path(__file__).parent

HOME, INDEX = "README.md", "docs/README.md"
"""The first page, and the page that puts all others in groups."""

HERE = ' aria-current="page"'
"""Marks the page that is shown in the list of all."""

PICTURES = (".jpg", ".png", ".svg")


class Guides:
    """Makes the pages of a repository, beginning with its first.

    Parameters
    ----------
    root
        The repository.
    folder
        Where the pages are written.
    """

    def __init__(self, root: Path, folder: Path) -> None:
        self._root, self._folder = root, folder
        self._markdown = MarkdownIt("commonmark", {"highlight": _highlight}).enable("table")
        self._template = Template((DESIGN / "page.html").read_text("utf-8"))
        self._asked = [HOME, INDEX]

    def make(self) -> int:
        """Write all pages that can be reached, and what they show; return how many there are."""
        self._folder.mkdir(parents=True)
        style = (DESIGN / "style.css").read_text("utf-8") + code_colours("pre")
        (self._folder / "style.css").write_text(style, "utf-8")
        for name in self._asked:  # grows meanwhile, by what each page links to
            self._make(name)
        return len(self._asked)

    def _make(self, name: str) -> None:
        source, target = self._root / name, self._folder / _place(self._root, name)
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            self._write(name, name, self._listing(name))
        elif source.suffix == ".md":
            tokens = self._markdown.parse(source.read_text("utf-8"))
            title, contents = _name_headings(tokens)
            self._translate_links(tokens, name)
            body = self._markdown.renderer.render(tokens, self._markdown.options, {})
            self._write(name, title or name, _box_tables(body), contents)
        elif source.suffix in PICTURES:
            shutil.copyfile(source, target)
        else:
            text = source.read_text("utf-8")
            code = colour_code(text, file=name) or html.escape(text)
            self._write(name, name, f"<h1>{source.name}</h1><pre><code>{code}</code></pre>")

    def _translate_links(self, tokens: Sequence[Token], name: str) -> None:
        """Let the links of a page lead to the pages of this site."""
        for token in tokens:
            self._translate_links(token.children or (), name)
            for attribute in ("href", "src"):
                link = token.attrGet(attribute)
                if link is not None:
                    token.attrSet(attribute, self._translate(str(link), name))

    def _translate(self, link: str, name: str) -> str:
        """Return where a link of a page leads in the site, and note what has to be there."""
        parts = urlsplit(link)
        if parts.scheme or parts.netloc or not parts.path:
            return link
        path = os.path.normpath(Path(name).parent / unquote(parts.path))
        if not (self._root / path).exists() or path.startswith(".."):
            return link  # which the check of links finds
        if (self._root / path / HOME).exists():
            path = os.path.normpath(Path(path) / HOME)
        if path not in self._asked:
            self._asked.append(path)
        return self._link(name, path) + (f"#{parts.fragment}" if parts.fragment else "")

    def _link(self, page: str, path: str) -> str:
        start = _place(self._root, page).parent
        return Path(os.path.relpath(_place(self._root, path), start)).as_posix()

    def _listing(self, name: str) -> str:
        """Return the files of a folder as a list; pictures are shown."""
        items = []
        for file in sorted((self._root / name).iterdir()):
            if file.name.startswith((".", "__pycache__")) or file.is_dir():
                continue
            link = self._translate(file.name, f"{name}/index.html")
            shown = f'<img src="{link}" alt="">' if file.suffix in PICTURES else ""
            items.append(f'<li><a href="{link}">{html.escape(file.name)}</a>{shown}</li>')
        return f"<h1>{html.escape(name)}</h1><ul>{''.join(items)}</ul>"

    @cached_property
    def _groups(self) -> list[tuple[str, list[tuple[str, str]]]]:
        """The groups of the index, each with the names and paths of its pages."""
        groups: list[tuple[str, list[tuple[str, str]]]] = []
        tokens = self._markdown.parse((self._root / INDEX).read_text("utf-8"))
        for before, token in pairwise(tokens):
            if before.type == "heading_open" and before.tag == "h2":
                groups.append((token.content, []))
            parts = token.children or []
            if groups and len(parts) > 1 and parts[0].type == "link_open":
                path = os.path.normpath(Path(INDEX).parent / str(parts[0].attrGet("href")))
                groups[-1][1].append((parts[1].content, path))
        return groups

    def _write(
        self, name: str, title: str, body: str, contents: Sequence[tuple[str, str]] = ()
    ) -> None:
        groups = []
        for group, pages in self._groups:
            items = "".join(
                f'<li><a href="{self._link(name, path)}"{HERE if path == name else ""}>'
                f"{html.escape(text)}</a></li>"
                for text, path in pages
            )
            groups.append(f"<h2>{html.escape(group)}</h2><ul>{items}</ul>")
        places = "".join(f'<li><a href="#{place}">{text}</a></li>' for text, place in contents)
        up = "../" * (len(_place(self._root, name).parts) - 1)
        page = self._template.substitute(
            title=html.escape(title),
            up=up,
            groups="".join(groups),
            contents=f"<h2>On this page</h2><ul>{places}</ul>" if len(contents) > 1 else "",
            body=body,
        )
        (self._folder / _place(self._root, name)).write_text(page, "utf-8")


def _place(root: Path, name: str) -> Path:
    """Return the path in the site of what is shown for a file or a folder."""
    path = Path(name)
    if (root / path).is_dir():
        return path / "index.html"
    if path.name == HOME:
        return path.parent / "index.html"
    if path.suffix in PICTURES:
        return path
    return (
        path.with_suffix(".html") if path.suffix == ".md" else path.with_name(f"{path.name}.html")
    )


def _name_headings(tokens: Sequence[Token]) -> tuple[str, list[tuple[str, str]]]:
    """Name the headings as GitHub does; return the title, and the second headings with names."""
    title, contents, names = "", [], dict[str, int]()
    for before, token in pairwise(tokens):
        if before.type != "heading_open":
            continue
        text = "".join(each.content for each in token.children or ())
        kept = "".join(c for c in text.lower() if c.isalnum() or c in " -_")
        name = kept.replace(" ", "-")
        count = names.get(name, 0)
        names[name] = count + 1
        before.attrSet("id", f"{name}-{count}" if count else name)
        if before.tag == "h1":
            title = title or text
        elif before.tag == "h2":
            contents.append((html.escape(text), str(before.attrGet("id"))))
    return title, contents


def _highlight(code: str, language: str, _attributes: str) -> str:
    return colour_code(code, language) or "" if language else ""


def _box_tables(body: str) -> str:
    """Put tables into boxes of their own, which scroll where the screen is narrow."""
    return body.replace("<table>", '<div class="table"><table>').replace(
        "</table>", "</table></div>"
    )
