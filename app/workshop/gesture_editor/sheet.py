"""A picture of a gesture: characters in rows, moments of the gesture in columns."""

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from cubeling.app.ui.contact_sheets import frame_sheet, save
from cubeling.app.workshop.gesture_editor.editing.timing import phase_at, phase_spans, time_of
from cubeling.app.workshop.gesture_editor.preview import Preview, PreviewedGesture
from cubeling.characters.behaviour import SymbolicGesture
from cubeling.characters.rendering import create_context

CELL_PX = 300, 320
"""Size of a picture [px]."""


def draw_sheet(path: Path, gesture: SymbolicGesture, characters: Sequence[str]) -> None:
    """Draw how characters perform a gesture, at four moments.

    Raises
    ------
    CharacterError
        There is no such character.
    AppError
        The picture cannot be written.
    """
    with ExitStack() as closing:
        context = create_context()
        closing.callback(context.release)
        preview = Preview(context)
        closing.callback(preview.release)
        cells = []
        for name in characters:
            previewed = PreviewedGesture(gesture, "right", name)
            for time in _moments(gesture):
                picture = preview.draw(previewed, time, CELL_PX)
                cells.append((f"{name}, {phase_at(gesture, time)} {time:.2f} s", picture))
        save(frame_sheet(gesture.name, cells), path)


def _moments(gesture: SymbolicGesture) -> tuple[float, ...]:
    """Return four moments: the start, the middle and the end of the stroke, and on the way back."""
    relax, end = phase_spans(gesture)["retraction"]
    middle = time_of(gesture, 0.5)
    return time_of(gesture, 0.0), middle, time_of(gesture, 1.0) - 1e-3, (relax + end) / 2
