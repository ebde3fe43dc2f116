"""Files that are nearly right: bytes, texts, numbers and structures of a good one are changed."""

import io
import json
import re
import struct
import zipfile
from collections.abc import Callable
from copy import deepcopy
from typing import Any

import numpy as np
from mcap.reader import make_reader
from mcap.writer import Writer

NUMBERS = (
    b"0",
    b"-1",
    b"1e308",
    b"-1e-308",
    b"nan",
    b"inf",
    b"1e999",
    b"99999999999999999999",
    b"",
)
VALUES: tuple[Any, ...] = (None, [], {}, "", "x", -1, 0, 2**63, 1e308, True, [[]], "é\0", [1, [2]])
WORDS = (0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0xFFFF)

Random = np.random.Generator

MOST_REPEATED = 300_000
"""Bytes that a stretch is repeated to at most."""


def mutant(data: bytes, suffix: str, random: Random) -> bytes:
    """Return a damaged copy of a file; what lies in containers is damaged half of the time."""
    inside = CONTAINERS.get(suffix)
    if inside is not None and random.random() < 0.5:
        return inside(data, random)
    return damage(data, random)


def damage(data: bytes, random: Random) -> bytes:
    """Return bytes with one to three changes."""
    for _ in range(int(random.choice((1, 1, 1, 2, 3)))):
        if data:
            data = CHANGES[int(random.integers(len(CHANGES)))](data, random)
    return data


def _spot(data: bytes, random: Random) -> tuple[int, int]:
    """Return a stretch of some bytes, short ones more often."""
    start = int(random.integers(len(data)))
    return start, min(len(data), start + int(2.0 ** random.uniform(0, 10)))


def _flip(data: bytes, random: Random) -> bytes:
    changed = bytearray(data)
    for place in random.integers(len(data), size=int(random.integers(1, 9))):
        changed[place] ^= 1 << int(random.integers(8))
    return bytes(changed)


def _noise(data: bytes, random: Random) -> bytes:
    start, end = _spot(data, random)
    return data[:start] + random.bytes(end - start) + data[end:]


def _cut(data: bytes, random: Random) -> bytes:
    return data[: int(random.integers(len(data)))]


def _remove(data: bytes, random: Random) -> bytes:
    start, end = _spot(data, random)
    return data[:start] + data[end:]


