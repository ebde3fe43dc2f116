"""Update the tables of topics and messages in docs/many.md from the code.

`python -m tools.network_reference` writes them; a test compares them with the code.
"""

from pathlib import Path
from typing import Any

import msgspec

from cubeling.robot.network.messages import MAX_TEXT_BYTES, MESSAGE_TYPES, RETAINED_KINDS
from tools.marked_parts import replace_part

DOCUMENT = Path(__file__).parents[1] / "docs" / "many.md"
"""The document."""


def topics() -> str:
    """Return the table of topics, and a table of fields for every message."""
    lines = ["| topic | retained | message |", "|---|---|---|"]
    sections: dict[type[Any], list[str]] = {}
    for (role, kind), message_type in MESSAGE_TYPES.items():
        retained = "yes" if kind in RETAINED_KINDS else "no"
        summary = (message_type.__doc__ or "").strip().splitlines()[0]
        lines.append(f"| `cubeling/1/SITE/{role}/NAME/{kind}` | {retained} | {summary} |")
        sections.setdefault(message_type, []).append(f"`{role}/NAME/{kind}`")
    for message_type, names in sections.items():
        lines += ["", f"### {', '.join(names)}", "", fields(message_type)]
    return "\n".join(lines)


def fields(message_type: type[Any]) -> str:
    """Return the table of a message's fields, from its JSON schema."""
    (schema,) = msgspec.json.schema(message_type)["$defs"].values()
    rows = ["| field | type | meaning |", "|---|---|---|"]
    for name, field in schema["properties"].items():
        optional = "" if name in schema["required"] else "; optional"
        rows.append(f"| `{name}` | {type_text(field)}{optional} | {field['description']} |")
    return "\n".join(rows)


def type_text(schema: dict[str, Any]) -> str:
    """Return a JSON schema in words.

    >>> type_text({"type": "number", "minimum": -1, "maximum": 1})
    'number −1 … 1'
    """
    match schema:
        case {"title": title}:
            return str(title)
        case {"anyOf": [first, *_]}:
            return type_text(first)
        case {"enum": [*others, last]}:
            quoted = [f'"{word}"' for word in others]
            return f'{", ".join(quoted)} or "{last}"'
        case {"type": "integer", "minimum": low}:
            return f"integer ≥ {low}"
        case {"type": "number", "minimum": low, "maximum": high}:
            return f"number {low} … {high}".replace("-", "−")
        case {"type": "number", "minimum": low}:
            return f"number ≥ {low}"
        case {"type": "array", "maxItems": most}:
            return f"list of ≤ {most} texts"
        case {"type": "string"}:
            return f"text, ≤ {MAX_TEXT_BYTES} bytes"
        case {"type": "boolean"}:
            return "true or false"
    raise ValueError(f"no words for {schema}")


def updated(document: str) -> str:
    """Return the document with its generated part updated."""
    return replace_part(document, "topics", topics())


if __name__ == "__main__":
    DOCUMENT.write_text(updated(DOCUMENT.read_text("utf-8")), "utf-8")
