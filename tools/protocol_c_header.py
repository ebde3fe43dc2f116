"""Generates the C header of the messages: structs, pack and unpack functions."""

from robot.protocol import timing
from robot.protocol.fields import INTEGER_LIMITS, FieldSpec
from robot.protocol.messages import JOINTS_MAX, NOTHING
from robot.protocol.schema import HEADER, MESSAGES, MessageSpec, VersionPart

_TYPES = {"u8": "uint8_t", "u16": "uint16_t", "u32": "uint32_t", "i16": "int16_t"}
_TEXT, _ROW = 16, 16  # elements of a text16 and of an i16x16
_INDENT = "    "

_HEAD = """\
/* Messages of the protocol "cubeling" in C99; see robot/PROTOCOL.md.
 *
 * Drawn from robot/protocol/messages.py by `python -m tools.protocol_reference`: change it there.
 *
 * Values stand in the structs as on the wire: whole numbers, in the unit that the comment names.
 * cubeling_pack_NAME writes a body into CUBELING_MAX_BODY bytes, as `version` has it, and returns
 * its size. cubeling_unpack_NAME returns 1, or 0 for a body that is to be skipped: of another
 * message, too short, or with a value out of its range. Fields that the sender's version does not
 * have get their defaults; bytes of a later version are skipped. A text has a zero byte behind it;
 * whether it is UTF-8 is not looked at.
 */
#ifndef CUBELING_MESSAGES_H
#define CUBELING_MESSAGES_H

#include <string.h>

#include "cubeling_frames.h"
"""

_SMALL = """\
static inline void cubeling_put16(uint8_t *at, uint16_t value)
{
    at[0] = (uint8_t)(value & 0xFFu);
    at[1] = (uint8_t)(value >> 8);
}

static inline void cubeling_put32(uint8_t *at, uint32_t value)
{
    cubeling_put16(at, (uint16_t)(value & 0xFFFFu));
    cubeling_put16(at + 2, (uint16_t)(value >> 16));
}

static inline uint16_t cubeling_get16(const uint8_t *at)
{
    return (uint16_t)(at[0] | ((uint16_t)at[1] << 8));
}

static inline uint32_t cubeling_get32(const uint8_t *at)
{
    return cubeling_get16(at) | ((uint32_t)cubeling_get16(at + 2) << 16);
}

static inline int16_t cubeling_get16s(const uint8_t *at)
{
    uint16_t bits = cubeling_get16(at);
    return (int16_t)(bits < 0x8000u ? (int32_t)bits : (int32_t)bits - 0x10000);
}

/* The number and the session of a body of at least CUBELING_HEADER bytes. */
static inline uint8_t cubeling_number(const uint8_t *body) { return body[0]; }
static inline uint16_t cubeling_session(const uint8_t *body) { return cubeling_get16(body + 1); }
"""


def header() -> str:
    """Return the whole header."""
    specs = [MESSAGES[number] for number in sorted(MESSAGES)]
    parts = [_HEAD, _constants(specs), _SMALL, *(_message(spec) for spec in specs), "#endif\n"]
    return "\n".join(parts)


def _constants(specs: list[MessageSpec]) -> str:
    values: dict[str, object] = {
        "VERSION": timing.VERSION,
        "HEADER": HEADER.size,
        "JOINTS_MAX": JOINTS_MAX,
        "NOTHING": NOTHING,
    }
    for name in timing.RULES:
        values[f"{name}_MS"] = round(1000 * getattr(timing, name))
    for spec in specs:
        values[spec.name] = f"0x{spec.number:02X}"
    return "".join(f"#define CUBELING_{name} {value}\n" for name, value in values.items())


def _message(spec: MessageSpec) -> str:
    name = spec.name.lower()
    members = [_member(field) for part in spec.parts for field in part.fields]
    struct = [f"/* {spec.name}, from the {spec.sender}. {spec.meaning} */"]
    if members:
        struct += ["typedef struct {", *members, f"}} cubeling_{name};", ""]
    return "\n".join([*struct, *_pack(spec), "", *_unpack(spec), ""])


def _member(field: FieldSpec) -> str:
    unit = {1.0: field.unit, 1e-3: f"m{field.unit}", 1e-4: "1/10000"}[field.scale]
    since = f", since version {field.since}" if field.since > 1 else ""
    remark = f"{field.meaning}{f' [{unit}]' if unit else ''}{since}"
    if field.wire_type == "text16":
        return f"{_INDENT}char {field.name}[{_TEXT + 1}]; /* {remark} */"
    element = _TYPES[field.wire_type.removesuffix(f"x{_ROW}")]
    row = f"[{_ROW}]" if field.wire_type == f"i16x{_ROW}" else ""
    return f"{_INDENT}{element} {field.name}{row}; /* {remark} */"


