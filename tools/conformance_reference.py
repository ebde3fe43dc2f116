"""Update the table of checks in docs/conformance.md: `python -m tools.conformance_reference`."""

import re
from pathlib import Path

from robot.conformance.suite import GROUPS

DOCUMENT = Path(__file__).parents[1] / "docs" / "conformance.md"
"""The document about the conformance tests; only in the source tree."""

BEGIN, END = "<!-- checks: generated from the code -->", "<!-- end of checks -->"


def checks_table() -> str:
    """Return a heading and a table for every group of checks."""
    parts = []
    for group in GROUPS:
        rows = []
        for check in group:
            star = "" if check.level == "must" else " \\*"
            rows.append(f"| {check.name}{star} | {check.requires} |")
        sections = sorted({check.section for check in group})
        word = "section" if len(sections) == 1 else "sections"
        head = f"### {group.title} ({word} {', '.join(map(str, sections))})"
        parts.append("\n".join([head, "", "| check | requirement |", "|---|---|", *rows]))
    return "\n\n".join(parts)


def renewed(document: str) -> str:
    """Return the document with its table generated from the code."""
    pattern = re.compile(re.escape(BEGIN) + ".*?" + re.escape(END), re.DOTALL)
    if len(pattern.findall(document)) != 1:
        raise ValueError(f"{DOCUMENT.name} must have one part marked {BEGIN!r}")
    return pattern.sub(lambda _: f"{BEGIN}\n{checks_table()}\n{END}", document)


if __name__ == "__main__":
    DOCUMENT.write_text(renewed(DOCUMENT.read_text("utf-8")), "utf-8")
