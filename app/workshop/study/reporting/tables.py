"""A study as tidy tables: a row for each participant, answer, task and score."""

import csv
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cubeling.app.errors import AppError
from cubeling.app.workshop.study.participants.study_log import Entry, Participant
from cubeling.app.workshop.study.protocols.plan import PlannedStep, conditions_of, plan_of
from cubeling.app.workshop.study.protocols.protocol import Protocol
from cubeling.app.workshop.study.protocols.questionnaires import Answer
from cubeling.files import whole_file

Row = dict[str, Any]

COLUMNS: dict[str, dict[str, str]] = {
    "participants": {
        "participant": "Code of the participant",
        "number": "Their number, from 0, which decides the orders",
        "kind": "study, pilot or simulated",
        "conditions": "Their conditions in their order, separated by semicolons",
        "begun": "How often they began; more than 1 after an interruption",
        "done": "Steps that they finished",
        "planned": "Steps that were planned for them",
        "started_at": "Local time of the first step that counts, by ISO 8601",
        "ended_at": "Local time of the last one",
    },
    "answers": {
        "participant": "Code of the participant",
        "kind": "study, pilot or simulated",
        "condition": "The condition; empty for none",
        "phase": "The phase of the protocol",
        "questionnaire": "The questionnaire",
        "after": "The task that the question is about; empty for none",
        "item": "The question's name",
        "stimulus": "The levels of its factors, in JSON; empty for none",
        "place": "Place of the stimulus in the participant's order, from 1; 0 for none",
        "first_left": "Of a pair: 1 if its first member was on the left",
        "answer": "The number, the choice or the text; empty for no answer",
        "seconds": "How long it took [s]",
        "onset_at": "Local time at which the stimulus was on the screen; empty outside a window",
        "at": "Local time of the answer, by ISO 8601",
    },
    "tasks": {
        "participant": "Code of the participant",
        "kind": "study, pilot or simulated",
        "condition": "The condition; empty for none",
        "phase": "The phase of the protocol",
        "task": "The task's name",
        "place": "Place among the participant's tasks, from 1",
        "goal": "What was to be reached",
        "reached": "1 if it was reached within the limit",
        "time_s": "When, from the first frame [s]; empty if it was not",
        "played_s": "How long it lasted [s]",
        "limit_s": "The limit [s]",
        "ended_by": "goal, limit, person (the participant ended it) or source (there were no more "
        "pictures); empty where it was not noted",
        "attempt": "Which attempt this is: more than 1 if earlier ones were interrupted, whose "
        "recordings are kept, too; empty for simulated ones and where it was not noted",
        "recording": "File of the session in the participant's folder; empty for simulated ones",
    },
    "acts": {
        "participant": "Code of the participant",
        "kind": "study, pilot or simulated",
        "condition": "The condition; empty for none",
        "phase": "The phase of the protocol",
        "task": "The task in which a wizard acted",
        "number": "Number of the act in its session, from 1",
        "at_s": "Time of the frame in which it began, from the first frame [s]",
        "act": "say, action, gesture, emotion, go (somewhere), play (by the robot)",
        "name": "What was done",
        "cue": "The cue that it answers; empty for none",
        "delay_s": "Time from the cue to the act at the desk [s]; empty without a cue",
        "undone": "1 if the wizard took it back as an error",
    },
    "scores": {
        "participant": "Code of the participant",
        "kind": "study, pilot or simulated",
        "condition": "The condition; empty for none",
        "phase": "The phase of the protocol",
        "questionnaire": "The questionnaire",
        "after": "The task that it was about; empty for none",
        "score": "The score's name in the published key",
        "value": "The score",
    },
}
"""The tables, their columns, and what each column means."""

DICTIONARY = "data_dictionary"


@dataclass(frozen=True)
class StudyData:
    """All that participants did, as rows."""

    protocol: Protocol
    kind: str
    """study, pilot or simulated."""

    people: tuple[Participant, ...]
    tables: dict[str, list[Row]]
    """The rows of each table of `COLUMNS`."""


