"""What the player asks of a session, carried out."""

from collections.abc import Callable
from datetime import datetime
from typing import Any

from cubeling.affect import AffectError
from cubeling.app.errors import AppError
from cubeling.app.output_path import dated_file, default_folder, short_path
from cubeling.app.pipeline.scenario import ConversingScenario
from cubeling.app.running.opened_session import OpenedSession
from cubeling.app.running.playback.choices import Choices
from cubeling.app.running.playback.transport import Transport
from cubeling.app.ui.playback.requests import (
    ChangeSetting,
    ChangeSound,
    ChangeSpeech,
    Choose,
    ListChoices,
    Listen,
    MarkMoment,
    NameMark,
    Pause,
    Record,
    Seek,
    SeekTo,
    SessionRequest,
    StepFrames,
)
from cubeling.app.ui.playback.status import EndCard, SessionStatus

NAMING_KEYS = "a digit, or a name and Enter"
"""How a mark gets a name, once B was pressed."""


class PlayerControls:
    """Carries out the player's requests between two frames, and tells the screen the result."""

    def __init__(self, session: OpenedSession, transport: Transport) -> None:
        self._session, self._transport = session, transport
        self._choices = Choices(session, transport)

    def update(self) -> None:
        """Carry out what the player has asked for, and report the state of the session."""
        for request in self._session.screen.take_requests():
            HANDLERS[type(request)](self, request)
        self._choices.update()
        self.report()

    def report(self) -> None:
        """Tell the screen the state of the session."""
        session, transport = self._session, self._transport
        recording = session.recording
        by_key = recording is not None and recording.path != session.options.record
        self._session.screen.report(
            SessionStatus(
                scenario=session.options.scenario,
                source=session.options.source,
                paused=transport.paused or transport.ended,
                seeking=transport.seeking,
                recorded=recording is not None,
                recording=recording.seconds if recording is not None and by_key else None,
                position=transport.position,
                ending=self._ending if transport.ended else None,
                choices=self._choices.found,
                looking=self._choices.looking,
                listens=session.listens,
                hears=session.listener.listening,
            )
        )

    def close(self) -> None:
        """Leave alone what is still being opened."""
        self._choices.close()

    @property
    def _ending(self) -> EndCard | None:
        session = self._session
        if session.ending is None and session.screen.attended:
            return EndCard("The end")
        return session.ending

    def _change_setting(self, request: ChangeSetting) -> None:
        """Play on with another setting of the scenario."""
        session = self._session
        try:
            session.change_setting(request.setting, request.value)
        except (AppError, AffectError) as error:
            session.screen.notify(str(error))
        self._transport.save_state(exchanged=True)

    def _record(self, _: Record) -> None:
        """Begin a recording, or end it."""
        session = self._session
        if session.recording is None:
            self._begin_recording()
        elif session.recording.path == session.options.record:
            session.screen.notify("The whole session is being recorded")
        else:
            seconds = session.recording.seconds
            session.end_recording()
            # Until now the pixels were those of the recording, which were encoded once more.
            self._transport.save_state(acted=True)
            played = f"cubeling replay {short_path(session.recorded[-1])}"
            session.screen.notify(f"Recorded {seconds:.0f} s. Play it: {played}")

    def _mark(self, _: MarkMoment) -> None:
        """Mark the frame that is shown, in the recording that is being made."""
        session, now = self._session, self._transport.timestamp
        if (session.recording is None and not session.instruments) or now is None:
            session.screen.notify("Marks are kept in a recording: R begins one")
            return
        number = session.mark(now)
        at = "" if session.recording is None else f" at {session.recording.seconds:.1f} s"
        session.screen.notify(f"Mark {number}{at}: {NAMING_KEYS}")

    def _name_mark(self, request: NameMark) -> None:
        """Say what the last mark of the recording is."""
        if self._session.marks:
            number = self._session.name_mark(request.name)
            self._session.screen.notify(f"Mark {number}: {request.name}")

    def _listen(self, _: Listen) -> None:
        """Begin to listen to the player, or end it."""
        session = self._session
        scenario = session.playground.scenario
        if session.listener.listening:
            session.listener.end()
        elif (
            session.listens
            and isinstance(scenario, ConversingScenario)
            and scenario.conversation is not None
        ):
            session.listener.begin(scenario.conversation, scenario.language)
        else:
            session.screen.notify("Nobody listens here: a talk does")

    def _begin_recording(self) -> None:
        session, transport = self._session, self._transport
        options = session.options
        if options.stage != "camera":
            session.screen.notify("Only a replay from the camera on can be recorded")
            return
        if transport.timestamp is None or transport.ended:
            session.screen.notify("A recording begins while something plays")
            return
        try:
            folder = options.folder or default_folder()
            path = dated_file(folder, options.scenario, ".mcap", datetime.now())
            # A replay begins with the first recorded frame, so the scenario does so too; what is
            # known of the lens by then is its calibration.
            session.playground.keep_lens()
            session.restart()
            session.record(path)
        except AppError as error:
            session.screen.notify(f"Nothing is recorded: {error}")
            return
        transport.save_state(acted=True)
        session.screen.notify(f"Recording from the start: {short_path(path)}")


HANDLERS: dict[type[SessionRequest], Callable[[PlayerControls, Any], None]] = {
    Pause: lambda controls, _: controls._transport.toggle_pause(),
    Seek: lambda controls, request: controls._transport.seek_by(request.seconds),
    SeekTo: lambda controls, request: controls._transport.seek(request.position),
    StepFrames: lambda controls, request: controls._transport.step_frames(request.count),
    Record: PlayerControls._record,
    MarkMoment: PlayerControls._mark,
    NameMark: PlayerControls._name_mark,
    Listen: PlayerControls._listen,
    ChangeSetting: PlayerControls._change_setting,
    ChangeSound: lambda controls, request: controls._session.change_sound(
        request.setting, request.value
    ),
    ChangeSpeech: lambda controls, request: controls._session.change_speech(
        request.setting, request.value
    ),
    ListChoices: lambda controls, _: controls._choices.look(),
    Choose: lambda controls, request: controls._choices.choose(request),
}
"""What carries out each kind of request: a new one is registered here."""
