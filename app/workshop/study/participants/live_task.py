"""A task of a study, played in a session that is recorded, and judged by its channels."""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from datetime import datetime
from itertools import chain
from pathlib import Path
from typing import Any

from cubeling.app.output_path import later_parts
from cubeling.app.pipeline.step import Step
from cubeling.app.running.front_end import FrontEnd
from cubeling.app.running.instrument import Instrument
from cubeling.app.running.opening import open_session
from cubeling.app.running.option_checks import check_inputs
from cubeling.app.running.runner import run
from cubeling.app.session import SessionFile, SessionOptions, wizard_acts
from cubeling.app.session.encoding import MESSAGE_TYPES
from cubeling.app.workshop.study.participants.study_log import ParticipantLog, SteadyClock
from cubeling.app.workshop.study.protocols.goals import (
    GOAL_TOPICS,
    Ending,
    GoalWatch,
    TaskResult,
    result_of,
)
from cubeling.app.workshop.study.protocols.plan import PlannedStep
from cubeling.app.workshop.study.protocols.protocol import Protocol, Settings, StudyTask
from cubeling.tracking import FrameSource, open_source


class _TaskOverError(Exception):
    """The goal is reached, or the time is up."""


@dataclass(frozen=True)
class TaskSetup:
    """What stands on the experimenter's table, for every task."""

    source: str = "camera:0"
    """Where the frames come from."""

    robot: str = "sim"
    pictures: bool = True
    """Whether there is a window."""

    intrinsics: Path | None = None
    instruments: tuple[Instrument, ...] = ()
    """What else follows the tasks, such as a wizard's desk."""

    parts: Mapping[str, Any] = field(default_factory=dict)
    """When a recording goes on in another file: `part_s` and `part_bytes` of `SessionOptions`."""

    def options(self, task: StudyTask, settings: Settings) -> SessionOptions:
        """Return the settings of a session in which a task is played under a condition."""
        return SessionOptions(
            scenario=task.scenario,
            source=self.source,
            character=settings.character,
            personality=settings.personality,
            controller=settings.controller,
            turns=settings.turns,
            robot=self.robot,
            intrinsics=self.intrinsics,
            pictures=self.pictures,
            **self.parts,
        )


class LiveDesk:
    """What a terminal, a window and a page have in common as a `StudyDesk`.

    Parameters
    ----------
    protocol
        The study.
    setup
        How tasks are played.
    folder
        Where the stimuli are.
    """

    def __init__(self, protocol: Protocol, setup: TaskSetup, folder: Path) -> None:
        self._protocol, self._setup, self._folder = protocol, setup, folder
        self.onset: datetime | None = None
        """When what the last question is about was on the screen; None where that is not known."""
        self.now = SteadyClock()
        """Returns the local time."""

    def tell(self, title: str, text: str) -> None:
        """Show a text until it was read."""
        raise NotImplementedError

    def give_way(self) -> None:
        """Prepare for a task, which has a window of its own."""

    def play(
        self, step: PlannedStep, task: StudyTask, settings: Settings, log: ParticipantLog
    ) -> tuple[TaskResult, str]:
        """Say what the task is, let it be played, and return how it ended, and its recording."""
        self.tell(task.title, task.text)
        self.give_way()
        log.write({"tries": step.key}, self.now())
        record = free_recording(log.folder, task, step.condition)
        options = replace(
            self._setup.options(task, settings),
            record=record,
            participant=log.code,
            condition=step.condition,
        )
        return self._play(options, task), record.name

    def _play(self, options: SessionOptions, task: StudyTask) -> TaskResult:
        """Play a task in a window of its own."""
        return play_task(options, task, self._setup.instruments)


def check_tasks(protocol: Protocol, setup: TaskSetup, *, camera: bool = True) -> None:
    """Refuse what tasks cannot be played with, before a participant has begun.

    Parameters
    ----------
    protocol, setup
        See `LiveDesk`.
    camera
        Whether the camera is there before the participant is, so that it can be tried.

    Raises
    ------
    AppError, AffectError, CharacterError, RobotError, TrackingError
        The camera cannot be opened, or something that a task names is not there.
    """
    for task in protocol.tasks.values():
        for settings in protocol.conditions.values() or (Settings(),):
            check_inputs(setup.options(task, settings))
    if protocol.tasks and camera:
        with open_source(setup.source):
            pass


def play_task(
    options: SessionOptions,
    task: StudyTask,
    instruments: Sequence[Instrument] = (),
    source: FrameSource | None = None,
    front_end: FrontEnd | None = None,
) -> TaskResult:
    """Play a task until its goal is reached, its time is up, or the participant ends it.

    The result is that of the recording, so that whoever reads it later finds the same. See
    `open_session` for `source` and `front_end`.

    Raises
    ------
    AppError, TrackingError, RobotError
        It cannot be played, or gave no picture; KeyboardInterrupt if Ctrl-C ended it.
    """
    watch = GoalWatch(task.goal, task.limit_s)

    def follow(step: Step) -> None:
        for topic, message in step.messages().items():
            if topic in GOAL_TOPICS:
                watch.see(topic, step.frame.timestamp, message)
        if watch.time_is_up or (watch.reached and task.ends == "goal"):
            raise _TaskOverError

    try:
        with open_session(
            options, source=source, front_end=front_end, instruments=instruments
        ) as session:
            summary = run(session, follow)
            ended_by: Ending = "person" if session.screen.closed else "source"
        summary.check()
        if summary.interrupted:
            raise KeyboardInterrupt
    except _TaskOverError:
        ended_by = "goal" if watch.reached and task.ends == "goal" else "limit"
    assert options.record is not None, "a task is recorded"
    return replace(judge(options.record, task), ended_by=ended_by)


def judge(session: Path, task: StudyTask) -> TaskResult:
    """Return how a task ended, by the channels of its recording, in parts or not.

    That the participant ended it is not among them: `ended_by` is then "source".

    Raises AppError if it cannot be read.
    """
    kinds = {topic: MESSAGE_TYPES[topic] for topic in GOAL_TOPICS}
    with ExitStack() as closing:
        parts = [session, *later_parts(session)]
        files = [closing.enter_context(SessionFile(part)) for part in parts]
        messages = chain.from_iterable(file.decode_messages(kinds) for file in files)
        result = result_of(task.goal, task.limit_s, messages)
        inputs = {time: each for file in files for time, each in file.inputs.items()}
        return replace(result, acts=wizard_acts(inputs, files[0].first_time))


def free_recording(folder: Path, task: StudyTask, condition: str) -> Path:
    """Return a file for the recording of a task that no earlier attempt has."""
    stem = "-".join(filter(None, (task.name, condition))).replace(" ", "-")
    paths = (folder / f"{stem}{number}.mcap" for number in ("", *(f"-{n}" for n in range(2, 1000))))
    return next(path for path in paths if not path.exists())
