"""A task of a study, played in a session that is recorded, and judged by its channels."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from cubeling.app.pipeline.step import Step
from cubeling.app.running.instrument import Instrument
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.app.session.encoding import MESSAGE_TYPES
from cubeling.app.workshop.study.participants.study_log import ParticipantLog
from cubeling.app.workshop.study.protocols.goals import (
    GOAL_TOPICS,
    GoalWatch,
    TaskResult,
    result_of,
)
from cubeling.app.workshop.study.protocols.protocol import Settings, StudyTask


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


def play_step(
    task: StudyTask,
    settings: Settings,
    setup: TaskSetup,
    log: ParticipantLog,
    condition: str,
) -> tuple[TaskResult, str]:
    """Play a task of a participant, and return how it ended, and the name of its recording."""
    record = free_recording(log.folder, task, condition)
    options = SessionOptions(
        scenario=task.scenario,
        source=setup.source,
        character=settings.character,
        personality=settings.personality,
        controller=settings.controller,
        turns=settings.turns,
        robot=setup.robot,
        intrinsics=setup.intrinsics,
        pictures=setup.pictures,
        record=record,
        participant=log.code,
        condition=condition,
    )
    return play_task(options, task, setup.instruments), record.name


def play_task(
    options: SessionOptions, task: StudyTask, instruments: Sequence[Instrument] = ()
) -> TaskResult:
    """Play a task until its goal is reached, its time is up, or the participant ends it.

    The result is that of the recording, so that whoever reads it later finds the same.

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
        with open_session(options, instruments=instruments) as session:
            summary = run(session, follow)
        summary.check()
        if summary.interrupted:
            raise KeyboardInterrupt
    except _TaskOverError:
        pass
    assert options.record is not None, "a task is recorded"
    return judge(options.record, task)


def judge(session: Path, task: StudyTask) -> TaskResult:
    """Return how a task ended, by the channels of its recording; raises AppError."""
    kinds = {topic: MESSAGE_TYPES[topic] for topic in GOAL_TOPICS}
    with SessionFile(session) as file:
        result = result_of(task.goal, task.limit_s, file.decode_messages(kinds))
        return replace(result, acts=file.wizard_acts)


def free_recording(folder: Path, task: StudyTask, condition: str) -> Path:
    """Return a file for the recording of a task that no earlier attempt has."""
    stem = "-".join(filter(None, (task.name, condition))).replace(" ", "-")
    paths = (folder / f"{stem}{number}.mcap" for number in ("", *(f"-{n}" for n in range(2, 1000))))
    return next(path for path in paths if not path.exists())
