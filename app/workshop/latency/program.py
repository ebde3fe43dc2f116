"""How long the program takes for a picture, in a session as of `cubeling play`."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.step import Step
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionOptions
from cubeling.app.ui.screen import Screen
from cubeling.tracking import FrameSource

WARM_UP_S = 1.0
"""The first pictures wait for shaders that are compiled and caches that are filled [s]."""

MIN_PICTURES = 10
"""Fewer pictures say nothing."""


@dataclass(frozen=True)
class ProgramTimes:
    """When the pictures of a session were taken and shown."""

    stamps: NDArray[np.float64]
    """Timestamps of the frames that were shown [s]."""

    shown: NDArray[np.float64]
    """When each was on its way to the screen: the return of the buffer swap [s]."""

    tracked: float
    """Share of them in which the cube was found, 0…1."""


def program_times(
    options: SessionOptions,
    source: FrameSource,
    seconds: float,
    clock: Callable[[], float] = time.monotonic,
    screen: Screen | None = None,
) -> tuple[ProgramTimes | None, bool]:
    """Play for some seconds; return the times, and whether Ctrl-C ended it.

    Parameters
    ----------
    options
        What is played.
    source
        A live camera; it is closed at the end.
    seconds
        How long to play after `WARM_UP_S`.
    clock
        The time [s] of the source's timestamps.
    screen
        As of `open_session`.

    Returns
    -------
    tuple
        The times, None if there are too few, and whether Ctrl-C ended the session.
    """
    times: list[tuple[float, float, bool]] = []
    began = clock()

    def progress(step: Step) -> None:
        now = clock()
        if now - began >= WARM_UP_S:
            times.append((step.frame.timestamp, now, step.state.visible))
        if now - began >= WARM_UP_S + seconds:
            source.close()  # ends the session

    with open_session(options, source=source, screen=screen) as session:
        began = clock()
        summary = run(session, progress)
    if len(times) < MIN_PICTURES:
        summary.check()
        return None, summary.interrupted
    stamps, shown, tracked = np.array(times, float).T
    return ProgramTimes(stamps, shown, float(tracked.mean())), summary.interrupted
