"""Leading a participant through a study: each step is kept before the next one begins."""

from collections.abc import Callable
from dataclasses import asdict
from datetime import datetime
from typing import Protocol as Interface

from cubeling.app.workshop.study.participants.study_log import ParticipantLog, StudyFolder
from cubeling.app.workshop.study.protocols.goals import TaskResult
from cubeling.app.workshop.study.protocols.plan import PlannedStep
from cubeling.app.workshop.study.protocols.protocol import Protocol, Settings, StudyTask
from cubeling.app.workshop.study.protocols.questionnaires import Answer, Item, Questionnaire


class StudyDesk(Interface):
    """Where a participant sits: reads, plays and answers."""

    onset: datetime | None
    """When what the last question is about was on the screen; None where that is not known."""

    def now(self) -> datetime:
        """Return the local time, by which entries of the log are dated."""
        ...

    def tell(self, title: str, text: str) -> None:
        """Show a text until it was read."""
        ...

    def ask(self, step: PlannedStep, questionnaire: Questionnaire, item: Item) -> Answer:
        """Show what the question is about, and return the answer."""
        ...

    def play(
        self, step: PlannedStep, task: StudyTask, settings: Settings, log: ParticipantLog
    ) -> tuple[TaskResult, str]:
        """Let the participant play, and return how it ended, and the name of the recording."""
        ...

    def thank(self) -> None:
        """Show that all is done."""
        ...


def run_participant(
    protocol: Protocol,
    log: ParticipantLog,
    desk: StudyDesk,
    done: Callable[[PlannedStep], None] = lambda step: None,
) -> None:
    """Lead a participant through the steps that are left; `done` is called after each."""
    for step in log.left:
        began = desk.now()
        if step.kind == "instruction":
            instruction = protocol.instructions[step.part]
            desk.tell(instruction.title, instruction.text)
            found: dict[str, object] = {"read": True}
        elif step.kind == "task":
            task = protocol.tasks[step.part]
            settings = protocol.conditions.get(step.condition, Settings())
            result, recording = desk.play(step, task, settings, log)
            found = {**asdict(result), "recording": recording}
        else:
            questionnaire = protocol.questionnaires[step.questionnaire]
            item = next(each for each in questionnaire.item if each.name == step.item)
            found = {"answer": desk.ask(step, questionnaire, item)}
            if desk.onset is not None:
                found["onset_at"] = desk.onset.isoformat(timespec="microseconds")
        now = desk.now()
        seconds = round((now - began).total_seconds(), 3)
        log.write({"key": step.key, **found, "seconds": seconds}, now)
        done(step)


def run_simulated(study: StudyFolder, count: int) -> None:
    """Let simulated participants take part, as many as are missing to a number."""
    from cubeling.app.workshop.study.participants.simulated import SimulatedDesk

    finished = {person.code for person in study.people if study.has_finished(person)}
    width = max(2, len(str(count)))
    for number in range(count):
        code = f"SIM{number + 1:0{width}}"
        if code in finished:
            continue
        desk = SimulatedDesk(study.protocol, number)
        run_participant(study.protocol, study.begin(code, desk.now()), desk)
