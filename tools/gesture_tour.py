"""The gesture editor used from empty to saved, as a person does it: for its picture and tests."""

from collections.abc import Iterator
from pathlib import Path
from typing import Protocol, Self

import moderngl
import numpy as np
from imgui_bundle import imgui
from numpy.typing import NDArray

from cubeling.app.ui.contact_sheets import save
from cubeling.app.ui.panels.drawing.style import rgba
from cubeling.app.workshop.gesture_editor.editing.timing import phase_spans, time_line_span, time_of
from cubeling.app.workshop.gesture_editor.panels.ui import DESK, Rect
from cubeling.app.workshop.gesture_editor.panels.view import EditorView, chord_of
from cubeling.app.workshop.gesture_editor.session import EditorSession
from cubeling.app.workshop.gesture_editor.window import SIZE
from cubeling.characters.rendering import create_context

MOUSE_STEPS = 4
"""Places that the mouse passes in a drag."""

FRAMES = 3
"""Frames after each event: Dear ImGui may hand them on in several."""

NAME = "BIG HELLO"
"""Name of the gesture that the tour makes, as it is typed."""


class Editor(Protocol):
    """An editor with a mouse and a keyboard."""

    session: EditorSession

    @property
    def places(self) -> dict[str, Rect]:
        """Where its widgets are."""

    def move(self, x: float, y: float) -> None:
        """Move the mouse."""

    def button(self, *, pressed: bool) -> None:
        """Press or release the left button of the mouse."""

    def press(self, keys: str) -> None:
        """Press and release keys, such as "Ctrl+Shift+Z"."""

    def hold(self, key: str, *, pressed: bool) -> None:
        """Press or release "Shift" or "Ctrl"."""

    def type(self, text: str) -> None:
        """Type letters."""


class OffscreenEditor:
    """An editor without a window, whose mouse and keyboard are those of Dear ImGui.

    Parameters
    ----------
    context
        Where it draws; it is not released.
    session
        What is edited; it is closed with the editor.
    size
        Width and height [px].
    """

    def __init__(
        self, context: moderngl.Context, session: EditorSession, size: tuple[int, int] = SIZE
    ) -> None:
        self.session, self.size = session, size
        self._imgui = imgui.create_context()
        self._io = imgui.get_io()
        self._io.set_ini_filename("")
        self._io.display_size = imgui.ImVec2(*size)
        imgui.backends.opengl3_init("#version 330")
        self._texture = context.texture(size, 4)
        self._screen = context.framebuffer([self._texture])
        self._view = EditorView(session, context)
        self.frame()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def places(self) -> dict[str, Rect]:
        """Where its widgets are [px]."""
        return self._view.places

    def frame(self, count: int = FRAMES) -> None:
        """Let frames pass, without time for the preview."""
        imgui.set_current_context(self._imgui)
        for _ in range(count):
            self._io.delta_time = 1 / 30
            imgui.backends.opengl3_new_frame()
            imgui.new_frame()
            self._view.draw(1.0)
            imgui.render()

    def picture(self) -> NDArray[np.uint8]:
        """Return what it shows, (height, width, 3) BGR."""
        self.frame()
        self._screen.use()
        self._screen.clear(*rgba(DESK))
        imgui.backends.opengl3_render_draw_data(imgui.get_draw_data())
        pixels = np.frombuffer(self._screen.read(), np.uint8).reshape(*self._screen.size[::-1], 3)
        return np.ascontiguousarray(pixels[::-1, :, ::-1])

    def move(self, x: float, y: float) -> None:
        """Move the mouse."""
        self._io.add_mouse_pos_event(x, y)
        self.frame()

    def button(self, *, pressed: bool) -> None:
        """Press or release the left button of the mouse."""
        self._io.add_mouse_button_event(0, pressed)
        self.frame()

    def press(self, keys: str) -> None:
        """Press and release keys, such as "Ctrl+Shift+Z"; "?" is typed."""
        if keys in "?,.":
            self.type(keys)
            return
        chord = chord_of(keys)
        for pressed in (True, False):
            for key in chord if pressed else chord[::-1]:
                self._io.add_key_event(key, pressed)
            self.frame()

    def hold(self, key: str, *, pressed: bool) -> None:
        """Press or release "Shift" or "Ctrl"."""
        self._io.add_key_event(chord_of(key)[0], pressed)
        self.frame()

    def type(self, text: str) -> None:
        """Type letters."""
        for letter in text:
            self._io.add_input_character(ord(letter))
        self.frame(len(text) + FRAMES)

    def close(self) -> None:
        """Release what draws, and close the session."""
        imgui.set_current_context(self._imgui)
        self._view.release()
        imgui.backends.opengl3_shutdown()
        imgui.destroy_context(self._imgui)
        self._screen.release()
        self._texture.release()
        self.session.close()


