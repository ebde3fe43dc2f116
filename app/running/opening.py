"""Opening a session: its source, screen, recorder and robot, from the user's options."""

import math
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from cubeling.app.errors import AppError
from cubeling.app.output_path import default_folder
from cubeling.app.pipeline.frame_times import FrameTimes
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import (
    ListeningScenario,
    SoundingScenario,
)
from cubeling.app.pipeline.table.stage_sounds import SoundClip
from cubeling.app.preferences import PreferenceStore
from cubeling.app.running.asked_scenario import is_replay, load_cast, scenario_of, settings_of
from cubeling.app.running.clock import Pace, SessionClock
from cubeling.app.running.front_end import FrontEnd
from cubeling.app.running.instrument import Instrument
from cubeling.app.running.kept_lens import LensStore, intrinsics_for
from cubeling.app.running.opened_session import OpenedSession, open_camera
from cubeling.app.running.option_checks import check_output_paths, check_part
from cubeling.app.running.recording.wire_tap import WireTap
from cubeling.app.running.robots import RobotLine, is_real_robot
from cubeling.app.running.screens import open_screen, open_sound
from cubeling.app.running.typed_lines import TypedLines
from cubeling.app.scenarios import scenario_cube
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.app.speaking.listener import PushToTalk
from cubeling.app.speaking.model.opening import open_answerer
from cubeling.app.speaking.opening import has_own_lines, open_speaker
from cubeling.app.ui.panels.monitor import SessionMonitor
from cubeling.app.ui.playback.status import EndCard
from cubeling.app.ui.screen import Screen
from cubeling.characters import choose_controller, prepare_gestures
from cubeling.tracking import (
    SECOND,
    CubeModel,
    FrameSource,
    Intrinsics,
    open_source,
)

# What only some sessions have (a window, sound, a recording, players) is loaded by those.
if TYPE_CHECKING:
    pass


