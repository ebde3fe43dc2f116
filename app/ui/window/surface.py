"""A window of the desktop that shows pictures, as large as they fit into it."""

import contextlib
from collections.abc import Sequence
from typing import Any, Self

import glfw

from cubeling.app.errors import AppError
from cubeling.app.ui.canvas import Card
from cubeling.app.ui.window.gl_painter import GLPainter
from cubeling.app.ui.window.memory_painter import MemoryPainter
from cubeling.app.ui.window.painter import Painter, Picture, Placement
from cubeling.app.ui.window.shared_picture import SharedPicture
from cubeling.characters.rendering import create_context, draws_in_software

KEY_NAMES = {
    glfw.KEY_SPACE: "Space",
    glfw.KEY_ESCAPE: "Esc",
    glfw.KEY_ENTER: "Enter",
    glfw.KEY_KP_ENTER: "Enter",
    glfw.KEY_TAB: "Tab",
    glfw.KEY_BACKSPACE: "Backspace",
    glfw.KEY_LEFT: "←",
    glfw.KEY_RIGHT: "→",
    glfw.KEY_UP: "↑",
    glfw.KEY_DOWN: "↓",
    glfw.KEY_HOME: "Home",
    glfw.KEY_END: "End",
    glfw.KEY_F1: "F1",
    glfw.KEY_F2: "F2",
    **{glfw.KEY_0 + digit: f"{digit}" for digit in range(10)},
    **{glfw.KEY_KP_0 + digit: f"{digit}" for digit in range(10)},
}
"""Names of keys that are in the same place on every keyboard."""

TYPED_KEYS = "?,."
"""Characters that are handled as they are typed: their keys differ between keyboards."""


def key_name(key: int, scan: int | None = None) -> str | None:
    """Return the name of a key, one of GLFW's constants; None for one without a name here.

    GLFW's constants name letters as on an American keyboard. With the scan code the letter is that
    of the user's keyboard.
    """
    if key in KEY_NAMES:
        return KEY_NAMES[key]
    letter = glfw.get_key_name(key, scan) if scan is not None else None
    if letter is None and glfw.KEY_A <= key <= glfw.KEY_Z:
        letter = chr(key)
    return letter.upper() if letter and letter.isalpha() else None


