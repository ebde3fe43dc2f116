"""The options of the commands that open a window: one for each preference."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cubeling.app.errors import AppError
from cubeling.app.ui.panels import PANELS

if TYPE_CHECKING:
    from cubeling.affect import Emotion
    from cubeling.app.preferences import PreferenceStore
    from cubeling.app.session import SessionOptions

DEFAULT_FILE = Path(typer.get_app_dir("cubeling")) / "preferences.toml"
"""Where the system keeps such files: in ~/.config, ~/Library/Application Support, or %APPDATA%."""

HELP_PANEL = "Window and sound (what you change in the window is kept for the next time)"


@dataclass(frozen=True)
class Flag:
    """The option that sets a preference."""

    name: str
    """As typer takes it: "--volume", "--mirror/--no-mirror"."""

    help: str
    """What `--help` says about it."""

    kind: Any
    """Type of its value on the command line."""

    parse: Callable[[Any], Any] = lambda value: value
    """Makes the preference of its value; raises AppError."""

    more: Mapping[str, Any] = field(default_factory=dict)
    """Further arguments of `typer.Option`."""


def panels_of(text: str) -> tuple[str, ...]:
    """Return the panels in a list that a user types; raises AppError for one that there is not.

    >>> panels_of("tracking, emotion@0.9:0.2"), panels_of("none")
    (('tracking', 'emotion@0.9:0.2'), ())
    """
    names = tuple(text.replace(",", " ").split())
    if names == ("none",):
        return ()
    for name in names:
        if name.partition("@")[0] not in PANELS:
            raise AppError(f"there is no panel '{name}': choose from {', '.join(PANELS)}")
    return names


def size_of(text: str) -> tuple[int, int]:
    """Return width and height of "1280x720"; raises AppError."""
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise AppError(f"a window's size is given as 1280x720, not as '{text}'")
    return int(width), int(height)


def emotion_of(word: str) -> Emotion | None:
    """Return the emotion of a word, None for ""; raises AppError."""
    from cubeling.affect import WORD_PLACES, Emotion

    if not word:
        return None
    if word not in WORD_PLACES:
        raise AppError(f"no emotion is called '{word}': choose one of {', '.join(WORD_PLACES)}")
    return Emotion(*WORD_PLACES[word], word)


FLAGS: dict[str, Flag] = {
    "panels": Flag(
        "--panels", "Panels to open: tracking,emotion …, or none; P shows and hides them.", str,
        panels_of,
    ),
    "panels_shown": Flag("--show-panels/--hide-panels", "Begin with the open panels shown.", bool),
    "window_size": Flag("--size", "Size of the window, as 1280x720.", str, size_of),
    "full_screen": Flag("--full-screen/--windowed", "Fill the screen.", bool),
    "mirror": Flag("--mirror/--no-mirror", "Show the picture as in a mirror.", bool),
    "volume": Flag(
        "--volume", "How loud the sounds are.", float,
        more={"min": 0.0, "max": 1.0, "envvar": "CUBELING_VOLUME"},
    ),
    "muted": Flag(
        "--mute/--no-mute", "Be silent; a video has no sound then.", bool,
        more={"envvar": "CUBELING_MUTE"},
    ),
}  # fmt: skip
"""The option of every preference."""


@dataclass(frozen=True)
class GivenPreferences:
    """What the command line says of the preferences."""

    values: Mapping[str, Any]
    """The preferences that were given."""

    file: Path | None
    """The file that keeps the others; None for none."""

    def open(self, options: SessionOptions) -> tuple[SessionOptions, PreferenceStore]:
        """Return the options and the preferences of a session.

        Without a window, no file is read or written.
        """
        from cubeling.app.preferences import PreferenceStore

        store = PreferenceStore(self.file if options.windowed else None, self.values)
        return replace(options, volume=store.now.volume, muted=store.now.muted), store


Command = Callable[..., None]


def with_preferences(command: Command) -> Command:
    """Give a command the options of all preferences; it gets them as `preferences`."""
    signature = inspect.signature(command, eval_str=True)
    own = [each for each in signature.parameters.values() if each.name != "preferences"]
    added = [_parameter(name, flag) for name, flag in FLAGS.items()]
    where = [
        inspect.Parameter(
            "preferences_file",
            inspect.Parameter.KEYWORD_ONLY,
            default=DEFAULT_FILE,
            annotation=_option(
                Path, "--preferences", f"The file that keeps it; {DEFAULT_FILE} by default."
            ),
        ),
        inspect.Parameter(
            "keep_preferences",
            inspect.Parameter.KEYWORD_ONLY,
            default=True,
            annotation=_option(bool, " /--no-preferences", "Neither read nor write that file."),
        ),
    ]
    parameters = [*own, *added, *where]

    @functools.wraps(command)
    def run_command(**arguments: Any) -> None:
        given = {name: arguments.pop(name) for name in FLAGS}
        values = {name: FLAGS[name].parse(v) for name, v in given.items() if v is not None}
        file, keep = arguments.pop("preferences_file"), arguments.pop("keep_preferences")
        command(**arguments, preferences=GivenPreferences(values, file if keep else None))

    run_command.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    run_command.__annotations__ = {each.name: each.annotation for each in parameters}
    return run_command


def _parameter(name: str, flag: Flag) -> inspect.Parameter:
    kind = _option(flag.kind | None, flag.name, flag.help, **flag.more)
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=kind)


def _option(kind: Any, name: str, words: str, **more: Any) -> Any:
    """Return the annotation of an option, as typer reads it."""
    return Annotated[
        kind, typer.Option(name, help=words, rich_help_panel=HELP_PANEL, show_default=False, **more)
    ]
