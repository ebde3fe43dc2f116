"""The editor used from empty to saved, by events of mouse and keyboard: for tests and pictures."""

from collections.abc import Iterator
from pathlib import Path

from cubeling.app.gesture_editor.editing.timing import phase_spans, time_of
from cubeling.app.gesture_editor.handling import KeyPressed, Moved, Pressed, Released, Typed
from cubeling.app.gesture_editor.panels.fields import Slider
from cubeling.app.gesture_editor.panels.layout import widget_named
from cubeling.app.gesture_editor.panels.space_map import SpaceMap
from cubeling.app.gesture_editor.panels.time_line import time_axis
from cubeling.app.gesture_editor.panels.widgets import Widget
from cubeling.app.gesture_editor.session import EditorSession
from cubeling.app.ui.contact_sheets import save
from cubeling.characters.rendering import create_context

MOUSE_STEPS = 4
"""Places that the mouse passes in a drag."""

NAME = "BIG HELLO"
"""Name of the gesture that the tour makes, as it is typed."""


class Hand:
    """Uses an editor as a person does: it looks for a widget by its name, and goes there."""

    def __init__(self, session: EditorSession) -> None:
        self.session = session

    def click(self, name: str, *, shift: bool = False) -> None:
        """Click the middle of a widget."""
        left, top, width, height = self._widget(name).rect
        self.press_at(left + width / 2, top + height / 2, shift=shift)

    def press_at(self, x: float, y: float, *, shift: bool = False) -> None:
        """Click a place."""
        self.session.send(Moved(x, y), Pressed(shift), Released())

    def drag(self, name: str, to_x: float) -> None:
        """Drag a widget sideways to a place."""
        left, top, width, height = self._widget(name).rect
        x, y = left + width / 2, top + height / 2
        path = (Moved(x + (to_x - x) * n / MOUSE_STEPS, y) for n in range(1, MOUSE_STEPS + 1))
        self.session.send(Moved(x, y), Pressed(), *path, Released())

    def put_hand(self, x: str, y: str) -> None:
        """Click a sector of the map."""
        widget = self._widget("map")
        assert isinstance(widget, SpaceMap), "the map is a map"
        self.press_at(*widget.center(x, y))

    def set_slider(self, name: str, value: float) -> None:
        """Click a slider where it has a value."""
        slider = self._widget(name)
        assert isinstance(slider, Slider), f"{name} is a slider"
        start, end = slider.track
        share = (value - slider.low) / (slider.high - slider.low)
        self.press_at(start + share * (end - start), slider.rect[1] + slider.rect[3] / 2)

    def write(self, field: str, text: str) -> None:
        """Click a text field, and write into it."""
        self.click(field)
        for letter in text:
            self.session.send(Typed(letter))
        self.session.send(KeyPressed("Enter"))

    def open(self, name: str) -> None:
        """Open a gesture of the library."""
        self.click("open")
        for letter in name:
            self.session.send(Typed(letter))
        self.click(f"open:{name}")

    def go_to(self, time: float) -> None:
        """Put the preview to a time [s]."""
        left, top, _, height = self._widget("time").rect
        x = time_axis(self.session.state).x(time)
        self.press_at(max(x, left + 1), top + height / 2)

    def _widget(self, name: str) -> Widget:
        widget = widget_named(self.session.state, name)
        assert widget is not None, f"there is no {name!r} to use"
        return widget


def from_empty_to_saved(session: EditorSession) -> Iterator[str]:
    """Make a wave from nothing, and save it; after each step, yield what was done."""
    hand = Hand(session)
    hand.click("new")
    yield "an empty gesture"
    hand.put_hand("XP", "YUpperP")
    yield "the hand goes to a sector of the gesture space"
    for button in ("shape:spread", "palm:forward", "fingers:up"):
        hand.click(button)
    yield "the fingers are spread, the palm faces forward"
    hand.go_to(time_of(session.state.document.gesture, 0.9))
    hand.click("add key")
    hand.click("path:wave")
    hand.set_slider("turns", 2.5)
    session.send(*[KeyPressed("→", shift=True)] * 5)
    yield "a second key, at the end of the stroke: the hand waves until it"
    end = phase_spans(session.state.document.gesture)["stroke"][0] + 1.2
    hand.drag("end:stroke", time_axis(session.state).x(end))
    hand.set_slider("power", 0.5)
    yield "the stroke takes longer, with more power"
    hand.click("hand:either")
    hand.write("name", NAME)
    hand.write("summary", "Hello over there")
    yield "either hand may do it; it has a name"
    session.send(KeyPressed("S", control=True))
    yield "it is saved"


def draw_tour(folder: Path, gestures: Path, scale: float = 1.0) -> list[Path]:
    """Draw the window after each step of the tour; return the pictures.

    Parameters
    ----------
    folder
        Where the pictures go; it must exist.
    gestures
        Where the tour saves its gesture.
    scale
        Pixels for a unit of the canvas; 1 for pictures of 1280×720.
    """
    context = create_context()
    session = EditorSession(context, gestures)
    paths = []
    try:
        for number, _ in enumerate(from_empty_to_saved(session), 1):
            session.advance(0.0)
            paths.append(folder / f"gesture-editor-{number}.png")
            save(session.picture(scale), paths[-1])
    finally:
        session.close()
        context.release()
    return paths
