"""Computing the channels of a session that holds only what came in."""

from collections import defaultdict
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.app.pipeline.step import Step
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import Progress, run
from cubeling.app.session import SessionFile, session_info

CAME_IN = ("mark ", "camera ", "paused", "resumed")
"""How the events begin that are not computed again: they came from the player or the camera."""


def compute_channels(
    path: Path,
    complete: Path,
    progress: Progress | None = None,
    *,
    salvage: bool = False,
    appearance: bool = False,
) -> None:
    """Write a session with the frames and inputs of another one, and all that follows from them.

    The robot is simulated, as in `cubeling play`.

    Parameters
    ----------
    path
        A session, of which only what came in is read.
    complete
        The .mcap file to write.
    progress
        Called after every frame.
    salvage
        Whether to take the intact part of a session that was cut off, instead of refusing it.
    appearance
        Whether to measure what the pictures tell of hand, light and softness too.

    Raises
    ------
    AppError, TrackingError, CharacterError, AffectError
        The session cannot be read or played, or the file cannot be written.
    KeyboardInterrupt
        Ctrl-C came before the end.
    """
    with ExitStack() as closing:
        replayed = closing.enter_context(SessionFile(path, salvage=salvage))
        options = replace(
            replayed.info.options,
            record=complete,
            pictures=False,
            salvage=salvage,
            appearance=appearance,
        )
        came_in: defaultdict[float, list[str]] = defaultdict(list)
        for time, event in replayed.events:
            if event.startswith(CAME_IN):
                came_in[time].append(event)
        session = closing.enter_context(open_session(options, replayed=replayed))

        def note(step: Step) -> None:
            now = step.frame.timestamp
            for event in came_in.pop(now, ()):
                if session.recording is not None:
                    session.recording.event(event, now)
            if progress is not None:
                progress(step)

        summary = run(session, note)
    if summary.interrupted:
        raise KeyboardInterrupt
    if not summary.frames:
        raise AppError(f"cannot read the session '{path}': it holds no camera frame")
    session_info(complete)  # refuses what was cut off as the disk is full
