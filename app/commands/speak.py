"""`cubeling speak`."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from affect import Emotion
from affect.words import WORD_PLACES
from app.commands.output import OverwriteOption, chosen_output
from app.commands.session.preference_options import size_of
from app.errors import AppError
from app.pipeline.spoken_line import SpokenLine
from app.sound import write_wave
from app.sound.session_sound import at_sample_rate
from app.speaking.performance import Direction, View, performed, write_video
from app.ui.video_file import VIDEO_FORMATS
from characters import Character
from characters.control.layers.speech import known_gestures
from characters.formats.mocap.bvh_writing import save_bvh
from characters.model.files import read_file
from characters.retargeting.root import with_root_joint
from characters.speech.alignment import align
from characters.speech.audio import read_speech
from characters.speech.prosody import utterance_of
from characters.speech.speech import Speech
from characters.speech.tagged_text import TaggedText
from characters.speech.voices import espeak
from characters.speech.voices.feeling import manner_of

MAX_TEXT_BYTES = 100_000
"""Larger files are no speeches."""

SUFFIXES = (".wav", ".bvh", *VIDEO_FORMATS)


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
    character: Annotated[
        str, typer.Option(help="Who says it: bundled, or a .glb, .gltf or .vrm file.")
    ] = "human",
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
    gesture_emphasis: Annotated[
        float, typer.Option(help="Stronger or weaker gestures.", min=-1.0, max=1.0)
    ] = 0.0,
    face_emphasis: Annotated[
        float, typer.Option(help="A livelier or a calmer mouth.", min=-1.0, max=1.0)
    ] = 0.0,
    size: Annotated[str, typer.Option(help="Size of the video.")] = "640x480",
    rate: Annotated[float, typer.Option(help="Frames a second.", min=1.0, max=120.0)] = 25.0,
    seed: Annotated[int, typer.Option(help="Of blinks, and choices between gestures.")] = 0,
) -> None:
    """Let a character say something, with its mouth, face and hands.

    Example: [cyan]cubeling speak "Hello! I am a paper cube." -o hello.mp4[/]
    """
    target = chosen_output(output, "speech.mp4", "speech", SUFFIXES, overwrite)
    marked = text if file is None else _read(file)
    if not marked.strip() and audio is None:
        raise AppError("there is nothing to say: give a text, --file or --audio")
    body = with_root_joint(Character.load(character))
    feels = _emotion(emotion)
    tagged = TaggedText.read(marked)
    _check_gestures(tagged, body)
    console = Console(highlight=False)
    with console.status("speaking"):
        speech = _spoken(tagged.text, lang, feels) if audio is None else _heard(audio, tagged, lang)
        gestures = tagged.timed(speech.words, speech.duration)
        utterance = replace(utterance_of(speech), gestures=gestures)
        line = SpokenLine(utterance, speech.samples, speech.rate)
        if target.suffix.lower() == ".wav":
            write_wave(target, at_sample_rate(line))
        else:
            direction = Direction(feels, gesture_emphasis, face_emphasis, seed)
            clip = performed(body, line, direction, rate)
            if target.suffix.lower() == ".bvh":
                save_bvh(clip, body.skeleton, body.anatomy, target)
            else:
                write_video(
                    target, body, clip, line, size=size_of(size), view=view, subtitles=subtitles
                )
    console.print(
        f"[bold]{escape(str(target))}[/] is written: {speech.duration:.1f} s of speech, "
        f"{len(utterance.words)} words, {len(utterance.accents)} accents",
        soft_wrap=True,
    )


def _read(file: Path) -> str:
    """Return the text of a file."""
    try:
        return read_file(file, MAX_TEXT_BYTES).decode()
    except UnicodeDecodeError as error:
        raise AppError(f"{file}: not a text file in UTF-8") from error


def _spoken(text: str, language: str, emotion: Emotion | None) -> Speech:
    """Return a text as the voice speaks it."""
    with espeak() as voice:
        return voice.say(text, language, manner_of(emotion))


def _heard(audio: Path, tagged: TaggedText, language: str) -> Speech:
    """Return a recording, with the times of its words where the text is known."""
    recording = read_speech(audio)
    if not tagged.text.strip():
        return recording
    with espeak() as voice:
        return align(recording, tagged.text, voice, language)


def _emotion(word: str) -> Emotion | None:
    """Return the emotion of a word; None for ""."""
    if not word:
        return None
    if word not in WORD_PLACES:
        raise AppError(f"no emotion is called '{word}': choose one of {', '.join(WORD_PLACES)}")
    return Emotion(*WORD_PLACES[word], word)


def _check_gestures(tagged: TaggedText, character: Character) -> None:
    """Refuse a gesture that the character does not know."""
    known = known_gestures(character)
    for span in tagged.spans:
        if span.name not in known:
            raise AppError(
                f"{character.name} has no gesture '{span.name}': choose one of {', '.join(known)}"
            )
