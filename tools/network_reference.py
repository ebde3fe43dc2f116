"""What the document of the topic tree takes from the code.

`python -m tools.network_reference` renews it; a test compares.
"""

import re
from pathlib import Path

from robot.network.messages import KINDS, RETAINED
from robot.network.schema import table

DOCUMENT = Path(__file__).parents[1] / "docs" / "many.md"
"""The document."""


def topics() -> str:
    """Return the table of topics, and one of fields for every message."""
    lines = ["| topic | retained | message |", "|---|---|---|"]
    for (role, kind), form in KINDS.items():
        kept = "yes" if kind in RETAINED else "no"
        says = (form.__doc__ or "").strip().splitlines()[0]
        lines.append(f"| `cubeling/1/SITE/{role}/NAME/{kind}` | {kept} | {says} |")
    sections: dict[str, list[str]] = {}
    for (role, kind), form in KINDS.items():
        sections.setdefault(table(form), []).append(f"`{role}/NAME/{kind}`")
    for fields, names in sections.items():
        lines += ["", f"### {', '.join(names)}", "", fields]
    return "\n".join(lines)


def renewed(text: str) -> str:
    """Return the document with what is drawn from the code as the code has it now."""
    return re.sub(
        r"(<!-- topics: drawn from the code -->\n).*?(<!-- end of topics -->)",
        lambda found: f"{found[1]}{topics()}\n{found[2]}",
        text,
        flags=re.DOTALL,
    )


if __name__ == "__main__":
    DOCUMENT.write_text(renewed(DOCUMENT.read_text("utf-8")), "utf-8")
