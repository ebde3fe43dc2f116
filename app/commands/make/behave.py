"""The command `cubeling behave`."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.markup import escape

from cubeling.app.commands.character_options import SPEECH_GROUP, OwnMotionsOption, VoiceOption
from cubeling.app.commands.output import OverwriteOption, VideoCodecOption, chosen_output
from cubeling.app.commands.play.preference_options import emotion_of, size_of
from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.input_path import check_character, check_input
from cubeling.app.output_path import check_output
from cubeling.app.speaking.view import View
from cubeling.app.ui.display import has_display
from cubeling.app.ui.output_formats import VIDEO_FORMATS, check_video_codec
from cubeling.files import write_whole

if TYPE_CHECKING:
    from cubeling.app.behaving.live import Output
    from cubeling.app.behaving.recording import BehaviourRecording
    from cubeling.app.show.blocks import BehaviourOptions
    from cubeling.characters import Character
    from cubeling.characters.behaviour import Feedback

OUTPUT_SUFFIXES = (".bvh", ".bap", *VIDEO_FORMATS)

EXPRESSIVITY_PANEL = "How gestures are performed"


def _expressivity(name: str, words: str, low: float) -> Any:
    return typer.Option(
        name, help=words, rich_help_panel=EXPRESSIVITY_PANEL, min=low, max=1.0, show_default=False
    )


def behave(
    files: Annotated[
        list[Path] | None,
        typer.Argument(help="Files of BML or FML, performed one after the other."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="A video, .bvh or .bap file; default: behaviour.mp4."),
    ] = None,
    overwrite: OverwriteOption = False,
    codec: VideoCodecOption = "auto",
    together: Annotated[
        bool, typer.Option("--together", help="Give all blocks at the start: composition counts.")
    ] = False,
    feedback: Annotated[
        Path | None, typer.Option(help="Write the feedback of the standard to this .xml file.")
    ] = None,
    serve: Annotated[
        int | None,
        typer.Option(help="Take blocks on this TCP port while playing, from this computer."),
    ] = None,
    token: Annotated[
        str,
        typer.Option(help="What clients have to tell first; default: a new one, printed."),
    ] = "",
    window: Annotated[
        bool, typer.Option("--window/--no-window", help="Show the character while serving.")
    ] = True,
    character: Annotated[
        str, typer.Option(help="Who performs: bundled, or a .glb, .gltf or .vrm file.")
    ] = "human",
    own_motions_only: OwnMotionsOption = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="Read BML 1.0 and FML only, no drafts and dialects.")
    ] = False,
    target: Annotated[
        list[str] | None,
        typer.Option(help="A place for target=NAME, as NAME=x,y,z in metres; may be repeated."),
    ] = None,
    voice: VoiceOption = None,
    language: Annotated[
        str, typer.Option(help="Language of speeches that name none.", rich_help_panel=SPEECH_GROUP)
    ] = "en",
    emotion: Annotated[str, typer.Option(help="A word such as happy, sad or angry.")] = "",
    spatial: Annotated[
        float, _expressivity("--spatial", "Smaller or wider gestures, -1 to 1.", -1.0)
    ] = 0.0,
    openness: Annotated[
        float, _expressivity("--openness", "Elbows at the body, 0, or away from it, 1.", 0.0)
    ] = 0.5,
    fluidity: Annotated[
        float, _expressivity("--fluidity", "Jerky or flowing, -1 to 1.", -1.0)
    ] = 0.0,
    bias: Annotated[
        float, _expressivity("--bias", "Overshoot before or after keys, -1 to 1.", -1.0)
    ] = 0.0,
    tension: Annotated[
        float, _expressivity("--tension", "Round or tight paths, -1 to 1.", -1.0)
    ] = 0.0,
    power: Annotated[
        float, _expressivity("--power", "Faster strokes; shoulders and trunk join in, 0 to 1.", 0.0)
    ] = 0.0,
    view: Annotated[View, typer.Option(help="What is seen of the character.")] = "body",
    subtitles: Annotated[
        bool, typer.Option("--subtitles/--no-subtitles", help="Show what is being said.")
    ] = False,
    size: Annotated[str, typer.Option(help="Size of the picture.")] = "640x480",
    rate: Annotated[float, typer.Option(help="Frames a second.", min=1.0, max=120.0)] = 25.0,
    seed: Annotated[int, typer.Option(help="Of blinks and sway.")] = 0,
) -> None:
    """Let a character perform blocks of BML: speech, gestures, gaze, postures, walking.

    Example: cubeling behave hello.bml -o hello.mp4
    """
    if serve is None and not files:
        raise AppError("there is nothing to perform: name a file of BML or FML, or --serve PORT")
    if token and serve is None:
        raise AppError("--token is for --serve: add --serve PORT")
    for file in files or []:
        check_input(file, "document")
    path = chosen_output(output, "behaviour.mp4", "behaviour", OUTPUT_SUFFIXES, overwrite)
    check_video_codec(path, codec)
    if feedback is not None:
        check_output(feedback, "feedback", (".xml",), overwrite=overwrite)
    feels, pixels = emotion_of(emotion), size_of(size)
    places = _targets(target or [])
    check_character(character)
    # Nothing above needs more than numpy: what is misspelt is refused before the rest is loaded.
    from cubeling.app.behaving.opening import open_lines
    from cubeling.app.behaving.player import BehaviourPlayer
    from cubeling.app.behaving.recording import record_behaviour
    from cubeling.app.show.blocks import BehaviourOptions, read_document
    from cubeling.characters import load_to_play
    from cubeling.characters.behaviour import GestureExpressivity
    from cubeling.characters.model import with_root_joint
    from cubeling.characters.speech import blood_of

    how = GestureExpressivity(spatial, openness, fluidity, bias, tension, power)
    options = BehaviourOptions(how, feels, seed, places, strict)
    body = with_root_joint(load_to_play(character, own_motions_only=own_motions_only))
    if serve is not None:
        first = [read_document(file, strict=strict) for file in files or []]
        shown = (pixels, view) if window else None
        _serve(serve, token, body, options, first, voice, language, rate, shown)
        return
    documents = [read_document(file, strict=strict) for file in files or []]
    console = Console(highlight=False)
    lines = open_lines(voice, language)
    try:
        with console.status("performing"):
            player = BehaviourPlayer(body, lines, options)
            done = record_behaviour(player, documents, rate, together=together, name=path.stem)
            _write(path, body, done, pixels, view, subtitles, blood_of(player.emotion), codec)
    finally:
        lines.close()
    if feedback is not None:
        write_whole(feedback, feedback_document(done.feedback), AppError)
    _report(console, path, done, lines.problem)


def _serve(
    port: int,
    told: str,
    body: Character,
    options: BehaviourOptions,
    first: list[bytes],
    voice: str | None,
    language: str,
    rate: float,
    shown: tuple[tuple[int, int], View] | None,
) -> None:
    """Play in a window, or without one, and take blocks until that is closed or interrupted."""
    if shown is not None and not has_display():
        raise AppError("there is no display here: add --no-window")
    from cubeling.app.admission import Token
    from cubeling.app.behaving.live import NoOutput, WindowOutput, play_live
    from cubeling.app.behaving.opening import open_lines
    from cubeling.app.behaving.player import BehaviourPlayer
    from cubeling.app.behaving.server import BlockServer
    from cubeling.app.behaving.voice import ThreadedSource

    token = Token(told) if told else Token.generate()
    with ExitStack() as closing:
        server = BlockServer(port, token)
        closing.callback(server.close)
        lines = open_lines(voice, language, ThreadedSource)
        closing.callback(lines.close)
        player = BehaviourPlayer(body, lines, options)
        for document in first:
            player.director.accept(document)
        output: Output = NoOutput()
        if shown is not None:
            output = closing.enter_context(WindowOutput.open(body, *shown))
        console = Console(highlight=False)
        if lines.problem:
            console.print(f"[yellow]nothing is said:[/] {escape(lines.problem)}", soft_wrap=True)
        console.print(
            f"Blocks of BML come in at 127.0.0.1:{server.port}; end with Ctrl-C\n"
            f"Clients begin with the line: token {'and yours' if told else token.text}",
            soft_wrap=True,
        )
        play_live(player, server, output, rate)


def feedback_document(feedback: tuple[Feedback, ...]) -> str:
    """Return all feedback as one XML document."""
    from cubeling.characters.behaviour import feedback_xml

    lines = [feedback_xml(each) for each in feedback]
    return "\n".join(
        ['<?xml version="1.0" encoding="utf-8"?>', "<feedback>", *lines, "</feedback>", ""]
    )


def _write(
    path: Path,
    body: Character,
    done: BehaviourRecording,
    size: tuple[int, int],
    view: View,
    subtitles: bool,
    blood: float,
    codec: str,
) -> None:
    from cubeling.app.behaving.recording import write_video
    from cubeling.characters.model import save_bap, save_bvh

    match path.suffix.lower():
        case ".bvh":
            save_bvh(done.clip, body.skeleton, body.anatomy, path)
        case ".bap":
            save_bap(done.clip, body.skeleton, body.anatomy, path)
        case _:
            write_video(
                path,
                body,
                done,
                size=size,
                view=view,
                subtitles=subtitles,
                blood=blood,
                codec=codec,
            )


def _report(console: Console, path: Path, done: BehaviourRecording, problem: str) -> None:
    """Print warnings, and what is written."""
    from cubeling.characters.behaviour import BlockProgress, BmlWarning

    if problem:
        console.print(f"[yellow]nothing is said:[/] {escape(problem)}", soft_wrap=True)
    for each in done.feedback:
        if isinstance(each, BmlWarning):
            console.print(
                f"[yellow]{escape(each.id)}[/]: {escape(each.description)} ({each.type})",
                soft_wrap=True,
            )
    blocks = sum(isinstance(e, BlockProgress) and e.sync == "end" for e in done.feedback)
    console.print(
        f"[bold]{escape(str(path))}[/] is written: {done.clip.duration:.1f} s, "
        f"{quantity(blocks, 'block')}",
        soft_wrap=True,
    )


def _targets(texts: list[str]) -> dict[str, Any]:
    from cubeling.app.show.blocks import target_of

    try:
        return dict(map(target_of, texts))
    except ValueError as error:
        raise AppError(f"--target {error}: write NAME=x,y,z, in metres") from None
