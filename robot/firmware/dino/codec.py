"""Decoding and encoding of message bodies by the tables in `messages`: PROTOCOL.md, section 3."""

from struct import pack_into, unpack_from

from .messages import FROM_HOST, FROM_ROBOT


def unpack(body: bytearray, size: int) -> tuple[int, ...] | None:
    """Return number, session and fields of a host's message; None if it is not valid.

    Fields of a later version are ignored. Fields that an earlier version lacks get their defaults,
    which are written into `body`.
    """
    if size < 3:
        return None
    known = FROM_HOST.get(body[0])
    if known is None:
        return None
    layout, first, later, limits = known
    if size < first:
        return None
    start = first
    for end, defaults in later:
        if size < end:
            for index in range(end - start):
                body[start + index] = defaults[index]
        start = end
    values: tuple[int, ...] = unpack_from(layout, body, 0)
    for index, low, high in limits:
        if not low <= values[index] <= high:
            return None
    return values


def pack(out: bytearray, version: int, number: int, session: int, *fields: int | bytes) -> int:
    """Write a robot's message into `out` in a version of the protocol; return its size."""
    layout, sizes = FROM_ROBOT[number]
    pack_into(layout, out, 0, number, session, *fields)
    size = 0
    for since, end in sizes:
        if since <= version or not size:
            size = end
    return size
