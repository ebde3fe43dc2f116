"""Showing one picture to a tracker until its search has come to an end."""

import time

from cubeling.tracking import CubeModel, CubeState, CubeTracker, Frame, Intrinsics
from tests.tracking.drawn import Picture

MAX_CALLS = 60
"""A search that takes more calls than this does not end."""


def show_until_decided(
    tracker: CubeTracker, picture: Picture, start: float = 0.0, index: int = 0
) -> tuple[CubeState, list[float]]:
    """Show a picture again and again; return the last state, and the CPU time of each call [s]."""
    seconds: list[float] = []
    while len(seconds) < MAX_CALLS:
        shown = len(seconds)
        began = time.process_time()
        state = tracker.update(Frame(picture, start + shown / 30, index + shown))
        seconds.append(time.process_time() - began)
        if state.verdict != "searching":
            return state, seconds
    raise AssertionError("the search does not end")


def watch(picture: Picture, cube: CubeModel, camera: Intrinsics) -> list[CubeState]:
    """States of a new tracker that has searched a picture, and then sees it once more."""
    tracker = CubeTracker(cube, camera)
    first, calls = show_until_decided(tracker, picture)
    return [first, tracker.update(Frame(picture, len(calls) / 30, len(calls)))]
