"""An editor without a window, in a folder of its own."""

from collections.abc import Callable, Iterator
from pathlib import Path

import moderngl
import pytest

from cubeling.app.gesture_editor.session import EditorSession
from cubeling.characters.errors import CharacterError
from cubeling.characters.rendering import create_context


@pytest.fixture(scope="session")
def context() -> Iterator[moderngl.Context]:
    """Where previews draw."""
    try:
        made = create_context()
    except CharacterError as error:
        pytest.skip(f"no OpenGL here: {error}")
    yield made
    made.release()


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
