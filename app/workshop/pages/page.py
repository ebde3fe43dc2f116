"""A report as one page of HTML that needs nothing else: no scripts, no other files."""

import base64
from collections.abc import Sequence
from html import escape

from cubeling.app.workshop.pages.report_table import ReportTable

STYLE = """
:root {
  --ink: #1f2430; --quiet: #667085; --line: #d7dbe3; --fill: #f5f7fa; --box: #bcd4f2;
  --dark: #2b5c9e; --warn: #fff4d6;
}
* { box-sizing: border-box; }
body {
  font: 16px/1.5 system-ui, sans-serif; color: var(--ink); max-width: 60rem; margin: 2rem auto;
  padding: 0 1.25rem;
}
h1 { font-size: 1.7rem; line-height: 1.25; margin: 0 0 .5rem; }
h2 {
  font-size: 1.25rem; margin: 2.5rem 0 .75rem; padding-top: .75rem;
  border-top: 1px solid var(--line);
}
h3 { font-size: 1rem; margin: 1.5rem 0 .5rem; }
p { max-width: 46rem; }
.warning {
  background: var(--warn); border-left: 4px solid #d69a00; padding: .6rem 1rem; margin: 1rem 0;
}
.wide { overflow-x: auto; }
table {
  border-collapse: collapse; margin: .5rem 0; font-size: .93rem;
  font-variant-numeric: tabular-nums;
}
caption { text-align: left; font-weight: 600; padding: .25rem 0; }
th, td {
  text-align: right; padding: .3rem .75rem; border-bottom: 1px solid var(--line);
  white-space: nowrap;
}
th:first-child, td:first-child {
  text-align: left; padding-left: 0; white-space: normal; min-width: 9rem;
}
.words td { text-align: left; white-space: normal; overflow-wrap: anywhere; }
.words th { text-align: left; }
.words td:first-child { font-weight: 600; min-width: 8rem; overflow-wrap: normal; }
thead th { border-bottom: 2px solid var(--ink); font-weight: 600; white-space: normal; }
th.quiet, td.quiet { color: var(--quiet); }
figure { margin: 1rem 0; }
figcaption { color: var(--quiet); font-size: .9rem; }
.note { color: var(--quiet); font-size: .9rem; margin: .25rem 0 1rem; }
svg { width: 100%; max-width: 45rem; height: auto; display: block; margin: .5rem 0; }
svg text { font: 13px system-ui, sans-serif; fill: var(--ink); }
svg .tick { text-anchor: middle; fill: var(--quiet); }
svg .name { text-anchor: end; }
svg .title { font-weight: 600; }
svg .band { fill: #f3c9c4; }
svg .grid { stroke: var(--line); }
svg .whisker { stroke: var(--dark); stroke-width: 1.5; }
svg .box { fill: var(--box); stroke: var(--dark); }
svg .median { stroke: var(--dark); stroke-width: 3; }
svg .point { fill: var(--dark); fill-opacity: .45; }
.pictures { display: flex; flex-wrap: wrap; gap: .5rem; }
.pictures figure { margin: 0; font-size: .85rem; color: var(--quiet); }
.pictures img { display: block; width: 14rem; border-radius: 4px; }
@media print {
  body { margin: 0; max-width: none; }
  h2 { break-after: avoid; }
  table, svg { break-inside: avoid; }
}
"""


def page(title: str, parts: Sequence[str]) -> str:
    """Return a page with a title, from parts that are HTML already."""
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n"
        + "\n".join(parts)
        + "\n</body>\n</html>\n"
    )


def paragraph(text: str, kind: str = "") -> str:
    """Return a paragraph of plain text, of a class of `STYLE`."""
    marked = f' class="{kind}"' if kind else ""
    return f"<p{marked}>{escape(text)}</p>"


def heading(text: str, level: int = 2) -> str:
    """Return a heading of plain text; level 1 is the title of the page."""
    return f"<h{level}>{escape(text)}</h{level}>"


def items(lines: Sequence[str]) -> str:
    """Return a list with a bullet for each line of plain text."""
    return "<ul>" + "".join(f"<li>{escape(line)}</li>" for line in lines) + "</ul>"


def table(content: ReportTable, *, words: bool = False, quiet: str = "") -> str:
    """Return a table that scrolls by itself where it is wider than the page.

    With `words`, its cells are texts that wrap, not figures. Columns whose heading begins with
    `quiet` are grey; none if it is empty.
    """
    grey = [
        ' class="quiet"' if quiet and column.startswith(quiet) else "" for column in content.columns
    ]
    head = "".join(
        f'<th scope="col"{kind}>{escape(column)}</th>'
        for kind, column in zip(grey, content.columns, strict=True)
    )
    if not any(content.columns):
        head = ""
    body = "".join(
        "<tr>"
        + "".join(f"<td{kind}>{escape(cell)}</td>" for kind, cell in zip(grey, row, strict=True))
        + "</tr>"
        for row in content.rows
    )
    kind = ' class="words"' if words else ""
    note = paragraph(content.note, "note") if content.note else ""
    return (
        f'<div class="wide"><table{kind}><caption>{escape(content.title)}</caption>'
        f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>{note}"
    )


def pictures(shown: Sequence[tuple[bytes, str]]) -> str:
    """Return JPEG pictures with their captions, which the page holds itself."""
    figures = "".join(
        f'<figure><img alt="{escape(caption, quote=True)}" '
        f'src="data:image/jpeg;base64,{base64.b64encode(data).decode()}">'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
        for data, caption in shown
    )
    return f'<div class="pictures">{figures}</div>'