@contextmanager
def open_session(
    options: SessionOptions,
    *,
    source: FrameSource | None = None,
    replayed: SessionFile | None = None,
    screen: Screen | None = None,
    typed: Iterable[str] | None = None,
    until_over: bool = False,
    front_end: FrontEnd | None = None,
    instruments: Sequence[Instrument] = (),
    ending: EndCard | None = None,
    preferences: PreferenceStore | None = None,
) -> Iterator[OpenedSession]:
    """Open all that a session needs, and close it in reverse order at the end.

    Checks that cost nothing come first, so that a misspelt name does not open a camera.

    Parameters
    ----------
    options
        What the user asks for.
    source
        Frames to use instead of those that `options` names; the caller closes it.
    replayed
        The session that `options` names as the source, opened; the caller closes it. None to open
        it.
    screen
        Where the steps go, instead of a window or a file; they have no pictures then. The caller
        closes it.
    typed
        Lines that are typed in front of the screen, which ends after the last reply; None for
        none.
    until_over
        Whether the session ends when the scenario is over.
    front_end
        What shows the pictures instead of a window of this computer; None for a window.
    instruments
        What else follows the session, in real time; the caller closes them.
    ending
        The card at the end of a recording, in a window and in a video; None for a short one, in a
        window only.
    preferences
        How the window begins, and what the player changes of it; the caller saves them.

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
    check_part(options)
    cubes = [CubeModel.load(each) for each in options.cubes]
    own = scenario_cube(options.scenario)
    in_play = [*cubes, *map(CubeModel.load, (own, f"{own}{SECOND}")[len(cubes) :])]
    cube, *further_cubes = in_play[: options.players]
    scenario = scenario_of(options, options.scenario, cube)
    character, *others = cast = load_cast(options, scenario)
    controller = choose_controller(options.controller, character, options.motions)
    calibration = None if options.intrinsics is None else Intrinsics.load(options.intrinsics)
    for instrument in instruments:
        instrument.begin(tuple(cast))
    with ExitStack() as closing:
        if source is None:
            source = closing.enter_context(open_source(options.source))
        check_start(options, source)
        if replayed is None and options.source.endswith(".mcap"):
            replayed = closing.enter_context(SessionFile(Path(options.source)))
        if replayed is not None and options.stage == "camera":
            replayed.check_has_video()
            if is_replay(replayed, options):
                replayed.check_begins()
        preferences = preferences or PreferenceStore()
        lenses = LensStore(preferences)
        known = calibration or source.intrinsics
        if known is None and source.live:
            known = lenses.load(options.source, source.size)
        intrinsics = intrinsics_for(known, source.size)
        context = sound = None
        monitor = SessionMonitor(options, FrameTimes(time.perf_counter))
        if screen is None:
            loudspeaker = None if front_end is None else front_end.open_loudspeaker
            sound = open_sound(options, character, closing, loudspeaker)
            if front_end is not None:
                folder = options.folder or default_folder()
                screen, context = front_end.open_screen(source.size, folder, closing)
            else:
                screen, context = open_screen(options, source, sound, preferences, monitor, closing)
        if typed is not None or until_over:
            screen = TypedLines(screen, typed)
        playground = Playground(
            scenario,
            intrinsics,
            cube=cube,
            character=character,
            others=others,
            further_cubes=further_cubes,
            robots=options.robot_names,
            settings=settings_of(options),
            context=context,
            look=options.look,
            fixed=options.keeps_scenario or not options.windowed,
            known_cubes=cubes,
            lap=monitor.times.lap,
            controller=controller,
            realism=options.realism,
            inside=options.inside,
            measured=options.appearance,
            plain=replayed is not None and not replayed.info.has_video,
        )
        closing.callback(playground.close)
        if options.windowed or source.live:  # else nobody waits for a frame
            for each in cast:
                prepare_gestures(each)
        replay_inputs = None
        if options.stage != "camera" and replayed is not None:
            replay_inputs = replayed.replay_inputs(options.stage)
        wire, clock = WireTap(), SessionClock()
        second_wire = WireTap(f"/robots/{options.robot_names[1]}/wire")
        pace = _pace(options, source, instruments)
        stepped = pace is None and not source.live
        replies = isinstance(scenario, ListeningScenario)
        # What another scenario said is no reply, and not what a file of rules says.
        replays = is_replay(replayed, options)
        said = replays or not (replies or has_own_lines(options.scenario))
        lines = replayed.lines if replayed is not None and said else None
        speaker = open_speaker(
            options,
            cast,
            lines,
            waits=stepped,
            replies=replies,
            prompted=any(each.speaks for each in instruments),
        )
        closing.callback(speaker.close)
        stage_sounds: dict[str, SoundClip] = {}
        if isinstance(scenario, SoundingScenario) and not replays:
            from cubeling.app.sound.stage_sounds import open_clips

            stage_sounds = open_clips(scenario.sounds)
        recording = None
        if options.record is not None:
            from cubeling.app.running.recording.recording import SessionRecording

            recording = closing.enter_context(
                SessionRecording(
                    options.record,
                    options,
                    playground,
                    source,
                    (wire, second_wire),
                    language=speaker.language,
                    from_within=options.start_s > 0.0,
                )
            )
        robot, second = (
            closing.enter_context(
                RobotLine.open(url, clock, tap, options.robot_settings, name=name, stepped=stepped)
            )
            for url, tap, name in zip(
                (options.robot, options.second_robot),
                (wire, second_wire),
                options.robot_names,
                strict=True,
            )
        )
        session = OpenedSession(
            asked=options,
            options=options,
            source=source,
            playground=playground,
            screen=screen,
            sound=sound,
            speaker=speaker,
            stage_sounds=stage_sounds,
            listener=PushToTalk(),
            answerer=open_answerer(options, replays=replays, waits=stepped),
            robot=robot,
            second_robot=second,
            wire=wire,
            second_wire=second_wire,
            clock=clock,
            instruments=instruments,
            pace=pace,
            replayed=replayed,
            replay_inputs=replay_inputs,
            preferences=preferences,
            lenses=lenses,
            monitor=monitor,
            ending=ending,
            first_source=source,
            recording=recording,
            open_camera=open_camera if front_end is None else front_end.open_camera,
        )
        closing.callback(session.close)
        closing.callback(clock.release)  # the robot's connection is closed in real time
        yield session


def _pace(
    options: SessionOptions, source: FrameSource, instruments: Sequence[Instrument]
) -> Pace | None:
    """Return the pace of recorded frames: that of who watches them or lives with them."""
    # A real robot and other programs live in real time.
    real = is_real_robot(options.robot) or is_real_robot(options.second_robot)
    real_time = bool(instruments) or (real and not options.fast)
    if source.live or not (options.windowed or real_time):
        return None
    watched = options.windowed and options.record is None  # what is written has every frame
    return Pace(1.0 / source.rate if watched else math.inf)


def check_start(options: SessionOptions, source: FrameSource) -> None:
    """Refuse to start after the end of a recording."""
    if source.duration and options.start_s >= source.duration:
        raise AppError(
            f"--start {options.start_s:g} is after the end of the recording, "
            f"which lasts {source.duration:.1f} s"
        )
