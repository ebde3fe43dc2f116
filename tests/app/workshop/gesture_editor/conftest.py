"""Editors without a window, each in a folder of its own."""

from collections.abc import Callable, Iterator
from pathlib import Path

import moderngl
import pytest

from cubeling.app.workshop.gesture_editor import session as editor_session
from cubeling.app.workshop.gesture_editor.preview import Preview
from cubeling.app.workshop.gesture_editor.session import EditorSession
from cubeling.characters.errors import CharacterError
from cubeling.characters.rendering import create_context
from tools.gesture_tour import OffscreenEditor

SMALL_PX = 620, 370
"""Size of a window that costs little to draw, in which everything is half as large [px]."""


@pytest.fixture(scope="session")
def context() -> Iterator[moderngl.Context]:
    """Where previews draw."""
    try:
        made = create_context()
    except CharacterError as error:
        pytest.skip(f"no OpenGL here: {error}")
    yield made
    made.release()


@pytest.fixture(scope="module")
def kept_previews(context: moderngl.Context) -> Iterator[None]:
    """Let the editors of a module draw in one preview, as the next user of a long session does.

    To load and upload a character takes as long as ten of its pictures.
    """
    preview = Preview(context)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(editor_session, "Preview", lambda _context: preview)
        patch.setattr(preview, "release", lambda: None)
        yield
    preview.release()


@pytest.fixture
def opened(context: moderngl.Context, tmp_path: Path) -> Iterator[Callable[..., EditorSession]]:
    """Open an editor on a gesture; all of them are closed at the end."""
    sessions: list[EditorSession] = []

    def open_editor(name: str = "", character: str = "robot") -> EditorSession:
        sessions.append(EditorSession(context, tmp_path / "gestures", character, name))
        return sessions[-1]

    yield open_editor
    for session in sessions:
        session.close()


@pytest.fixture
def editing(
    context: moderngl.Context, opened: Callable[..., EditorSession]
) -> Iterator[Callable[..., OffscreenEditor]]:
    """Open an editor with its panels; all of them are closed at the end."""
    editors: list[OffscreenEditor] = []

    def open_editor(
        name: str = "", character: str = "robot", size: tuple[int, int] = SMALL_PX
    ) -> OffscreenEditor:
        editors.append(OffscreenEditor(context, opened(name, character), size))
        return editors[-1]

    yield open_editor
    for editor in editors:
        editor.close()
