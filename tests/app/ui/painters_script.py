"""Paints a window in both ways, and looks at the screen; `test_window` runs this in a process."""

import os
from pathlib import Path
from typing import Any

import glfw
import numpy as np

from cubeling.app.ui.canvas import Canvas
from cubeling.app.ui.window.gl_painter import GLPainter
from cubeling.app.ui.window.memory_painter import MemoryPainter
from cubeling.app.ui.window.shared_picture import SharedPicture
from cubeling.app.ui.window.surface import WindowSurface
from tests.virtual_screen import screen_pixels

SIZE = (320, 200)

WAYS: dict[str, dict[str, Any]] = {
    "plain": {},
    "mirrored": {"mirrored": True},
    "dimmed": {"brightness": 0.45},
    "above a strip": {"below": 40},
}


def main(screen: Path) -> None:
    """Paint the same with OpenGL and in memory, in several ways and sizes."""
    rows, columns = np.mgrid[: SIZE[1], : SIZE[0]]
    picture = np.stack([rows, columns // 2, 255 - rows], axis=2).astype(np.uint8)
    canvas = Canvas(300, 120, 0.5)
    canvas.text(20, 60, "words", 40, (10, 20, 200))
    cards = [canvas.card(30, 40), canvas.card(-100, 350), canvas.card(400, -30)]
    with WindowSurface(SIZE, "painters") as window:
        opengl, memory = window._painters
        assert isinstance(opengl, GLPainter)
        assert isinstance(memory, MemoryPainter)
        for shown_size in (SIZE, (400, 200), (500, 400)):  # margins beside it, and above and below
            glfw.set_window_size(window._window, *shown_size)
            while window._framebuffer_size != shown_size:
                window.poll()
            window.paint(picture, with_opengl=True)
            window.present()  # OpenGL's buffers get the window's size here
            for name, given in WAYS.items():
                painted = []
                for with_opengl in (True, False):
                    window.paint(picture, cards[:1], with_opengl=with_opengl, **given)
                    window.paint_cards(cards[1:])
                    painted.append(window.pixels().astype(int))
                difference = np.abs(painted[0] - painted[1])[: shown_size[1] - 48]
                # Below the picture nothing is painted where a timeline follows.
                assert difference.max() <= 3, (name, shown_size, difference.max())
                window.present()
                memory._shared.pixels(*shown_size)  # waits for the server
                x, y = glfw.get_window_pos(window._window)
                seen = screen_pixels(screen)[y : y + shown_size[1], x : x + shown_size[0], :3]
                np.testing.assert_array_equal(seen, painted[1])
        assert SharedPicture.open(1) is None, "there is no such window"
        os.environ["DISPLAY"] = ":1234567"
        assert SharedPicture.open(glfw.get_x11_window(window._window)) is None, "no such server"


if __name__ == "__main__":
    main(Path(os.environ["SCREEN_FILE"]))