def _pack(spec: MessageSpec) -> list[str]:
    name = spec.name.lower()
    fields = any(part.fields for part in spec.parts)
    message = f", const cubeling_{name} *from" if fields else ""
    lines = [
        f"static inline size_t cubeling_pack_{name}(",
        f"{_INDENT}uint8_t *body, uint16_t session, uint8_t version{message})",
        "{",
        f"{_INDENT}body[0] = CUBELING_{spec.name};",
        f"{_INDENT}cubeling_put16(body + 1, session);",
    ]
    if len(spec.parts) == 1:
        lines.append(f"{_INDENT}(void)version;")
    for part in spec.parts:
        if part is not spec.parts[0]:
            lines.append(f"{_INDENT}if (version < {part.since})")
            lines.append(f"{_INDENT * 2}return {part.start};")
        lines += [_INDENT + line for field, at in _placed(part) for line in _put(field, at)]
    return [*lines, f"{_INDENT}return {spec.parts[-1].end};", "}"]


def _unpack(spec: MessageSpec) -> list[str]:
    name = spec.name.lower()
    fields = any(part.fields for part in spec.parts)
    message = f", cubeling_{name} *to" if fields else ""
    lines = [
        f"static inline int cubeling_unpack_{name}(const uint8_t *body, size_t size{message})",
        "{",
        f"{_INDENT}if (size < {spec.size} || body[0] != CUBELING_{spec.name})",
        f"{_INDENT * 2}return 0;",
    ]
    for part in spec.parts:
        getting = [line for field, at in _placed(part) for line in _get(field, at)]
        if part is spec.parts[0]:
            lines += [_INDENT + line for line in getting]
            continue
        lines += [f"{_INDENT}if (size >= {part.end}) {{", *(_INDENT * 2 + line for line in getting)]
        defaults = [f"to->{f.name} = {getattr(spec.kind, f.name)};" for f in part.fields]
        lines += [f"{_INDENT}}} else {{", *(_INDENT * 2 + line for line in defaults)]
        lines.append(f"{_INDENT}}}")
    return [*lines, f"{_INDENT}return 1;", "}"]


def _placed(part: VersionPart) -> list[tuple[FieldSpec, int]]:
    """Return the fields of a part with their offsets in the body."""
    placed, at = [], part.start
    for field in part.fields:
        placed.append((field, at))
        at += field.size
    return placed


def _put(field: FieldSpec, at: int) -> list[str]:
    own = f"from->{field.name}"
    if field.wire_type == "text16":
        return [f"strncpy((char *)body + {at}, {own}, {_TEXT});"]
    if field.wire_type == f"i16x{_ROW}":
        loop = f"for (size_t i = 0; i < {_ROW}; i++)"
        return [loop, f"{_INDENT}cubeling_put16(body + {at} + 2 * i, (uint16_t){own}[i]);"]
    if field.wire_type == "u8":
        return [f"body[{at}] = {own};"]
    if field.wire_type == "u32":
        return [f"cubeling_put32(body + {at}, {own});"]
    return [f"cubeling_put16(body + {at}, (uint16_t){own});"]


def _get(field: FieldSpec, at: int) -> list[str]:
    own = f"to->{field.name}"
    if field.wire_type == "text16":
        return [f"memcpy({own}, body + {at}, {_TEXT});", f"{own}[{_TEXT}] = 0;"]
    if field.wire_type == f"i16x{_ROW}":
        loop = f"for (size_t i = 0; i < {_ROW}; i++)"
        return [loop, f"{_INDENT}{own}[i] = cubeling_get16s(body + {at} + 2 * i);"]
    get = {"u16": "cubeling_get16", "i16": "cubeling_get16s", "u32": "cubeling_get32"}
    value = f"{get[field.wire_type]}(body + {at})" if field.wire_type in get else f"body[{at}]"
    return [f"{own} = {value};", *_refuse(field, own)]


def _refuse(field: FieldSpec, own: str) -> list[str]:
    """Return the lines that refuse a value out of range, if the type can hold one."""
    least, most = INTEGER_LIMITS[field.wire_type]
    low = least if field.low is None else round(field.low / field.scale)
    high = most if field.high is None else round(field.high / field.scale)
    tests = [f"{own} < {low}"] if low > least else []
    tests += [f"{own} > {high}"] if high < most else []
    return [f"if ({' || '.join(tests)})", f"{_INDENT}return 0;"] if tests else []
