"""The options of a character: how it moves, and how it speaks with its body."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from cubeling.characters.speech import SpeechProfile

CHARACTER_GROUP, SPEECH_GROUP = "The character", "Speech"
"""Headings of these options in a help."""

VOICE_VARIABLE = "CUBELING_VOICE"
"""Environment variable of the option `--voice`."""

OwnMotionsOption = Annotated[
    bool,
    typer.Option(
        "--own-motions-only",
        help="A character plays only clips of its own, and none keeps its rest pose, instead of "
        "borrowing those of a bundled one of its kind.",
        rich_help_panel=CHARACTER_GROUP,
    ),
]
VoiceOption = Annotated[
    str | None,
    typer.Option(
        help="A program that speaks, instead of eSpeak NG; see docs/speaking.md.",
        envvar=VOICE_VARIABLE,
        rich_help_panel=SPEECH_GROUP,
    ),
]
ProfileOption = Annotated[
    str,
    typer.Option(
        help="How the body speaks: usual, lively, calm, or a .toml file of "
        "cubeling speak --save-profile.",
        metavar="NAME|FILE",
        rich_help_panel=SPEECH_GROUP,
    ),
]
SettingsOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        help="Change a field of the profile, such as gesture_emphasis=0.5; may be given "
        "several times. docs/speaking.md lists the fields, and so does a wrong name.",
        metavar="FIELD=VALUE",
        rich_help_panel=SPEECH_GROUP,
    ),
]


def profile_of(name: str, settings: list[str] | None) -> SpeechProfile:
    """Return the profile that the two options ask for."""
    from cubeling.characters.speech import SpeechProfile

    return SpeechProfile.load(name).with_settings(settings or ())
