"""The command `cubeling speak`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.markup import escape

from cubeling.affect import Emotion
from cubeling.app.commands.character_options import (
    SPEECH_GROUP,
    OwnMotionsOption,
    ProfileOption,
    SettingsOption,
    VoiceOption,
    profile_of,
)
from cubeling.app.commands.output import OverwriteOption, VideoCodecOption, chosen_output
from cubeling.app.commands.play.preference_options import emotion_of, size_of
from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.input_path import check_character, check_input
from cubeling.app.output_path import check_output
from cubeling.app.speaking.view import View
from cubeling.app.ui.display import has_display
from cubeling.app.ui.output_formats import VIDEO_FORMATS, check_video_codec

if TYPE_CHECKING:
    from cubeling.characters import Character
    from cubeling.characters.speech import Speech, TaggedText

NOTHING_TO_SAY = "there is nothing to say: give a text, --file, --audio or --live"

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
    codec: VideoCodecOption = "auto",
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
    own_motions_only: OwnMotionsOption = False,
    voice: VoiceOption = None,
    language: Annotated[
        str,
        typer.Option(
            help="Its language, as espeak-ng --voices lists them.", rich_help_panel=SPEECH_GROUP
        ),
    ] = "en",
    emotion: Annotated[
        str, typer.Option(help="A word such as happy, sad or angry: for face, body and voice.")
    ] = "",
    view: Annotated[View, typer.Option(help="What is seen of the speaker.")] = "hands",
    subtitles: Annotated[
        bool, typer.Option("--subtitles/--no-subtitles", help="Show what is being said.")
    ] = False,
    profile: ProfileOption = "usual",
    settings: SettingsOption = None,
    save_profile: Annotated[
        Path | None,
        typer.Option(
            help="Write the profile, as changed by --set, to this file.",
            rich_help_panel=SPEECH_GROUP,
        ),
    ] = None,
    gestures: Annotated[
        Path | None,
        typer.Option(help="A file of cubeling gesture learn.", rich_help_panel=SPEECH_GROUP),
    ] = None,
    size: Annotated[str, typer.Option(help="Size of the video.")] = "640x480",
    rate: Annotated[float, typer.Option(help="Frames a second.", min=1.0, max=120.0)] = 25.0,
    seed: Annotated[int, typer.Option(help="Of blinks, and choices between gestures.")] = 0,
) -> None:
    """Let a character say something, with its mouth, face and hands.

    Example: cubeling speak "Hello! I am a paper cube." -o hello.mp4
    """
    how, feels, pixels = profile_of(profile, settings), emotion_of(emotion), size_of(size)
    if save_profile is not None:
        check_output(save_profile, "profile", (".toml",), overwrite=overwrite)
    if not live and not text.strip() and file is None and audio is None:
        raise AppError(NOTHING_TO_SAY)
    target = chosen_output(output, "speech.mp4", "speech", OUTPUT_SUFFIXES, overwrite or live)
    check_video_codec(target, codec)
    check_input(file, "text")
    check_input(audio, "sound")
    check_input(gestures, "gesture library")
    check_character(character)
    if live and not has_display():
        raise AppError("there is no display here: --live needs a window")
    # Nothing above needs more than numpy: what is misspelt is refused before the rest is loaded.
    from cubeling.app.pipeline.table.spoken_line import SpokenLine
    from cubeling.app.sound import write_wave
    from cubeling.app.sound.session_sound import at_sample_rate
    from cubeling.app.speaking.live import speak_live
    from cubeling.app.speaking.speech_video import Direction, speech_clip, write_video
    from cubeling.characters import load_to_play
    from cubeling.characters.model import gestures_for, save_bvh, with_root_joint
    from cubeling.characters.speech import TaggedText, blood_of, utterance_of

    if save_profile is not None:
        how.save(save_profile)
    body = with_root_joint(load_to_play(character, own_motions_only=own_motions_only))
    if gestures is not None:
        body = replace(body, gestures=gestures_for(gestures, body.skeleton, character))
    if live:
        speak_live(body, size=pixels, view=view, emotion=feels, profile=how)
        return
    tagged = TaggedText.read(text) if file is None else TaggedText.load(file)
    if not tagged.text.strip() and not tagged.spans and audio is None:
        raise AppError(NOTHING_TO_SAY)
    _check_gestures(tagged, body)
    console = Console(highlight=False)
    with console.status("speaking"):
        if audio is None:
            speech = _speech_of(tagged.text, language, feels, voice)
        else:
            speech = _read_recording(audio, tagged, language, voice)
        utterance = utterance_of(speech, tagged, how.accents)
        line = SpokenLine(utterance, speech.samples, speech.rate, how)
        if target.suffix.lower() == ".wav":
            write_wave(target, at_sample_rate(line))
        else:
            direction = Direction(feels, seed)
            clip = speech_clip(body, line, direction, rate)
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
                    codec=codec,
                )
    console.print(
        f"[bold]{escape(str(target))}[/] is written: {speech.duration:.1f} s of speech, "
        f"{quantity(len(utterance.words), 'word')}, {quantity(len(utterance.accents), 'accent')}",
        soft_wrap=True,
    )


def _speech_of(text: str, language: str, emotion: Emotion | None, command: str | None) -> Speech:
    """Return a text as the voice speaks it."""
    from cubeling.app.speaking.voices import open_voice
    from cubeling.characters.speech import manner_of, say

    with open_voice(command) as voice:
        return say(voice, text, language, manner_of(emotion))


def _read_recording(audio: Path, tagged: TaggedText, language: str, command: str | None) -> Speech:
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
    from cubeling.characters import meanings_of

    names = [span.name for span in tagged.spans]
    known = meanings_of(character, names)
    for name in names:
        if name not in known:
            raise AppError(
                f"{character.name} has no gesture '{name}': `cubeling gesture list` names all, "
                f"besides there are its clips ({', '.join(character.clips)})"
            )