class WindowSurface:
    """A window with an OpenGL context, and pictures in it.

    Whoever opens it closes it; a second `close` does nothing. Esc and Q close it.

    Parameters
    ----------
    size
        Width and height of the pictures [px].
    title
        Text of the title bar.
    shown_size
        Width and height of the window [screen coordinates]; None for those of the pictures, as far
        as they fit on the desktop.

    Raises
    ------
    AppError
        There is no display, or its driver offers no OpenGL 3.3.
    """

    def __init__(
        self, size: tuple[int, int], title: str, shown_size: tuple[int, int] | None = None
    ) -> None:
        self._error = ""
        glfw.set_error_callback(self._store_error)
        if not glfw.init():
            raise AppError(f"no window can be opened here: {self._error or 'there is no display'}")
        for hint, value in (
            (glfw.CONTEXT_VERSION_MAJOR, 3),
            (glfw.CONTEXT_VERSION_MINOR, 3),
            (glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE),
            (glfw.OPENGL_FORWARD_COMPAT, True),
        ):
            glfw.window_hint(hint, value)
        self._chosen_size = shown_size
        self._first_size = shown_size or _fitting_size(size)
        self._window = glfw.create_window(*self._first_size, title, None, None)
        if not self._window:
            glfw.terminate()
            raise AppError(f"no window can be opened here: {self._error}")
        glfw.make_context_current(self._window)
        glfw.swap_interval(0)  # a camera's frame must not wait for the screen's
        self._framebuffer_size: tuple[int, int] = glfw.get_framebuffer_size(self._window)
        glfw.set_framebuffer_size_callback(self._window, self._on_size)
        glfw.set_key_callback(self._window, self._on_key)
        glfw.set_char_callback(self._window, self._on_character)
        glfw.set_cursor_pos_callback(self._window, self._on_pointer)
        glfw.set_mouse_button_callback(self._window, self._on_button)
        self.context = create_context(window=True)
        """Where a `Stage` for this window draws."""
        self._whole = size
        self._painter: Painter = GLPainter(self._window, self.context)
        self._painters: tuple[Painter, ...] = (self._painter, *self._memory_painters())
        self._windowed_place = (0, 0, 0, 0)
        self._open = True

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def closed(self) -> bool:
        """Whether the user has closed the window."""
        return not self._open or bool(glfw.window_should_close(self._window))

    def paint(
        self,
        picture: Picture,
        cards: Sequence[Card] = (),
        below: int = 0,
        *,
        mirrored: bool = False,
        brightness: float = 1.0,
        with_opengl: bool = False,
    ) -> None:
        """Paint a picture, as large as it fits; `present` shows it.

        Parameters
        ----------
        picture
            (height, width, 3) BGR.
        cards
            Drawn over it, in pixels of the window: see `shown_size`.
        below
            Room under the picture [px of the picture], which later cards cover.
        mirrored
            Whether it is seen as in a mirror; cards are not.
        brightness
            That of the picture, 0…1.
        with_opengl
            Whether the caller draws over it with OpenGL.
        """
        height, width = picture.shape[:2]
        self._whole = width, height + below
        left, bottom, whole_width, whole_height = self.picture_place(*self._whole)
        window = self._framebuffer_size
        place = Placement(
            window,
            left,
            window[1] - bottom - whole_height,
            (whole_width, whole_height),
            self.shown_size(width, height, below),
        )
        self._painter = self._painters[0 if with_opengl else -1]
        self._painter.paint(picture, place, mirrored=mirrored, brightness=brightness)
        self.paint_cards(cards)

    def paint_cards(self, cards: Sequence[Card]) -> None:
        """Draw cards over what was painted; after `paint`, over the picture that it has drawn."""
        self._painter.paint_cards(cards)

    def pixels(self) -> Picture:
        """Return what was painted last, (height, width, 3) BGR, before it is presented."""
        return self._painter.pixels()

    def _memory_painters(self) -> list[Painter]:
        """Return what paints quicker than OpenGL where the processor draws."""
        if not draws_in_software(self.context) or glfw.get_platform() != glfw.PLATFORM_X11:
            return []
        shared = SharedPicture.open(glfw.get_x11_window(self._window))
        return [] if shared is None else [MemoryPainter(shared)]

    def shown_size(self, width: int, height: int, below: int = 0) -> tuple[int, int]:
        """Return width and height of a picture in the window [px], with so much room below it."""
        _, _, shown_width, whole_height = self.picture_place(width, height + below)
        return shown_width, round(whole_height * height / (height + below))

    def present(self) -> None:
        """Show what was drawn, and process events."""
        self._painter.show()
        self.poll()

    def present_now(self) -> None:
        """Show what was drawn, and return when the display has it."""
        self._painter.show()
        self._painter.finish()

    def poll(self) -> None:
        """Process the events of all windows."""
        glfw.poll_events()

    def press(self, key: int, *, shift: bool = False, repeated: bool = False) -> None:
        """Handle a key press; `key` is one of GLFW's constants."""
        name = key_name(key)
        if name is not None:
            self.handle_key(name, shift=shift, repeated=repeated)

    def handle_key(self, key: str, *, shift: bool = False, repeated: bool = False) -> None:
        """Handle a key by its name; `repeated` while it is held."""
        if key in ("Esc", "Q"):
            self.quit()

    def handle_character(self, character: str) -> bool:
        """Handle a character that is typed; return whether it is text, and no key."""
        return False

    def handle_pointer(self, x: float, y: float) -> None:
        """Handle the mouse at a place of the picture [px]."""

    def handle_button(self, pressed: bool) -> None:
        """Handle the left button of the mouse, where it was last."""

    @property
    def fills_screen(self) -> bool:
        """Whether the window fills the screen."""
        return bool(glfw.get_window_monitor(self._window))

    @property
    def chosen_size(self) -> tuple[int, int] | None:
        """The size that the user gave the window [screen coordinates]; None for its own."""
        size = self._windowed_place[2:] if self.fills_screen else glfw.get_window_size(self._window)
        return self._chosen_size if size == self._first_size else size

    def quit(self) -> None:
        """Ask for the window to be closed."""
        glfw.set_window_should_close(self._window, True)

    def toggle_full_screen(self) -> None:
        """Fill the screen, or return to the place and size from before."""
        if self.fills_screen:
            no_monitor: Any = None  # windowed; glfw's type hints do not allow None
            glfw.set_window_monitor(self._window, no_monitor, *self._windowed_place, 0)
            return
        place, size = glfw.get_window_pos(self._window), glfw.get_window_size(self._window)
        self._windowed_place = (*place, *size)
        monitor = glfw.get_primary_monitor()
        mode = glfw.get_video_mode(monitor)
        wide, high = mode.size
        glfw.set_window_monitor(self._window, monitor, 0, 0, wide, high, mode.refresh_rate)

    def close(self) -> None:
        """Close the window and release its context."""
        if not self._open:
            return
        self._open = False
        self.release()
        for painter in self._painters:
            painter.release()
        self.context.release()
        glfw.destroy_window(self._window)
        glfw.terminate()

    def release(self) -> None:
        """Release what else draws in the context, while there still is one."""

    def in_picture(self, x: float, y: float) -> tuple[float, float]:
        """Return the place in the picture [px] of one in the window [screen coordinates]."""
        left, _, shown_width, shown_height = self.picture_place(*self._whole)
        wide, high = self._framebuffer_size
        columns, rows = glfw.get_window_size(self._window)  # in other units on a fine screen
        top = (high - shown_height) // 2
        scale = self._whole[0] / max(1, shown_width)
        x_px, y_px = x * wide / max(1, columns), y * high / max(1, rows)
        return (x_px - left) * scale, (y_px - top) * scale

    def picture_place(self, width: int, height: int) -> tuple[int, int, int, int]:
        """Return left, bottom, width and height of a picture in the window [px]."""
        wide, high = self._framebuffer_size
        scale = min(wide / width, high / height)
        shown = (round(width * scale), round(height * scale))
        return (wide - shown[0]) // 2, (high - shown[1]) // 2, *shown

    def _on_key(self, _window: Any, key: int, scan: int, action: int, mods: int) -> None:
        name = key_name(key, scan)
        if name is not None and action in (glfw.PRESS, glfw.REPEAT):
            shift = bool(mods & glfw.MOD_SHIFT)
            self.handle_key(name, shift=shift, repeated=action == glfw.REPEAT)

    def _on_size(self, _window: Any, wide: int, high: int) -> None:
        # Kept, as each question to the display takes a tenth of a millisecond.
        self._framebuffer_size = wide, high

    def _on_character(self, _window: Any, code: int) -> None:
        if not self.handle_character(chr(code)) and chr(code) in TYPED_KEYS:
            self.handle_key(chr(code))

    def _on_pointer(self, _window: Any, x: float, y: float) -> None:
        self.handle_pointer(*self.in_picture(x, y))

    def _on_button(self, _window: Any, button: int, action: int, _mods: int) -> None:
        if button == glfw.MOUSE_BUTTON_LEFT:
            self.handle_button(action == glfw.PRESS)

    def _store_error(self, _code: int, text: bytes | str) -> None:
        self._error = text.decode(errors="replace") if isinstance(text, bytes) else text


def _fitting_size(size: tuple[int, int]) -> tuple[int, int]:
    """Return the size of a window for pictures of `size` that fits on the desktop.

    On a fine screen it is larger where the system counts in pixels.
    """
    with contextlib.suppress(Exception):
        monitor = glfw.get_primary_monitor()
        _, _, wide, high = glfw.get_monitor_workarea(monitor)
        counts_pixels = glfw.get_platform() in (glfw.PLATFORM_X11, glfw.PLATFORM_WIN32)
        fine = glfw.get_monitor_content_scale(monitor)[0] if counts_pixels else 1.0
        scale = min(fine, 0.95 * wide / size[0], 0.92 * high / size[1])
        return round(size[0] * scale), round(size[1] * scale)
    return size
