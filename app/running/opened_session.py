"""What is opened for a session, and what may be exchanged in it while it runs."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from cubeling.app.errors import AppError
from cubeling.app.pipeline.cubes.other_cube import cube_for
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import Inputs, ListeningScenario
from cubeling.app.pipeline.step import ReplayInputs, RobotView
from cubeling.app.pipeline.table.stage_sounds import SoundClip
from cubeling.app.preferences import PreferenceStore
from cubeling.app.running.asked_scenario import is_replay, scenario_of, settings_of
from cubeling.app.running.clock import Pace, SessionClock
from cubeling.app.running.instrument import Instrument
from cubeling.app.running.kept_lens import LensStore
from cubeling.app.running.recording.wire_tap import WireTap
from cubeling.app.running.robots import RobotLine
from cubeling.app.scenarios import find_scenario
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.app.speaking.listener import PushToTalk
from cubeling.app.speaking.model.answerer import Answerer
from cubeling.app.speaking.recorded import Speaker
from cubeling.app.ui.panels.monitor import SessionMonitor
from cubeling.app.ui.playback.status import EndCard
from cubeling.app.ui.screen import Screen
from cubeling.bad_input import BadInputError
from cubeling.tracking import FrameSource, open_source

if TYPE_CHECKING:
    from cubeling.app.running.recording.recording import SessionRecording
    from cubeling.app.sound import SessionSound


MAX_REFUSALS = 16
"""So many reasons why acts are not carried out are told; nobody reads more."""

OpenCamera = Callable[[str, tuple[int, int]], FrameSource]
"""Opens a camera by its URI, with the width and height to ask for [px]; raises TrackingError."""


def open_camera(uri: str, size: tuple[int, int]) -> FrameSource:
    """Open a camera of this computer or of its network."""
    return open_source(uri, size=size)


@dataclass
class OpenedSession:
    """What is opened for a session. `open_session` closes all of it.

    The player may exchange some parts while it runs.
    """

    asked: SessionOptions
    """What the user asked for."""

    options: SessionOptions
    """The same with what the player has chosen since."""

    source: FrameSource
    """Where the frames come from."""

    playground: Playground
    """The pipeline that processes them."""

    screen: Screen
    """Where the pictures go."""

    sound: "SessionSound | None"
    """What is heard; None without pictures, and for a file without sound."""

    speaker: Speaker
    """What the character speaks with."""

    stage_sounds: Mapping[str, SoundClip]
    """Sounds of the scenario by their names; none in a replay, which has them recorded."""

    listener: PushToTalk
    """Hears what the player says."""

    answerer: Answerer
    """Asks a language model, or nobody."""

    robot: RobotLine
    """The robot that shows the emotions, or a stand-in."""

    second_robot: RobotLine
    """The same for the second player; "none" without one."""

    wire: WireTap
    """Keeps the last bytes of the robot's line, for panels and recordings."""

    second_wire: WireTap
    """The same of the second player's robot."""

    clock: SessionClock
    """The time that the robot lives by."""

    instruments: Sequence[Instrument]
    """What else follows the session, and may ask for something; whoever opened them closes them."""

    pace: Pace | None
    """Plays a recording at the speed at which it was recorded; None for every frame at once."""

    replayed: SessionFile | None
    """The session that is replayed; None for another source."""

    replay_inputs: Iterator[ReplayInputs] | None
    """In a replay that does not start from the camera, the recorded messages of each frame."""

    preferences: PreferenceStore
    """How the player likes window and sound."""

    lenses: LensStore
    """Where the lenses that play has measured are kept."""

    monitor: SessionMonitor
    """Collects what the window's panels show."""

    ending: EndCard | None
    """The card at the end of a recording; None for a short one, in a window only."""

    first_source: FrameSource
    """The source at the start, which whoever opened it closes."""

    open_camera: "OpenCamera" = open_camera
    """Opens a camera that the player chooses, by its URI and the size to ask for."""

    recording: "SessionRecording | None" = None
    """Records the session, or None."""

    recording_problem: str = ""
    """Why a recording stopped before its end, in one line; "" if none did."""

    recorded: list[Path] = field(default_factory=list)
    """The recordings that have been completed before the end of the session."""

    taken_from_timestamp: float = 0.0
    """What added to a frame's timestamp says when it was taken, by `time.monotonic` [s]."""

    marks: int = 0
    """Marks that were set since the session, or its recording, began."""

    _marked_at: float = 0.0

    refused: list[str] = field(default_factory=list)
    """Why acts that instruments asked for were not carried out, each once."""

    def admit(self, inputs: Inputs) -> Inputs:
        """Return inputs without the acts that the cast cannot do, or of which a later one comes.

        Why something cannot be done is in `refused`, each reason once.
        """
        if not inputs.acts:
            return inputs
        admitted = []
        # A wizard's acts are all kept, as they are counted: their notes tell them apart.
        latest = {(act.kind, act.who, act.note): act for act in inputs.acts}
        for act in latest.values():
            reason = self.playground.cast.refusal(act)
            if not reason:
                admitted.append(act)
            elif reason not in self.refused and len(self.refused) < MAX_REFUSALS:
                self.refused.append(reason)
                self.screen.notify(reason)
        return replace(inputs, acts=tuple(admitted))

    def happen(self, event: str, timestamp: float) -> None:
        """Tell the recording and the instruments that something has happened [s]."""
        if self.recording is not None:
            self.recording.event(event, timestamp)
        for instrument in self.instruments:
            instrument.happen(event, timestamp + self.taken_from_timestamp)

    def mark(self, timestamp: float, name: str = "") -> int:
        """Mark a frame by its timestamp [s], and return the mark's number, from 1."""
        self.marks, self._marked_at = self.marks + 1, timestamp
        self.happen(f"mark {self.marks}", timestamp)
        return self.name_mark(name) if name else self.marks

    def name_mark(self, name: str) -> int:
        """Say what the last mark is, and return its number; see `Mark.of`."""
        self.happen(f"mark {self.marks}: {name}", self._marked_at)
        return self.marks

    def recorded_inputs(self, timestamp: float) -> Inputs:
        """Return what is spoken from the frame of a timestamp on [s], and asked for in a replay."""
        asked, replayed = Inputs(), self.replayed
        if replayed is not None and (kept := replayed.inputs.get(timestamp)) is not None:
            asked = replace(kept.asked, sounds=replayed.stage_sounds.get(timestamp, {}))
        answer = self.answerer.answer()
        if answer is not None:
            asked = replace(asked, answer=answer)
        return asked.with_lines(self.speaker.lines(timestamp))

    def sounds_of(self, names: Sequence[str]) -> dict[str, SoundClip]:
        """Return sounds of the scenario that it has asked for by their names."""
        return {name: self.stage_sounds[name] for name in names if name in self.stage_sounds}

    @property
    def listens(self) -> bool:
        """Whether what a player types now is said to the character."""
        scenario = self.playground.scenario
        listens = isinstance(scenario, ListeningScenario) and scenario.listens
        return listens and not is_replay(self.replayed, self.options)

    def notices(self) -> Iterator[str]:
        """Yield what the player should know of voice, microphone and model, each once."""
        for source in (self.speaker, self.listener, self.answerer):
            while told := source.notice():
                yield told

    def keep_lens(self) -> Path | None:
        """Keep the lens of a live camera if play has measured it; return its file, if any."""
        stated = self.options.intrinsics is not None or self.source.intrinsics is not None
        if stated or not self.source.live:
            return None
        measured = self.playground.tracked.measured_intrinsics
        before = self.lenses.load(self.options.source, self.source.size)
        if before is not None and (before.matrix == measured.matrix).all():
            return None
        return self.lenses.save(self.options.source, measured)

    @property
    def keeps_scenario(self) -> bool:
        """Whether scenario, character and camera stay: a recording holds one of each."""
        return self.recording is not None or self.options.keeps_scenario

    def change_scenario(self, name: str) -> None:
        """Play another scenario, or the present one with another cube that is in view.

        Do nothing for "", if the scenario is to stay, or if there is nothing to change.
        """
        playground = self.playground
        in_view = playground.tracked.other_cube
        if not name or (name == playground.scenario.name and in_view is None):
            return
        if self.keeps_scenario:
            self.screen.notify(f"{self.why_it_stays}: {name} is not played")
            return
        try:
            cube = cube_for(find_scenario(name), in_view, playground.known_cubes)
            if name == playground.scenario.name and cube is not in_view:
                return
            scenario = scenario_of(self.options, name, cube)
            playground.keep_lens()
            playground.play(scenario, cube)
        except BadInputError as error:
            self.screen.notify(str(error))
            return
        # A recording that begins now names the cube as the user did.
        known = zip(playground.known_cubes, self.asked.cubes, strict=True)
        first = next((name for model, name in known if model is cube), cube.name)
        others = (each for each in self.asked.cubes if each != first)
        self.options = replace(self.options, scenario=name, cubes=(first, *others), character=None)
        self.screen.notify(f"Playing {name}")

    def change_setting(self, setting: str, value: str | float) -> None:
        """Play on with another value of a setting, a field of `SessionOptions`, if it may change.

        Raises AppError or AffectError if it has no such value.
        """
        if self.keeps_scenario:
            self.screen.notify(f"{self.why_it_stays}: its settings do, too")
            return
        options = replace(self.options, **{setting: value})  # type: ignore[arg-type]
        self.playground.adjust(settings_of(options), options.look)
        self.options = options
        self.observe()

    def change_sound(self, setting: str, value: float) -> None:
        """Sound in another way from now on, and in the sessions to come."""
        self.preferences.change(**{setting: value})
        self.options = options = replace(self.options, **{setting: value})  # type: ignore[arg-type]
        if self.sound is not None:
            self.sound.mixer.volume, self.sound.muted = options.volume, options.muted
        self.observe()

    def change_speech(self, setting: str, value: str | float) -> None:
        """Say the next lines in another way, which is recorded with each."""
        if setting == "language":
            self.speaker.language = str(value)
        else:
            self.speaker.profile = self.speaker.profile.with_setting(setting, value)
        self.observe()

    def observe(self) -> None:
        """Let the panels show the present options and robot."""
        self.monitor.options, self.monitor.fixed = self.options, self.keeps_scenario
        self.monitor.wire = self.wire.log
        speaker = self.speaker
        self.monitor.profile, self.monitor.speaks = speaker.profile, speaker.live
        self.monitor.language, self.monitor.languages = speaker.language, speaker.languages
        self.monitor.voice_problem = speaker.problem
        self.monitor.sound_problem = "" if self.sound is None else self.sound.problem

    @property
    def why_it_stays(self) -> str:
        """Why `keeps_scenario`, as the beginning of a sentence."""
        if self.recording is not None:
            return "A recording stays as it began"
        if self.options.controller != "tree":
            return f"The controller {self.options.controller} is made for this character"
        if self.options.idle is not None:
            return "The idle motion is made for this character"
        if self.options.players > 1:
            return "Several players stay with what they play"
        return "A replay from a later channel stays as it was recorded"

    def restart(self) -> None:
        """Play the present scenario from its beginning, with the present cube and character."""
        playground = self.playground
        scenario = scenario_of(self.options, self.options.scenario, playground.cube)
        playground.play(scenario, playground.cube, playground.character)

    @property
    def robots(self) -> tuple[tuple[RobotLine, WireTap], ...]:
        """The robots of all players, with the taps on their wires."""
        first = self.robot, self.wire
        if self.options.second_robot == "none":
            return (first,)
        return first, (self.second_robot, self.second_wire)

    def robot_view(self) -> RobotView:
        """Return the state of the robot, with that of the second player's."""
        first, *further = (line.view() for line, _ in self.robots)
        return replace(first, second=further[0]) if further else first

    def exchange_robot(self, robot: RobotLine, wire: WireTap, now: float) -> None:
        """Let another robot show the emotions, from a timestamp on [s]."""
        self.robot.close()
        self.wire.record_to(None)
        self.robot, self.wire = robot, wire
        if self.recording is not None:
            self.recording.follow_wire(wire, now)

    def record(self, path: Path) -> None:
        """Record from the next frame on; raises AppError if the file cannot be written."""
        from cubeling.app.running.recording.recording import SessionRecording

        self.recording = SessionRecording(
            path,
            self.options,
            self.playground,
            self.source,
            [wire for _, wire in self.robots],
            language=self.speaker.language,
            from_within=True,
        )
        self.playground.fixed, self.marks = True, 0

    def check_recording(self) -> bool:
        """End the recording if the disk has failed, and return whether it has just done so.

        Play goes on. Raises AppError where the frames are processed only to be written.
        """
        if self.recording is None or self.recording.problem is None:
            return False
        self.end_recording()
        if not self.source.live:
            raise AppError(self.recording_problem)
        self.screen.notify(self.recording_problem)
        return True

    def end_recording(self) -> None:
        """Complete the recording, if there is one."""
        if self.recording is not None:
            self.recording.close()
            self.recording_problem = self.recording.problem or self.recording_problem
            self.recorded += self.recording.paths
            self.recording = None
            self.playground.fixed = self.options.keeps_scenario or not self.options.windowed

    def close(self) -> None:
        """Close what may have been exchanged."""
        self.speaker.close()
        self.listener.close()
        self.answerer.close()
        self.robot.close()
        self.end_recording()
        if self.source is not self.first_source:
            self.source.close()
