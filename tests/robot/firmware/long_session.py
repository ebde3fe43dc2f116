"""Run by MicroPython behind virtual_board.py: the memory that a long session needs."""
# ruff: noqa
# mypy: ignore-errors

import gc
import struct

from dino import frames

part = now = 0
box = frames.TransmitBuffer(64)


def say(*message):
    body = bytearray(struct.pack(*message))
    box.put(body, len(body))
    board.incoming += box.data[: box.end]
    box.drop(box.end)


def again():
    """Live for half a minute; the garbage is collected when this returns."""
    global part, now
    if part:
        print(gc.mem_alloc())
    else:
        say("<BHBI", 1, 7, 2, 9)
    if part == 4:
        return False
    part += 1
    for step in range(300):
        now += 100
        if step % 60 == 0:
            say("<BHIhhB", 0x10, 7, now, now * 997 % 20001 - 10000, 0, 255)
        say("<BHH", 3, 7, step)
        robot.step(now)
        board.outgoing = bytearray()
    assert robot.session.number == 7
    gc.collect()
    return True


del exchange
