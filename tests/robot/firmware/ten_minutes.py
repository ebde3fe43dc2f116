"""Run by MicroPython behind serve_micropython.py: what a session of ten minutes needs of memory."""
# ruff: noqa
# mypy: ignore-errors

import gc
import struct

from dino import frames

incoming = bytearray()
minute = now = 0


def read(data):
    global incoming
    count = min(len(incoming), len(data))
    data[:count] = incoming[:count]
    incoming = incoming[count:]
    return count


def say(*message):
    body = bytearray(struct.pack(*message))
    box = frames.Outbox(64)
    box.put(body, len(body))
    incoming.extend(box.data[: box.end])


board.read, board.write = read, len
say("<BHBI", 1, 7, 2, 9)


def again():
    """Live for a minute; the garbage is collected when this returns."""
    global minute, now
    if minute:
        print(gc.mem_alloc())
    if minute == 10:
        return False
    minute += 1
    for step in range(600):
        now += 100
        if step % 60 == 0:
            say("<BHIhhB", 0x10, 7, now, now * 997 % 20001 - 10000, 0, 255)
        say("<BHH", 3, 7, step)
        robot.turn(now)
    assert robot.link.session == 7
    gc.collect()
    return True
