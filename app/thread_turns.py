"""How often threads take turns, where clients must not wait for those that compute."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

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