class Hand:
    """Uses an editor as a person does: it looks for a widget by its name, and goes there."""

    def __init__(self, editor: Editor) -> None:
        self._editor = editor

    def click(self, name: str, *, held: str = "") -> None:
        """Click the middle of a widget, perhaps while "Shift" or "Ctrl" is held."""
        left, top, width, height = self._place(name)
        self.click_at(left + width / 2, top + height / 2, held=held)

    def click_at(self, x: float, y: float, *, held: str = "") -> None:
        """Click a place."""
        if held:
            self._editor.hold(held, pressed=True)
        self._editor.move(x, y)
        for pressed in (True, False):
            self._editor.button(pressed=pressed)
        if held:
            self._editor.hold(held, pressed=False)

    def drag(self, name: str, to_x: float, *, released: bool = True) -> None:
        """Drag a widget sideways to a place."""
        left, top, width, height = self._place(name)
        x, y = left + width / 2, top + height / 2
        self._editor.move(x, y)
        self._editor.button(pressed=True)
        for step in range(1, MOUSE_STEPS + 1):
            self._editor.move(x + (to_x - x) * step / MOUSE_STEPS, y)
        if released:
            self._editor.button(pressed=False)

    def put_hand(self, x: str, y: str) -> None:
        """Click a sector of the map."""
        self.click(f"sector:{x}:{y}")

    def set_slider(self, name: str, value: float) -> None:
        """Click a slider with Ctrl, and type a value."""
        self.click(name, held="Ctrl")
        self._editor.press("Ctrl+A")
        self._editor.type(f"{value:g}")
        self._editor.press("Enter")

    def write(self, field: str, text: str) -> None:
        """Click a text field, and write into it instead of what it has."""
        self.click(field)
        self._editor.press("Ctrl+A")
        self._editor.type(text)
        self._editor.press("Enter")

    def open(self, name: str) -> None:
        """Open a gesture of the library."""
        self.click("open")
        self._editor.type(name)
        self.click(f"open:{name}")

    def x_of(self, time: float) -> float:
        """Return where a time is on the time line [px]."""
        left, _, width, _ = self._place("time")
        return left + time / time_line_span(self._editor.session.state.document.gesture) * width

    def go_to(self, time: float) -> None:
        """Put the preview to a time [s]."""
        left, top, _, height = self._place("time")
        self.click_at(max(self.x_of(time), left + 1), top + height / 2)

    def _place(self, name: str) -> Rect:
        assert name in self._editor.places, f"there is no {name!r} to use"
        return self._editor.places[name]


def from_empty_to_saved(editor: Editor) -> Iterator[str]:
    """Make a wave from nothing, and save it; after each step, yield what was done."""
    hand, session = Hand(editor), editor.session
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
    for _ in range(5):
        editor.press("Shift+Right")
    yield "a second key, at the end of the stroke: the hand waves until it"
    end = phase_spans(session.state.document.gesture)["stroke"][0] + 1.2
    hand.drag("end:stroke", hand.x_of(end))
    hand.set_slider("power", 0.5)
    yield "the stroke takes longer, with more power"
    hand.click("hand:either")
    hand.write("name", NAME)
    hand.write("summary", "Hello over there")
    yield "either hand may do it; it has a name"
    editor.press("Ctrl+S")
    yield "it is saved"


def draw_tour(folder: Path, gestures: Path, size: tuple[int, int] = SIZE) -> list[Path]:
    """Draw the window after each step of the tour; return the pictures.

    Parameters
    ----------
    folder
        Where the pictures go; it must exist.
    gestures
        Where the tour saves its gesture.
    size
        Width and height of the pictures [px].
    """
    context = create_context()
    paths = []
    try:
        with OffscreenEditor(context, EditorSession(context, gestures), size) as editor:
            for number, _ in enumerate(from_empty_to_saved(editor), 1):
                editor.session.advance(0.0)
                paths.append(folder / f"gesture-editor-{number}.png")
                save(editor.picture(), paths[-1])
    finally:
        context.release()
    return paths
