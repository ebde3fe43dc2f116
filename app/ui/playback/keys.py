"""The keys: one table for the handling, the card over the picture and the documents."""

import math
from dataclasses import dataclass
from itertools import groupby

from cubeling.app.ui.playback.requests import (
    Listen,
    MarkMoment,
    OpenCube,
    Pause,
    PlayScenario,
    Record,
    Request,
    Seek,
    SeekTo,
    StartOver,
    StepFrames,
    WindowRequest,
)

LONG_SEEK_S, SHORT_SEEK_S = 5.0, 1.0
"""How far an arrow key goes, and with Shift [s]."""


@dataclass(frozen=True)
class Binding:
    """What a key does."""

    key: str
    """Its name as it is shown: "Space", "←", "S", "Shift ←"."""

    request: Request
    """What it asks for."""

    help: str
    """What it does, in a few words; neighbours with the same words are shown as one row."""

    group: str
    """The heading under which it is shown."""

    repeats: bool = False
    """Whether holding it repeats it."""


def _row(
    group: str, words: str, requests: dict[str, Request], *, repeats: bool = False
) -> tuple[Binding, ...]:
    """Return the bindings of keys that are shown as one row."""
    return tuple(Binding(key, request, words, group, repeats) for key, request in requests.items())


BINDINGS: tuple[Binding, ...] = (
    *_row("Play", "pause, and go on", {"Space": Pause()}),
    *_row("Play", "start over: a new path, a neutral mood", {"C": StartOver()}),
    *_row(
        "Play",
        "play another scenario",
        {f"{number}": PlayScenario(number) for number in range(1, 10)},
    ),
    *_row("Play", "choose a scenario by its picture", {"0": WindowRequest.SCENARIOS}),
    *_row("Play", "look into the cube, and close it", {"I": OpenCube()}),
    *_row("Play", "say something in English, and end it", {"F2": Listen()}),
    *_row("Play", "menu: scenario, camera, character, robot", {"Tab": WindowRequest.MENU}),
    *_row("Keep", "keep the picture as a PNG file", {"S": WindowRequest.SNAPSHOT}),
    *_row("Keep", "record a session, and end it", {"R": Record()}),
    *_row("Keep", "mark this moment; then a digit, or Enter and a name", {"B": MarkMoment()}),
    *_row("View", "mirror the picture", {"M": WindowRequest.MIRROR}),
    *_row("View", "full screen, and back", {"F": WindowRequest.FULL_SCREEN}),
    *_row("View", "panels with details", {"P": WindowRequest.PANELS}),
    *_row("View", "show these keys", {"?": WindowRequest.KEYS, "F1": WindowRequest.KEYS}),
    *_row("View", "close a card, then the window", {"Esc": WindowRequest.BACK}),
    *_row("View", "end the session", {"Q": WindowRequest.QUIT}),
    *_row(
        "Recordings",
        "5 s back or ahead",
        {"←": Seek(-LONG_SEEK_S), "→": Seek(LONG_SEEK_S)},
        repeats=True,
    ),
    *_row(
        "Recordings",
        "1 s back or ahead",
        {"Shift ←": Seek(-SHORT_SEEK_S), "Shift →": Seek(SHORT_SEEK_S)},
        repeats=True,
    ),
    *_row(
        "Recordings",
        "one frame back or ahead",
        {",": StepFrames(-1), ".": StepFrames(1)},
        repeats=True,
    ),
    *_row("Recordings", "to the start, to the end", {"Home": SeekTo(0.0), "End": SeekTo(math.inf)}),
)
"""All keys, in the order in which they are shown."""

BY_KEY = {binding.key: binding for binding in BINDINGS}

MAX_LISTED_KEYS = 2
"""A row of more keys names the first and the last."""


@dataclass(frozen=True)
class KeyHelp:
    """A row of the list of keys."""

    group: str
    """The heading above it."""

    keys: tuple[str, ...]
    """The keys, or "…" between the first and the last."""

    help: str
    """What the card of keys says about them."""


def find_binding(key: str, shift: bool = False) -> Binding | None:
    """Return what a key does, alone or with Shift.

    >>> find_binding("←", shift=True).request
    Seek(seconds=-1.0)
    >>> find_binding("S", shift=True).request is find_binding("S").request
    True
    """
    return (BY_KEY.get(f"Shift {key}") if shift else None) or BY_KEY.get(key)


def key_rows() -> tuple[KeyHelp, ...]:
    """Return the rows of the list of keys."""
    rows = []
    for (group, words), bindings in groupby(BINDINGS, lambda each: (each.group, each.help)):
        keys = tuple(binding.key for binding in bindings)
        if len(keys) > MAX_LISTED_KEYS:
            keys = (keys[0], "…", keys[-1])
        rows.append(KeyHelp(group, keys, words))
    return tuple(rows)


def key_table() -> str:
    """Return the list of keys as a table for the documents, in Markdown."""
    lines = ["| key | |", "|---|---|"]
    for row in key_rows():
        lines.append(f"| {' '.join(_code(key) for key in row.keys)} | {row.help} |")
    return "\n".join(lines)


def _code(key: str) -> str:
    return key if key == "…" else f"`{key}`"
