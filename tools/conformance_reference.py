"""The table of checks in docs/conformance.md: `python -m tools.conformance_reference` renews it."""

import re
from pathlib import Path

from robot.conformance.suite import CHAPTERS

DOCUMENT = Path(__file__).parents[1] / "docs" / "conformance.md"
"""The document for those who test a robot; it is in the source tree only."""

BEGIN, END = "<!-- checks: drawn from the code -->", "<!-- end of checks -->"


def checks_table() -> str:
    """Return a heading and a table for every chapter of checks."""
    parts = []
    for chapter in CHAPTERS:
        rows = []
        for check in chapter:
            star = "" if check.level == "must" else " \\*"
            rows.append(f"| {check.name}{star} | {check.requires} |")
        sections = sorted({check.section for check in chapter})
        word = "section" if len(sections) == 1 else "sections"
        head = f"### {chapter.title} ({word} {', '.join(map(str, sections))})"
        parts.append("\n".join([head, "", "| check | what is required |", "|---|---|", *rows]))
    return "\n\n".join(parts)


def renewed(document: str) -> str:
    """Return the document with its table drawn anew."""
    pattern = re.compile(re.escape(BEGIN) + ".*?" + re.escape(END), re.DOTALL)
    if len(pattern.findall(document)) != 1:
        raise ValueError(f"{DOCUMENT.name} must have one part marked {BEGIN!r}")
    return pattern.sub(lambda _: f"{BEGIN}\n{checks_table()}\n{END}", document)


if __name__ == "__main__":
    DOCUMENT.write_text(renewed(DOCUMENT.read_text("utf-8")), "utf-8")
