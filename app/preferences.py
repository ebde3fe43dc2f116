"""How the player likes the window and the sound, kept from one session to the next.

A preference changes nothing that is recorded: what does (the scenario, its settings, where the
eyes look, the robot) is an option of each session, see `cubeling.app.session.SessionOptions`.

To add one, write a field of `Preferences` and a line of `FLAGS` in
`app.commands.play.preference_options`. Who uses it reads `PreferenceStore.now`, and calls
`change` when the player changes it; it is kept at the end.
"""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any

from cubeling.app.errors import AppError
from cubeling.files import whole_file
from cubeling.toml_file import TomlTable, read, toml_kind

PROGRAM = "cubeling"
"""Value of the key `program` in every file of preferences; no other file is overwritten."""

PREFERENCES_FILE = toml_kind("preferences", AppError, "cubeling.app.preferences:read_preferences")
"""The file that keeps the preferences."""

FILE_COMMENT = (
    "# How the window of Cubeling was left. Options of the command line override it;\n"
    "# remove this file to start afresh.\n"
)

MIN_WINDOW_SIZE = (320, 180)
"""Smallest window [screen coordinates]."""


@dataclass(frozen=True)
class Preferences:
    """What a session begins with; raises AppError if a value is out of its range."""

    panels: tuple[str, ...] = ("tracking", "emotion")
    """The open panels, each "NAME" or, where the player has moved it, "NAME@X:Y": how much of the
    free width is to its left and of the free height above it, 0…1."""

    panels_shown: bool = False
    """Whether the open panels are shown."""

    window_size: tuple[int, int] | None = None
    """Width and height of the window [screen coordinates]; None for the size of the pictures."""

    full_screen: bool = False
    """Whether the window fills the screen."""

    mirror: bool = False
    """Whether the picture is shown as in a mirror."""

    volume: float = 0.5
    """How loud sounds are, 0…1."""

    muted: bool = False
    """Whether sounds and voices are off, whatever the volume."""

    welcomed: bool = False
    """Whether the card with all scenarios was seen, which a camera's first session begins with."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.volume <= 1.0:
            raise AppError(f"the volume must be from 0 to 1, not {self.volume:g}")
        size = self.window_size
        if size is not None and (size[0] < MIN_WINDOW_SIZE[0] or size[1] < MIN_WINDOW_SIZE[1]):
            least = "x".join(map(str, MIN_WINDOW_SIZE))
            raise AppError(f"the window must be at least {least}, not {size[0]}x{size[1]}")


class PreferenceStore:
    """The preferences while a session runs, and the file that keeps them.

    Parameters
    ----------
    path
        The file; None to keep nothing. It need not exist. One that is broken or not ours is left
        as it is, and `problem` says so.
    given
        What the user chose for this session: it overrides the file, and is not kept.
    """

    def __init__(self, path: Path | None = None, given: Mapping[str, Any] | None = None) -> None:
        self.problem: str | None
        """Why the file is not used, in one line; None if it is, or if there is none."""
        self._path = path
        kept, self.problem = read_preferences(path)
        self._began = replace(kept, **(given or {}))
        self.now = self._began
        """The preferences now."""

    @property
    def folder(self) -> Path | None:
        """The folder of the file; None where nothing is kept."""
        return None if self._path is None else self._path.parent

    def change(self, **fields: Any) -> None:
        """Note what the player changed."""
        self.now = replace(self.now, **fields)

    def save(self) -> None:
        """Write what the player changed to the file, whole or not at all; no change, no file."""
        before, after = asdict(self._began), asdict(self.now)
        changed = {name: value for name, value in after.items() if value != before[name]}
        if self._path is None or self.problem is not None or not changed:
            return
        # Another session may have written it meanwhile.
        kept, self.problem = read_preferences(self._path)
        if self.problem is None:
            self.problem = _write(self._path, replace(kept, **changed))


def read_preferences(path: Path | None) -> tuple[Preferences, str | None]:
    """Return the preferences in a file, and why they are the default ones if it is of no use."""
    if path is None or not path.exists():
        return Preferences(), None
    try:
        content = read(path, PREFERENCES_FILE)
        if content and content.get("program") != PROGRAM:
            raise AppError(f'{path}: it has no line program = "{PROGRAM}"')
        known = {field.name for field in fields(Preferences)}  # a newer program may have more
        values = {name: value for name, value in content.items() if name in known}
        return TomlTable(values, str(path), error=AppError).fill(Preferences), None
    except AppError as error:
        return Preferences(), f"the preferences are ignored: {error}"


def _write(path: Path, preferences: Preferences) -> str | None:
    """Write a file, whole or not at all; return why it is not written."""
    try:
        with whole_file(path, AppError) as partial:
            partial.parent.mkdir(parents=True, exist_ok=True)
            partial.write_text(_document(preferences), encoding="utf-8")
    except AppError as error:
        return f"the preferences are not kept: {error}"
    return None


def _document(preferences: Preferences) -> str:
    """Return a file's text. JSON writes these values as TOML does, but for the character DEL."""
    values = {"program": PROGRAM, **asdict(preferences)}
    lines = [
        f"{name} = {json.dumps(value, ensure_ascii=False)}\n"
        for name, value in values.items()
        if value is not None
    ]
    return FILE_COMMENT + "".join(lines).replace("\x7f", "\\u007f")
