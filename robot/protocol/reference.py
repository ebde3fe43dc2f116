"""The parts of PROTOCOL.md that are drawn from the code.

`python -m robot.protocol.reference` renews them.
A test compares the document with the code, so neither can drift.
"""

import re
from pathlib import Path

from robot.protocol import messages as m
from robot.protocol import timing
from robot.protocol.schema import FORMS, HEADER, FieldForm, MessageForm, pack
from robot.protocol.wire import MAX_BODY, MAX_FRAME, encode_frame

DOCUMENT = Path(__file__).parents[1] / "PROTOCOL.md"
"""The protocol's document."""

VECTORS: tuple[tuple[int, object], ...] = (
    (1, m.Hello(1, 0x12345678)),
    (1, m.Ask(m.ITEM_MOTION, 2)),
    (1, m.Beat(513)),
    (0xABCD, m.Express(1, 0.8, -0.25, 1)),
    (0xABCD, m.Express(2, 0.0, 0.0)),
    (0xABCD, m.Play(3, m.ITEM_SOUND, 0)),
    (0xABCD, m.Stop(4)),
    (0xABCD, m.Bye()),
    (1, m.Welcome(1, 0, 0xBEEF, 14, 8, 6, 3, "Dino", "simulator 1")),
    (1, m.Joint(8, -0.262, 0.262, 0.349, "torso")),
    (1, m.Name(m.ITEM_MOOD, 1, "happy")),
    (
        0xABCD,
        m.State(513, 4, m.STILL, 0.8, -0.25, 0.5, 1, m.NOTHING, 1, (0.0, -1.571, *[0.0] * 14)),
    ),
    (0xABCD, m.Ack(4, m.TAKEN)),
    (7, m.Gone()),
)
"""Sessions and messages whose frames the document shows."""

_RULES = {
    "BEAT_EVERY": "the host sends BEAT",
    "STATE_EVERY": "the robot sends STATE of its own accord if it has not for this long",
    "FAILSAFE_AFTER": "silence of the host after which a robot should act",
    "FAILSAFE_PROMISE": "silence of the host after which a robot must have acted",
    "DEGRADED_AFTER": "silence of the robot: the link is degraded",
    "LOST_AFTER": "silence of the robot: the link is lost, and HELLO is sent again",
    "HELLO_EVERY": "between two HELLOs without an answer",
    "RETRY_FIRST": "before a repeat, while no round trip is known",
    "RETRY_MIN": "before a repeat, at least",
    "RETRY_MAX": "before a repeat, at most",
    "GONE_EVERY": "between two GONEs, at least",
}


def message_tables() -> str:
    """Return a section for every message, with a table of its fields."""
    return "\n\n".join(_section(FORMS[number]) for number in sorted(FORMS))


def timing_table() -> str:
    """Return the table of all times."""
    rows = [f"| {1000 * getattr(timing, name):.0f} | {rule} |" for name, rule in _RULES.items()]
    return "\n".join(["| ms | what |", "|---:|---|", *rows])


def limits_table() -> str:
    """Return the table of all sizes and counts."""
    rows = {
        "version described here": timing.VERSION,
        "bytes of a body": MAX_BODY,
        "bytes of a frame between its edges": MAX_FRAME,
        "bytes of a name": 16,
        "joints": m.JOINTS_MAX,
        "motions, sounds, moods, each": 254,
        "sends of one command": timing.TRIES_MAX,
        "actions waiting in the host": timing.ACTIONS_MAX,
    }
    lines = [f"| {what} | {value} |" for what, value in rows.items()]
    return "\n".join(["| at most | |", "|---|---:|", *lines])


def vectors() -> str:
    """Return every test vector: the message and the bytes of its frame."""
    lines = []
    for session, content in VECTORS:
        lines += [f"{content} in session {session}", f"    {_hex(session, content)}", ""]
    return "```\n" + "\n".join(lines).rstrip() + "\n```"


def renewed(document: str) -> str:
    """Return the document with every part between its marks drawn anew."""
    parts = {
        "messages": message_tables(),
        "timing": timing_table(),
        "limits": limits_table(),
        "vectors": vectors(),
    }
    for name, text in parts.items():
        begin, end = f"<!-- {name}: drawn from the code -->", f"<!-- end of {name} -->"
        pattern = re.compile(re.escape(begin) + ".*?" + re.escape(end), re.DOTALL)
        count = len(pattern.findall(document))
        if count != 1:
            raise ValueError(f"{DOCUMENT.name} must have one part marked {name!r}, not {count}")
        document = pattern.sub(f"{begin}\n{text}\n{end}", document)
    return document


def _section(form: MessageForm) -> str:
    sizes = [f"{form.size} bytes"]
    sizes += [f"{part.end} since version {part.since}" for part in form.parts[1:]]
    head = f"#### `{form.number:02X}` {form.name}, from the {form.sender}, {', '.join(sizes)}"
    lines = [head, "", form.meaning]
    if form.fields:
        lines += [
            "",
            "| offset | type | field | unit | allowed | meaning |",
            "|---:|---|---|---|---|---|",
        ]
        offset = HEADER.size
        for field in form.fields:
            lines.append(_row(offset, field))
            offset += field.size
    return "\n".join(lines)


def _row(offset: int, field: FieldForm) -> str:
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
    return f"| {offset} | {field.form} | {field.name} | {unit} | {allowed} | {meaning} |"


def _hex(session: int, content: object) -> str:
    return encode_frame(pack(content, session)).hex(" ")


if __name__ == "__main__":
    DOCUMENT.write_text(renewed(DOCUMENT.read_text("utf-8")), "utf-8")
