"""How threads take turns, and hand on what they have made."""

import queue
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TypeVar

T = TypeVar("T")

SWITCH_S = 0.0005
"""Longest time that a frame keeps the interpreter from the thread of the clients [s]. It needs it
again after each call to a socket: at Python's 5 ms, those that connect wait for seconds."""


@contextmanager
def often_switching() -> Iterator[None]:
    """Let threads take turns every `SWITCH_S`."""
    usual = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_S)
    try:
        yield
    finally:
        sys.setswitchinterval(usual)


def taken(waiting: "queue.Queue[T]", otherwise: T) -> T:
    """Return the next thing that another thread has left, or something else at once."""
    try:
        return waiting.get_nowait()
    except queue.Empty:
        return otherwise
