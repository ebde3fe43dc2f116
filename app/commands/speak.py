"""The command `cubeling speak`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.markup import escape

from cubeling.affect import Emotion
from cubeling.app.commands.output import OverwriteOption, chosen_output
from cubeling.app.commands.session.play import VoiceOption
from cubeling.app.commands.session.preference_options import emotion_of, size_of
from cubeling.app.counted import counted
from cubeling.app.errors import AppError
from cubeling.app.output_path import check_output
from cubeling.app.speaking.view import View
from cubeling.app.ui.display import has_display
from cubeling.app.ui.output_formats import VIDEO_FORMATS
from cubeling.characters.speech import DATABASES, DEFAULT_PROFILE, viseme_sets

if TYPE_CHECKING:
    from cubeling.characters import Character
    from cubeling.characters.speech import Speech, TaggedText

MAX_TEXT_BYTES = 100_000
"""Larger files are no speeches."""

PROFILE_PANEL = "How the body speaks"


def _profile_option(name: str, words: str) -> Any:
    """Return an option that changes the profile."""
    return typer.Option(name, help=words, rich_help_panel=PROFILE_PANEL, show_default=False)


ProfileOption = Annotated[
    Path | None,
    _profile_option("--profile", "A profile of --save-profile; the options here change it."),
]
DatabaseOption = Annotated[
    str | None, _profile_option("--database", f"Which gestures: {', '.join(DATABASES)}.")
]
VisemesOption = Annotated[
    str | None, _profile_option("--visemes", f"The set of visemes: {', '.join(viseme_sets())}.")
]

OUTPUT_SUFFIXES = (".wav", ".bvh", *VIDEO_FORMATS)


def speak(
    text: Annotated[
        str, typer.Argument(help="What is said; tags name gestures, see docs/speaking.md.")
    ] = "",
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="A video, a .wav or a .bvh file; default: speech.mp4."),
    ] = None,
    overwrite: OverwriteOption = False,
    file: Annotated[Path | None, typer.Option(help="A file with the text.")] = None,
    audio: Annotated[
        Path | None, typer.Option(help="A recording of the speech, instead of the voice.")
    ] = None,
    live: Annotated[
        bool, typer.Option("--live", help="Move with your microphone, in a window, at once.")
    ] = False,
    character: Annotated[
        str, typer.Option(help="Who says it: bundled, or a .glb, .gltf or .vrm file.")
    ] = "human",
    voice: VoiceOption = None,
    lang: Annotated[
        str, typer.Option(help="Its language, as [cyan]espeak-ng --voices[/] lists them.")
    ] = "en",
    emotion: Annotated[
        str, typer.Option(help="A word such as happy, sad or angry: for face, body and voice.")
    ] = "",
    view: Annotated[View, typer.Option(help="What is seen of the speaker.")] = "hands",
    subtitles: Annotated[
        bool, typer.Option("--subtitles/--no-subtitles", help="Show what is being said.")
    ] = False,
    profile: ProfileOption = None,
    save_profile: Annotated[
        Path | None, typer.Option(help="Write the profile with the options below to this file.")
    ] = None,
    gestures: Annotated[
        Path | None, typer.Option(help="A file of [cyan]cubeling gestures learn[/].")
    ] = None,
    database: DatabaseOption = None,
    threshold: Annotated[
        float | None,
        _profile_option("--threshold", "How alike gestures are that follow each other; 0: enough."),
    ] = None,
    neck_weight: Annotated[
        float | None,
        _profile_option("--neck-weight", "Weight of the neck where postures are compared."),
    ] = None,
    spine_weight: Annotated[
        float | None,
        _profile_option("--spine-weight", "Weight of the spine where postures are compared."),
    ] = None,
    arm_weight: Annotated[
        float | None,
        _profile_option("--arm-weight", "Weight of the upper arms where postures are compared."),
    ] = None,
    forearm_weight: Annotated[
        float | None,
        _profile_option("--forearm-weight", "Weight of the forearms where postures are compared."),
    ] = None,
    gesture_emphasis: Annotated[
        float | None, _profile_option("--gesture-emphasis", "Stronger or weaker gestures, -1 to 1.")
    ] = None,
    face_emphasis: Annotated[
        float | None, _profile_option("--face-emphasis", "A livelier or a calmer mouth, -1 to 1.")
    ] = None,
    visemes: VisemesOption = None,
    accent_threshold: Annotated[
        float | None,
        _profile_option("--accent-threshold", "Least strength of an accent, of the strongest."),
    ] = None,
    accent_distance: Annotated[
        float | None, _profile_option("--accent-distance", "Least time between accents [s].")
    ] = None,
    size: Annotated[str, typer.Option(help="Size of the video.")] = "640x480",
    rate: Annotated[float, typer.Option(help="Frames a second.", min=1.0, max=120.0)] = 25.0,
    seed: Annotated[int, typer.Option(help="Of blinks, and choices between gestures.")] = 0,
) -> None:
    """Let a character say something, with its mouth, face and hands.

    Example: [cyan]cubeling speak "Hello! I am a paper cube." -o hello.mp4[/]
    """
    from cubeling.app.pipeline.spoken_line import SpokenLine
    from cubeling.app.sound import write_wave
    from cubeling.app.sound.session_sound import at_sample_rate
    from cubeling.app.speaking.live import speak_live
    from cubeling.app.speaking.performance import Direction, performed, write_video
    from cubeling.characters import Character
    from cubeling.characters.model import gestures_for, read_text, save_bvh, with_root_joint
    from cubeling.characters.speech import SpeechProfile, TaggedText, blood_of, utterance_of

    given = {
        "database": database,
        "threshold": threshold,
        "neck_weight": neck_weight,
        "spine_weight": spine_weight,
        "arm_weight": arm_weight,
        "forearm_weight": forearm_weight,
        "gesture_emphasis": gesture_emphasis,
        "face_emphasis": face_emphasis,
        "visemes": visemes,
        "accent_threshold": accent_threshold,
        "accent_distance": accent_distance,
    }
    how = replace(
        DEFAULT_PROFILE if profile is None else SpeechProfile.load(profile),
        **{name: value for name, value in given.items() if value is not None},  # type: ignore[arg-type]
    )
    if save_profile is not None:
        check_output(save_profile, "profile", (".toml",), overwrite=overwrite)
        how.save(save_profile)
    body = with_root_joint(Character.load(character))
    if gestures is not None:
        body = replace(body, gestures=gestures_for(gestures, body.skeleton, character))
    feels, pixels = emotion_of(emotion), size_of(size)
    if live:
        if not has_display():
            raise AppError("there is no display here: --live needs a window")
        speak_live(body, size=pixels, view=view, emotion=feels, profile=how)
        return
    target = chosen_output(output, "speech.mp4", "speech", OUTPUT_SUFFIXES, overwrite)
    marked = text if file is None else read_text(file, MAX_TEXT_BYTES)
    if not marked.strip() and audio is None:
        raise AppError("there is nothing to say: give a text, --file, --audio or --live")
    tagged = TaggedText.read(marked)
    _check_gestures(tagged, body)
    console = Console(highlight=False)
    with console.status("speaking"):
        if audio is None:
            speech = _spoken(tagged.text, lang, feels, voice)
        else:
            speech = _heard(audio, tagged, lang, voice)
        utterance = utterance_of(speech, tagged, how.accents)
        line = SpokenLine(utterance, speech.samples, speech.rate, how)
        if target.suffix.lower() == ".wav":
            write_wave(target, at_sample_rate(line))
        else:
            direction = Direction(feels, seed)
            clip = performed(body, line, direction, rate)
            if target.suffix.lower() == ".bvh":
                save_bvh(clip, body.skeleton, body.anatomy, target)
            else:
                write_video(
                    target,
                    body,
                    clip,
                    line,
                    size=pixels,
                    view=view,
                    subtitles=subtitles,
                    blood=blood_of(feels),
                )
    console.print(
        f"[bold]{escape(str(target))}[/] is written: {speech.duration:.1f} s of speech, "
        f"{counted(len(utterance.words), 'word')}, {counted(len(utterance.accents), 'accent')}",
        soft_wrap=True,
    )


def _spoken(text: str, language: str, emotion: Emotion | None, command: str | None) -> Speech:
    """Return a text as the voice speaks it."""
    from cubeling.app.speaking.voices import open_voice
    from cubeling.characters.speech import manner_of, say

    with open_voice(command) as voice:
        return say(voice, text, language, manner_of(emotion))


def _heard(audio: Path, tagged: TaggedText, language: str, command: str | None) -> Speech:
    """Return a recording, with the times of its words where the text is known."""
    from cubeling.app.speaking.voices import open_voice
    from cubeling.characters.speech import align, phones_from_sound, read_speech

    recording = read_speech(audio)
    if not tagged.text.strip():
        phones = phones_from_sound(recording.samples, recording.rate)
        return replace(recording, phones=phones)
    with open_voice(command) as voice:
        return align(recording, tagged.text, voice, language)


def _check_gestures(tagged: TaggedText, character: Character) -> None:
    """Refuse a gesture that the character does not know."""
    from cubeling.characters import known_gestures

    known = known_gestures(character)
    for span in tagged.spans:
        if span.name not in known:
            raise AppError(
                f"{character.name} has no gesture '{span.name}': choose one of {', '.join(known)}"
            )
