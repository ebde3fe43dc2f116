"""Generates parts of PROTOCOL.md, the C header and the test vectors from the message table.

`python -m tools.protocol_reference` writes them; a test compares them with the code.
"""

from pathlib import Path

from cubeling.robot.protocol import messages as m, timing
from cubeling.robot.protocol.fields import FieldSpec
from cubeling.robot.protocol.schema import HEADER, MESSAGES, MessageSpec
from cubeling.robot.protocol.wire import MAX_BODY, MAX_FRAME
from tools.marked_parts import replace_part
from tools.protocol_c_header import header
from tools.protocol_vectors import VECTORS, vectors_file

DOCUMENT = Path(__file__).parents[1] / "robot" / "PROTOCOL.md"
"""The protocol's document."""

HEADER_FILE = Path(__file__).parents[1] / "robot" / "protocol" / "c" / "cubeling_messages.h"
"""The messages for C."""

VECTORS_FILE = Path(__file__).parents[1] / "robot" / "protocol" / "vectors.json"
"""The test vectors for programs."""


def message_tables() -> str:
    """Return a section for every message, with a table of its fields."""
    return "\n\n".join(_section(MESSAGES[number]) for number in sorted(MESSAGES))


def timing_table() -> str:
    """Return the table of all times."""
    rows = [
        f"| {1000 * getattr(timing, name):.0f} | {rule} |"
        for name, rule in timing.RULE_DESCRIPTIONS.items()
    ]
    return "\n".join(["| ms | what |", "|---:|---|", *rows])


def limits_table() -> str:
    """Return the table of all sizes and counts."""
    rows = {
        "version described here": timing.VERSION,
        "bytes of a body": MAX_BODY,
        "bytes of a frame between its edges": MAX_FRAME,
        "bytes of a name": 16,
        "bytes of a line of the log": 80,
        "joints": m.JOINTS_MAX,
        "motions, sounds, moods, each": 254,
        "sends of one command": timing.TRIES_MAX,
        "actions waiting in the host": timing.ACTIONS_MAX,
    }
    lines = [f"| {what} | {value} |" for what, value in rows.items()]
    return "\n".join(["| at most | |", "|---|---:|", *lines])


def results_table() -> str:
    """Return the table of the results of a command."""
    rows = [f"| {code} | refused: {words} |" for code, words in m.REFUSALS.items()]
    return "\n".join(["| result | |", "|---:|---|", "| 0 | taken |", *rows])


def vectors() -> str:
    """Return every test vector: the message and the bytes of its frame."""
    lines = []
    for vector in VECTORS:
        older = "" if vector.version == timing.VERSION else f", version {vector.version}"
        title = f"{vector.content} in session {vector.session}{older}"
        lines += [title, f"    {vector.frame.hex(' ')}", ""]
    return "```\n" + "\n".join(lines).rstrip() + "\n```"


def updated(document: str) -> str:
    """Return the document with every generated part updated."""
    parts = {
        "messages": message_tables(),
        "timing": timing_table(),
        "limits": limits_table(),
        "results": results_table(),
        "vectors": vectors(),
    }
    for name, text in parts.items():
        document = replace_part(document, name, text)
    return document


def _section(spec: MessageSpec) -> str:
    sizes = [f"{spec.size} bytes"]
    sizes += [f"{part.end} since version {part.since}" for part in spec.parts[1:]]
    sizes += [f"since version {spec.since}"] if spec.since > 1 else []
    head = f"#### `{spec.number:02X}` {spec.name}, from the {spec.sender}, {', '.join(sizes)}"
    lines = [head, "", spec.meaning]
    if spec.fields:
        lines += [
            "",
            "| offset | type | field | unit | allowed | meaning |",
            "|---:|---|---|---|---|---|",
        ]
        offset = HEADER.size
        for field in spec.fields:
            lines.append(_row(offset, field))
            offset += field.size
    return "\n".join(lines)


def _row(offset: int, field: FieldSpec) -> str:
    unit = {1: field.unit, 1e-3: f"m{field.unit}", 1e-4: "1/10000"}[field.scale]
    low, high = field.low, field.high
    allowed = ""
    if low is not None and high is not None:
        allowed = f"{low / field.scale:.0f} … {high / field.scale:.0f}"
    elif low is not None:
        allowed = f"≥ {low:g}"
    elif high is not None:
        allowed = f"≤ {high:g}"
    since = "" if field.since == 1 else f" (since version {field.since})"
    meaning = field.meaning + since
    return f"| {offset} | {field.wire_type} | {field.name} | {unit} | {allowed} | {meaning} |"


def generated_files() -> dict[Path, str]:
    """Return every file that is generated, as a whole or in parts, and its content."""
    return {
        DOCUMENT: updated(DOCUMENT.read_text("utf-8")),
        HEADER_FILE: header(),
        VECTORS_FILE: vectors_file(),
    }


if __name__ == "__main__":
    for path, text in generated_files().items():
        path.write_text(text, "utf-8")
