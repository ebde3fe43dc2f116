"""Update the table of checks in docs/conformance.md: `python -m tools.conformance_reference`."""

from pathlib import Path

from cubeling.robot.conformance.suite import GROUPS
from tools.marked_parts import replace_part

DOCUMENT = Path(__file__).parents[1] / "docs" / "conformance.md"
"""The document about the conformance tests; only in the source tree."""


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


def updated(document: str) -> str:
    """Return the document with its table updated."""
    return replace_part(document, "checks", checks_table())


if __name__ == "__main__":
    DOCUMENT.write_text(updated(DOCUMENT.read_text("utf-8")), "utf-8")
