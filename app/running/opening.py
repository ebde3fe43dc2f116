"""Opening a session: its source, screen, recorder and robot, from the user's options."""

import math
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import moderngl

from app.errors import AppError
from app.output_path import check_output
from app.pipeline.other_cube import cube_for
from app.pipeline.playground import Playground
from app.pipeline.step import ReplayInputs
from app.running.clock import Pace, SessionClock
from app.running.players import PlayerPublisher
from app.running.robots import RobotLine, WireRecorder, is_real_robot
from app.scenarios import Scenario, find_scenario, make_scenario, scenario_cube
from app.session import Recorder, SessionOptions, check_codec, start_over_times
from app.session.replay_inputs import read_replay_inputs
from app.sound import Mixer, SessionSound, SoundBank
from app.ui.output_file import OUTPUT_SUFFIXES, OutputFile
from app.ui.overlay import virtual_robot_side
from app.ui.screen import NullScreen, Screen
from app.ui.video_file import has_sound
from app.ui.virtual_robot import VirtualRobot
from characters import Character
from characters.control.controllers.actions import clips_of_actions
from characters.rendering import create_context
from tracking import CubeModel, FrameSource, Intrinsics, open_source


@dataclass(frozen=True)
class OpenedSession:
    """What is opened for a session. `open_session` closes all of it."""

    options: SessionOptions
    """What the user asked for."""

    source: FrameSource
    """Where the frames come from."""

    playground: Playground
    """The pipeline that processes them."""

    screen: Screen
    """Where the pictures go."""

    sound: SessionSound | None
    """What is heard; None without pictures, and for a file without sound."""

    robot: RobotLine
    """The robot that shows the emotions, or a stand-in."""

    clock: SessionClock
    """The time that the robot lives by."""

    recorder: Recorder | None
    """Records the session, or None."""

    wire: WireRecorder | None
    """Records the robot's bytes, or None."""

    player: PlayerPublisher | None
    """Publishes the character's actions and emotions, or None."""

    pace: Pace | None
    """Plays a recording at the speed at which it was recorded; None for every frame at once."""

    start_overs: frozenset[float]
    """In a replay, timestamps of the frames in which the player started over [s]."""

    replay_inputs: Iterator[ReplayInputs] | None
    """In a replay that does not start from the camera, the recorded messages of each frame."""

    def change_scenario(self, name: str) -> None:
        """Play another scenario, or the present one with another cube that is in view.

        Do nothing for "", if the scenario is to stay, or if there is nothing to change.
        """
        if not name or self.options.keeps_scenario:
            return
        playground = self.playground
        in_view = playground.other_cube
        cube = cube_for(find_scenario(name), in_view, playground.known_cubes)
        if name != playground.scenario.name or cube is in_view:
            playground.play(_scenario(name, cube, self.options), cube)


@contextmanager
def open_session(
    options: SessionOptions,
    *,
    source: FrameSource | None = None,
    screen: Screen | None = None,
    player: PlayerPublisher | None = None,
) -> Iterator[OpenedSession]:
    """Open all that a session needs, and close it in reverse order at the end.

    Checks that cost nothing come first, so that a misspelt name does not open a camera.

    Parameters
    ----------
    options
        What the user asks for.
    source
        Frames to use instead of those that `options` names; the caller closes it.
    screen
        Where the steps go, instead of a window or a file; they have no pictures then. The caller
        closes it.
    player
        Publishes the character's actions and emotions; the caller closes its network.

    Yields
    ------
    OpenedSession
        What `run` takes.

    Raises
    ------
    TrackingError, CharacterError, AffectError, RobotError, AppError
        Something that `options` names is missing or cannot be used.
    """
    check_output_paths(options)
    cubes = [CubeModel.load(each) for each in options.cubes]
    cube = cubes[0] if cubes else CubeModel.load(scenario_cube(options.scenario))
    scenario = _scenario(options.scenario, cube, options)
    character = Character.load(options.character or scenario.character)
    bank = SoundBank.load(options.sounds, clips_of_actions(character.clips))
    calibration = None if options.intrinsics is None else Intrinsics.load(options.intrinsics)
    with ExitStack() as closing:
        if source is None:
            source = closing.enter_context(open_source(options.source))
        intrinsics = intrinsics_for(calibration or source.intrinsics, source.size)
        context = sound = None
        if screen is None:
            sound = open_sound(options, bank, closing)
            screen, context = _open_screen(options, source, sound, closing)
        playground = Playground(
            scenario,
            intrinsics,
            cube=cube,
            character=character,
            context=context,
            look=options.look,
            fixed=options.keeps_scenario or not options.windowed,
            known_cubes=cubes,
        )
        closing.callback(playground.close)
        is_session = options.source.endswith(".mcap")
        start_overs = start_over_times(Path(options.source)) if is_session else frozenset[float]()
        replay_inputs = None
        if options.start != "camera":
            replay_inputs = read_replay_inputs(options.source, options.start)
        recorder = wire = None
        if options.record is not None:
            named = replace(options, cubes=options.cubes or (cube.name,))
            metadata = {**named.metadata(), "rate": f"{source.rate:g}"}
            recorder = closing.enter_context(Recorder(options.record, metadata))
            wire = WireRecorder(recorder)
        clock = SessionClock()
        pace = _pace(options, source, player)
        stepped = pace is None and not source.live
        robot = closing.enter_context(
            RobotLine.open(options.robot, clock, wire, options.robot_settings, stepped=stepped)
        )
        closing.callback(clock.release)  # the robot's connection is closed in real time
        yield OpenedSession(
            options,
            source,
            playground,
            screen,
            sound,
            robot,
            clock,
            recorder,
            wire,
            player,
            pace,
            start_overs,
            replay_inputs,
        )


