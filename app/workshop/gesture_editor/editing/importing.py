"""A gesture read off a span of a recording."""

import math
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.app.workshop.gesture_editor.editing.edits import gesture_name
from cubeling.characters.behaviour import SymbolicGesture, gesture_from_recording
from cubeling.characters.model import load_recording


def import_gesture(recording: str, start: float = 0.0, end: float = math.inf) -> SymbolicGesture:
    """Return the gesture in a span of a recording [s], named after its file.

    Parameters
    ----------
    recording
        A .bvh or .amc file, or a character and one of its clips: "fox.glb#Wave".
    start, end
        Where the gesture starts, and where it ends.

    Raises
    ------
    AppError
        The span is none.
    CharacterError
        The recording cannot be read, or no hand moves in the span.
    """
    if not 0.0 <= start < end:
        raise AppError(
            f"a span from {start:g} s to {end:g} s is none: give two times, as 1.5 and 3"
        )
    taken = load_recording(recording)
    if start >= taken.clip.duration:
        raise AppError(f"{recording} has {taken.clip.duration:.2f} s: start before its end")
    file, _, clip = recording.partition("#")
    name = gesture_name(clip or Path(file).stem) or "RECORDED"
    return gesture_from_recording(taken.clip, taken.skeleton, taken.anatomy, start, end, name)