def gather(protocol: Protocol, kind: str, people: Sequence[Participant]) -> StudyData:
    """Return a study as tables."""
    tables: dict[str, list[Row]] = {name: [] for name in COLUMNS}
    for person in people:
        plan = plan_of(protocol, person.number)
        times = sorted(str(each["at"]) for each in person.entries)
        who = {"participant": person.code, "kind": kind}
        tables["participants"].append(
            {
                **who,
                "number": person.number,
                "conditions": ";".join(conditions_of(protocol, person.number)),
                "begun": person.times_begun,
                "done": sum(step.key in person.done for step in plan),
                "planned": len(plan),
                "started_at": times[0] if times else None,
                "ended_at": times[-1] if times else None,
            }
        )
        entries = {str(each["key"]): each for each in person.entries}
        done = [(step, entries[step.key]) for step in plan if step.key in entries]
        tables["answers"] += [
            {**who, **_answer_row(step, entry)} for step, entry in done if step.kind == "question"
        ]
        played = [each for each in done if each[0].kind == "task"]
        tables["tasks"] += [
            {**who, **_task_row(person, protocol, place, step, entry)}
            for place, (step, entry) in enumerate(played, 1)
        ]
        tables["acts"] += [{**who, **row} for each in played for row in _act_rows(*each)]
        tables["scores"] += [{**who, **row} for row in _score_rows(protocol, done)]
    return StudyData(protocol, kind, tuple(people), tables)


def _answer_row(step: PlannedStep, entry: Entry) -> Row:
    return {
        "condition": step.condition,
        "phase": step.phase,
        "questionnaire": step.questionnaire,
        "after": step.after,
        "item": step.item,
        "stimulus": dict(step.stimulus),
        "place": step.place,
        "first_left": step.first_left,
        "answer": entry.get("answer"),
        "seconds": entry.get("seconds"),
        "onset_at": entry.get("onset_at"),
        "at": entry.get("at"),
    }


def _task_row(
    person: Participant, protocol: Protocol, place: int, step: PlannedStep, entry: Entry
) -> Row:
    task = protocol.tasks[step.part]
    return {
        "condition": step.condition,
        "phase": step.phase,
        "task": task.name,
        "place": place,
        "goal": task.goal.words,
        **{name: entry.get(name) for name in ("reached", "time_s", "played_s")},
        "limit_s": task.limit_s,
        "ended_by": entry.get("ended_by"),
        "attempt": person.attempts.get(step.key),
        "recording": entry.get("recording"),
    }


def _act_rows(step: PlannedStep, entry: Entry) -> Iterator[Row]:
    place = {"condition": step.condition, "phase": step.phase, "task": step.part}
    for act in entry.get("acts", ()):
        names = ("number", "at_s", "name", "cue", "delay_s", "undone")
        yield {**place, "act": act.get("kind"), **{name: act.get(name) for name in names}}


def _score_rows(protocol: Protocol, done: list[tuple[PlannedStep, Entry]]) -> Iterator[Row]:
    asked: dict[tuple[str, ...], dict[str, Answer]] = {}
    for step, entry in done:
        if step.kind == "question" and not step.stimulus:
            place = (step.condition, step.phase, step.questionnaire, step.after)
            asked.setdefault(place, {})[step.item] = entry.get("answer")
    for (condition, phase, name, after), answers in asked.items():
        for score, value in protocol.questionnaires[name].scores(answers).items():
            yield {
                "condition": condition,
                "phase": phase,
                "questionnaire": name,
                "after": after,
                "score": score,
                "value": round(value, 6),
            }


def write_tables(data: StudyData, folder: Path) -> list[Path]:
    """Write the tables and their dictionary as CSV, each whole or not at all; raises AppError."""
    rows: dict[str, list[list[Any]]] = {
        name: [
            list(columns),
            *([_cell(row[each]) for each in columns] for row in data.tables[name]),
        ]
        for name, columns in COLUMNS.items()
    }
    meanings = (
        [name, column, meaning]
        for name, columns in COLUMNS.items()
        for column, meaning in columns.items()
    )
    rows[DICTIONARY] = [["table", "column", "meaning"], *meanings]
    paths = []
    for name, lines in rows.items():
        path = folder / f"{name}.csv"
        with (
            whole_file(path, AppError) as partial,
            partial.open("w", encoding="utf-8", newline="") as file,
        ):
            csv.writer(file).writerows(lines)
        paths.append(path)
    return paths


def _cell(value: Any) -> Any:
    if value is None or value == {}:
        return ""
    if isinstance(value, bool):
        return int(value)
    return json.dumps(value, ensure_ascii=False) if isinstance(value, dict) else value