def _scenario(name: str, cube: CubeModel, options: SessionOptions) -> Scenario:
    """Make a scenario with the user's settings."""
    return make_scenario(
        name,
        cube,
        speed_map=options.speed_map,
        turns=options.turns,
        personality=options.personality,
    )


def open_sound(options: SessionOptions, bank: SoundBank, closing: ExitStack) -> SessionSound | None:
    """Start the sound of a window or a video; None if it cannot have any."""
    path = options.output
    if not options.pictures or (path is not None and (options.muted or not has_sound(path))):
        return None
    sound = SessionSound(
        Mixer(bank, options.volume),
        live=options.windowed,
        muted=options.muted,
        moods=not is_real_robot(options.robot),  # such a robot has a voice of its own
    )
    closing.callback(sound.close)
    return sound


def _open_screen(
    options: SessionOptions,
    source: FrameSource,
    sound: SessionSound | None,
    closing: ExitStack,
) -> tuple[Screen, moderngl.Context | None]:
    """Open the window or the output file, and the context to draw in."""
    if not options.pictures:
        return NullScreen(), None
    if options.output is not None:
        context = create_context()
        closing.callback(context.release)
        virtual_robot = VirtualRobot(context, virtual_robot_side(source.size[1]))
        closing.callback(virtual_robot.close)
        samples = None if sound is None else sound.mixer.render
        output = OutputFile(options.output, source.size, source.rate, virtual_robot, samples)
        return closing.enter_context(output), context
    from app.ui.window import Window  # imports libraries that a computer without display lacks

    window = closing.enter_context(Window(source.size, f"Cubeling: {options.scenario}"))
    return window, window.context


def _pace(
    options: SessionOptions, source: FrameSource, player: PlayerPublisher | None
) -> Pace | None:
    """Return the pace of recorded frames: that of who watches them or lives with them."""
    # A real robot and other players live in real time.
    real_time = player is not None or (is_real_robot(options.robot) and not options.fast)
    if source.live or not (options.windowed or real_time):
        return None
    watched = options.windowed and options.record is None  # what is written has every frame
    return Pace(1.0 / source.rate if watched else math.inf)


def intrinsics_for(intrinsics: Intrinsics | None, size: tuple[int, int]) -> Intrinsics:
    """Return intrinsics for pictures of `size`; guess them where `intrinsics` is None.

    Raises AppError if the calibration was made at another aspect ratio.
    """
    if intrinsics is None:
        return Intrinsics.guess(size)
    if intrinsics.size == size:
        return intrinsics
    if abs(intrinsics.size[1] * size[0] / intrinsics.size[0] - size[1]) > 1.0:
        raise AppError(
            f"the calibration is for {intrinsics.size[0]}x{intrinsics.size[1]} pictures, "
            f"the camera gives {size[0]}x{size[1]}: calibrate it at this size"
        )
    return intrinsics.scaled(size)


def check_output_paths(options: SessionOptions) -> None:
    """Refuse files that cannot be written, before anything is opened."""
    if options.output is not None:
        check_output(options.output, "video", OUTPUT_SUFFIXES, overwrite=options.overwrite)
        if not options.pictures:
            raise AppError(f"without pictures there is nothing to write to '{options.output}'")
    if options.record is not None:
        check_output(options.record, "recording", (".mcap",), overwrite=False, remedy="remove it")
        check_codec(options.codec)
