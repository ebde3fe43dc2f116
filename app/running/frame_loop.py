"""Processing the frames of a session: each is tracked, drawn, shown and recorded."""

from dataclasses import replace

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import ReplayInputs, RobotView, Step
from cubeling.app.running.events import events_of
from cubeling.app.running.opened_session import OpenedSession
from cubeling.app.running.quality_control import AUTO_QUALITY, QualityControl
from cubeling.app.running.summary.summary import Summary
from cubeling.characters.rendering import QUALITIES
from cubeling.tracking import Frame

WAITING = "waiting"
"""The part of a frame's time in which nothing is done for it."""


def both_asked(first: Inputs, then: Inputs) -> Inputs:
    """Return what a player asked for before and after, as if it had been at the same time.

    >>> both_asked(Inputs(clear=True, inside=True), Inputs(scenario="reach", inside=True))
    Inputs(clear=True, scenario='reach', line=None, inside=False, typed='', hush=False, \
answer=None, lines_of_others={}, acts=(), marks=(), sounds={})
    """
    both = Inputs(
        clear=first.clear or then.clear,
        scenario=then.scenario or first.scenario,
        inside=first.inside != then.inside,
        typed=" ".join(filter(None, (first.typed, then.typed))),
        hush=first.hush or then.hush,
        acts=(*first.acts, *then.acts),
        marks=(*first.marks, *then.marks),
        sounds={**first.sounds, **then.sounds},
        answer=then.answer or first.answer,
    )
    return both.with_lines({**first.lines, **then.lines})


class FrameLoop:
    """Processes, shows and records one frame after the other."""

    def __init__(self, session: OpenedSession, summary: Summary) -> None:
        self._session, self._summary = session, summary
        self._inputs = Inputs()
        self._recorded = Inputs()
        self._index = 0
        self._replay: ReplayInputs | None = None
        self._asked_sounds: tuple[str, ...] = ()
        self._hidden: Step | None = None
        self._shown_index = 0
        self.robot = RobotView("none", 0.0, "")
        """What the robot reported at the last frame that was shown."""
        options = session.options
        self._quality: QualityControl | None = None
        if options.quality != AUTO_QUALITY:
            session.playground.quality = QUALITIES[options.quality]
        elif options.windowed and (session.source.live or session.pace is not None):
            software = session.playground.draws_in_software
            self._quality = QualityControl(session.source.rate, software)

    def step(self, frame: Frame, *, drawn: bool = True) -> Step:
        """Process one frame and show it; without drawing it, it is only not seen."""
        session, lap = self._session, self._session.monitor.times.lap
        self._read_recorded(frame)
        recorded = self._take_recorded()
        answered = Inputs(sounds=session.sounds_of(self._asked_sounds))
        inputs = both_asked(
            both_asked(Inputs() if recorded.clear else self._inputs, answered), recorded
        )
        inputs = session.admit(inputs)
        session.change_scenario(inputs.scenario)
        if session.recording is not None:
            frame = session.recording.encode(frame)
            lap("recording")
        # A replay of a recording measures the appearance of all frames, in their order.
        measured = drawn or session.recording is not None
        step = session.playground.step(frame, inputs, self._replay, drawn=drawn, measured=measured)
        self._inputs = Inputs()
        self._show(step, inputs, drawn)
        return step

    def skip(self, frame: Frame) -> Step:
        """Process one frame without drawing and showing it."""
        session = self._session
        self._read_recorded(frame)
        self._hidden = session.playground.step(
            frame, self._take_recorded(), self._replay, drawn=False
        )
        if session.pace is None:  # else the robot lives in real time, and misses what is skipped
            self._feel(self._hidden)
        return self._hidden

    def preview(self) -> None:
        """Show the last frame that was skipped, on the way to the one that is sought."""
        if self._hidden is not None:
            session = self._session
            session.screen.preview(
                session.playground.with_picture(self._hidden), session.robot_view()
            )

    def show_skipped(self) -> None:
        """Show the last frame that was skipped, if none was shown after it."""
        if self._hidden is not None:
            self._show(self._session.playground.with_picture(self._hidden), Inputs())

    def leave_out(self, frame: Frame) -> None:
        """Process nothing; what the player asked or a character says here, happens in the next."""
        self._read_recorded(frame)

    @property
    def asked_by_player(self) -> bool:
        """Whether the player asked something of the scenario in the frame that was shown last."""
        return replace(self._inputs, marks=()) != Inputs()

    def _show(self, step: Step, inputs: Inputs, drawn: bool = True) -> None:
        session, lap = self._session, self._session.monitor.times.lap
        follows = self._hidden is None and step.frame.index >= self._shown_index
        self._hidden, self._shown_index = None, step.frame.index
        # Read the view first: after `feel`, the link's thread holds the robot's lock for a moment.
        self.robot = view = session.robot_view()
        self._feel(step)
        for act in inputs.acts:
            if act.kind == "play":
                session.robot.play(act.text)
        lap("robot")
        if session.recording is not None:
            session.recording.write(step, inputs)
            lap("recording")
        self._tell_instruments(step, inputs)
        session.observe()
        session.monitor.update(step, view, session.playground)
        if step.tracker_error and not self._summary.failed_frames:
            session.screen.notify("The tracker made an error: this frame is lost, the game goes on")
        if drawn:
            self._inputs = both_asked(self._inputs, session.screen.show(step, view))
        self._inputs = both_asked(self._inputs, session.listener.inputs())
        session.speaker.hear(step)
        self._asked_sounds = step.outcome.asked_sounds
        session.answerer.hear(step)
        lap("showing")
        if session.sound is not None:
            if not follows:
                session.sound.restart()
            character = session.playground.character
            session.sound.play(step, character, started_over=inputs.clear)
            lap("sound")
        seconds = session.monitor.times.so_far(WAITING) if drawn else None
        self._summary.add(step, view, seconds, follows=follows)
        if self._quality is not None and seconds is not None:
            session.playground.quality = self._quality.update(seconds)

    def _tell_instruments(self, step: Step, inputs: Inputs) -> None:
        """Let others follow a step, and take what they ask for."""
        session, now = self._session, step.frame.timestamp
        cast = [each.character for each in session.playground.cast.members]
        taken = now + session.taken_from_timestamp
        for instrument in session.instruments:
            instrument.robot = self.robot
            self._inputs = both_asked(self._inputs, instrument.follow(step, cast, taken))
        if session.instruments or session.recording is not None:
            for event in events_of(step, inputs):
                session.happen(event, now)
        for name in inputs.marks:
            session.mark(now, name)

    def _feel(self, step: Step) -> None:
        """Let the robots of the players feel what their characters do."""
        self._session.robot.feel(step.emotion)
        if step.players:
            self._session.second_robot.feel(step.others[0].emotion)

    def _take_recorded(self) -> Inputs:
        recorded, self._recorded = self._recorded, Inputs()
        return recorded

    def _read_recorded(self, frame: Frame) -> None:
        """Read what a replay knows of a frame, and what the character begins to say."""
        session = self._session
        if frame.index < self._index:  # the player went back
            self._recorded = Inputs()
        self._index = frame.index
        # What came in with frames that were left out comes in with this one.
        self._recorded = both_asked(self._recorded, session.recorded_inputs(frame.timestamp))
        recorded = session.replay_inputs
        self._replay = None if recorded is None else next(recorded, None)
