"""What a session is seen and heard on: a window or a file, and its sound."""

from collections.abc import Callable
from contextlib import ExitStack
from typing import TYPE_CHECKING

from cubeling.app.output_path import default_folder
from cubeling.app.preferences import PreferenceStore
from cubeling.app.running.robots import is_real_robot
from cubeling.app.session import SessionOptions
from cubeling.app.ui.panels.monitor import SessionMonitor
from cubeling.app.ui.screen import NullScreen, Screen
from cubeling.characters import Character
from cubeling.tracking import FrameSource, StoredFrames

# What only some sessions have (a window, sound) is loaded by those.
if TYPE_CHECKING:
    import moderngl

    from cubeling.app.sound import Mixer, SessionSound, SoundOutput


def open_sound(
    options: SessionOptions,
    character: Character,
    closing: ExitStack,
    loudspeaker: "Callable[[Mixer], SoundOutput] | None" = None,
) -> "SessionSound | None":
    """Start the sound of a window or a video; None if it cannot have any."""
    path = options.output
    if not options.pictures and options.sounds is None:
        return None
    from cubeling.app.sound import Mixer, SessionSound, SoundBank
    from cubeling.app.ui.video_file import has_sound
    from cubeling.characters import clips_of_actions

    bank = SoundBank.load(options.sounds, clips_of_actions(character.clips))
    if not options.pictures or (path is not None and (options.muted or not has_sound(path))):
        return None
    sound = SessionSound(
        Mixer(bank, options.volume),
        live=options.windowed,
        muted=options.muted,
        # A real robot has a voice of its own; the second player may have none.
        moods=(
            not is_real_robot(options.robot),
            options.second_robot != "none" and not is_real_robot(options.second_robot),
        ),
        loudspeaker=loudspeaker,
    )
    closing.callback(sound.close)
    return sound


def open_screen(
    options: SessionOptions,
    source: FrameSource,
    sound: "SessionSound | None",
    preferences: PreferenceStore,
    monitor: SessionMonitor,
    closing: ExitStack,
) -> "tuple[Screen, moderngl.Context | None]":
    """Open the window or the output file, and the context to draw in."""
    if not options.pictures:
        return NullScreen(), None
    if options.output is not None:
        from cubeling.app.ui.cards.overlay import virtual_robot_side
        from cubeling.app.ui.cards.virtual_robot import VirtualRobot
        from cubeling.app.ui.output_file import OutputFile
        from cubeling.characters.rendering import create_context

        context = create_context()
        closing.callback(context.release)
        virtual_robot = VirtualRobot(context, virtual_robot_side(source.size[1]))
        closing.callback(virtual_robot.close)
        samples = None if sound is None else sound.mixer.render
        output = OutputFile(
            options.output,
            source.size,
            source.rate,
            virtual_robot,
            samples,
            options.video_codec,
            options.start_s,
        )
        return closing.enter_context(output), context
    from cubeling.app.ui.playback.timeline import STRIP_HEIGHT
    from cubeling.app.ui.window import Window  # whose libraries a computer without display lacks

    strip = STRIP_HEIGHT if is_seekable(source) else 0.0
    folder = options.folder or default_folder()
    title = f"Cubeling: {options.scenario}"
    window = Window(source.size, title, folder, strip, preferences, monitor)
    return closing.enter_context(window), window.context


def is_seekable(source: FrameSource) -> bool:
    """Return whether a source can be played from within, and its length is known."""
    return isinstance(source, StoredFrames) and bool(source.duration)