def _repeat(data: bytes, random: Random) -> bytes:
    """Repeat a stretch, sometimes until it is longer than a parser may expect a field to be."""
    start, end = _spot(data, random)
    count = min(int(2.0 ** random.uniform(0, 16)), MOST_REPEATED // (end - start))
    return data[:end] + data[start:end] * count + data[end:]


def _word(data: bytes, random: Random) -> bytes:
    start = int(random.integers(len(data)))
    word = struct.pack("<I", int(random.choice(WORDS)))
    return data[:start] + word + data[start + 4 :]


def _number(data: bytes, random: Random) -> bytes:
    """Change a number that is written as text."""
    start = int(random.integers(len(data)))
    found = re.compile(rb"-?\d[\d.eE+-]*").search(data, start, start + 4096)
    if found is None:
        return _flip(data, random)
    return data[: found.start()] + NUMBERS[int(random.integers(len(NUMBERS)))] + data[found.end() :]


def _lines(data: bytes, random: Random) -> bytes:
    """Swap, drop or repeat a line."""
    lines = data.split(b"\n")
    first, second = (int(each) for each in random.integers(len(lines), size=2))
    kind = int(random.integers(3))
    if kind == 0:
        lines[first], lines[second] = lines[second], lines[first]
    elif kind == 1:
        del lines[first]
    else:
        lines[second:second] = [lines[first]] * int(random.integers(1, 50))
    return b"\n".join(lines)


CHANGES: tuple[Callable[[bytes, Random], bytes], ...] = (
    *(_flip, _noise, _cut, _remove, _repeat, _word, _number, _number, _lines),
)


def _text(data: bytes, random: Random) -> bytes:
    """Change a number or a word of a text, which stays one."""
    tokens = list(re.finditer(rb"-?\d[\d.eE+-]*|[A-Za-z_]\w*|[^\s\w]", data))
    if len(tokens) < 2:
        return damage(data, random)
    old, new = (tokens[int(each)] for each in random.integers(len(tokens), size=2))
    if old[0][:1].isdigit() and random.random() < 0.7:
        content = NUMBERS[int(random.integers(len(NUMBERS)))]
    else:
        content = new[0]
    return data[: old.start()] + content + data[old.end() :]


def damage_json(data: bytes, random: Random) -> bytes:
    """Return JSON with some values replaced by those of other types."""
    try:
        document = json.loads(data)
    except ValueError:
        return damage(data, random)
    holder = {"": document}
    for _ in range(int(random.integers(1, 4))):
        place: Any = holder
        while isinstance(place, dict | list) and place:
            keys = list(place) if isinstance(place, dict) else range(len(place))
            key = keys[int(random.integers(len(keys)))]
            inner = place[key]
            if not isinstance(inner, dict | list) or not inner or random.random() < 0.15:
                if random.random() < 0.2 and isinstance(place, dict) and place is not holder:
                    del place[key]
                else:
                    place[key] = deepcopy(VALUES[int(random.integers(len(VALUES)))])
                break
            place = inner
    return json.dumps(holder[""]).encode()


def _glb(data: bytes, random: Random) -> bytes:
    """Change the JSON of a .glb, with right lengths around it."""
    length = struct.unpack_from("<I", data, 12)[0]
    text = damage_json(data[20 : 20 + length], random)
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    head = data[:8] + struct.pack("<II", 20 + len(text) + len(rest), len(text))
    return head + data[16:20] + text + rest


def _archive(data: bytes, random: Random) -> bytes:
    """Change one member of a zip archive, which is packed again."""
    source, target = zipfile.ZipFile(io.BytesIO(data)), io.BytesIO()
    names = source.namelist()
    # The text that describes the arrays is changed as often as all of them.
    chosen = "content.npy" if random.random() < 0.5 else names[int(random.integers(len(names)))]
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in names:
            member = source.read(name)
            if name == chosen:
                member = (
                    _content(member, random) if name == "content.npy" else damage(member, random)
                )
            archive.writestr(name, member)
    return target.getvalue()


def _content(member: bytes, random: Random) -> bytes:
    """Change the JSON text in an array of NumPy."""
    text = damage_json(str(np.load(io.BytesIO(member))).encode(), random).decode()
    file = io.BytesIO()
    np.save(file, np.array(text))
    return file.getvalue()


def _session(data: bytes, random: Random) -> bytes:
    """Change some messages or metadata of a session, which is written again."""
    reader, target = make_reader(io.BytesIO(data)), io.BytesIO()
    writer = Writer(target, chunk_size=1 << 16)
    writer.start()
    share = 2.0 ** random.uniform(-6, 0)
    for record in reader.iter_metadata():
        values = dict(record.metadata)
        if values and random.random() < 0.3:
            key = list(values)[int(random.integers(len(values)))]
            values[key] = str(VALUES[int(random.integers(len(VALUES)))])
        writer.add_metadata(record.name, values)
    channels: dict[str, int] = {}
    for schema, channel, message in reader.iter_messages(log_time_order=False):
        if channel.topic not in channels:
            kept = 0
            if schema is not None:
                kept = writer.register_schema(schema.name, schema.encoding, schema.data)
            channels[channel.topic] = writer.register_channel(
                channel.topic, channel.message_encoding, kept
            )
        content = message.data
        if random.random() < share:
            change = damage_json if channel.message_encoding == "json" else damage
            content = change(content, random)
        time = message.log_time
        writer.add_message(channels[channel.topic], time, content, message.publish_time)
    writer.finish()
    return target.getvalue()


CONTAINERS: dict[str, Callable[[bytes, Random], bytes]] = {
    **dict.fromkeys((".glb", ".vrm", ".vrma"), _glb),
    **dict.fromkeys((".idle", ".graph", ".gestures"), _archive),
    **dict.fromkeys((".toml", ".yaml", ".xml", ".bml", ".TextGrid", ".txt"), _text),
    **dict.fromkeys((".csv", ".eaf", ".anvil"), _text),
    **dict.fromkeys((".bvh", ".amc", ".asf", ".bap", ".fap"), _text),
    ".gltf": damage_json,
    ".mcap": _session,
}
"""What damages the inside of a file, by its suffix."""
