"""What participants did and answered: a line of JSON for each step, kept before the next begins.

A study is a folder: its protocol as it was at the first run, and a folder for each participant,
with a log and the recordings of tasks. A log is only ever appended to. What a kill or a full disk
leaves of a last line is left out, so that at most one answer is lost.
"""

import json
import os
import re
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

from cubeling.app.errors import AppError
from cubeling.app.session import check_participant
from cubeling.app.workshop.study.protocols.plan import PlannedStep, plan_of
from cubeling.app.workshop.study.protocols.protocol import Protocol
from cubeling.app.workshop.study.protocols.protocol_file import PROTOCOL_FILE, read_protocol
from cubeling.files import FileKind, is_there, write_whole

LOG_NAME = "log.jsonl"

LOG_FILE = FileKind(
    "study log",
    (".jsonl",),
    AppError,
    64_000_000,
    "cubeling.app.workshop.study.participants.study_log:read_log",
)
"""The log of a participant."""

STUDY_FILE = FileKind(
    "study",
    (".json",),
    AppError,
    65_536,
    "cubeling.app.workshop.study.participants.study_log:read_about",
)
"""What a study says of itself."""

ABOUT_NAME, PROTOCOL_NAME = "study.json", "protocol.toml"

EARLIER = "protocol-before-"
"""How the files of protocols are called that were changed since."""

FORMAT = 1
"""The version of the logs that are written."""

Entry = Mapping[str, Any]
"""A line of a log: "key" and "at" (local time by ISO 8601), and what the step gave."""


@dataclass(frozen=True)
class Participant:
    """Somebody who takes part."""

    code: str
    """What they are called here: never a name."""

    number: int
    """Their place in the plan, from 0."""

    folder: Path
    entries: tuple[Entry, ...]
    """What they did so far, without what was done again later."""

    times_begun: int
    """How often they began; 1 for those who were not interrupted."""

    attempts: Mapping[str, int] = field(default_factory=dict)
    """How often they began each task, by its key, those that were interrupted too."""

    @property
    def done(self) -> frozenset[str]:
        """Keys of the steps that they have finished."""
        return frozenset(str(each["key"]) for each in self.entries if "key" in each)


class SteadyClock:
    """The local time as it was at the beginning, and what has passed since.

    A clock of the computer that is set in the meantime changes no duration.
    """

    def __init__(self) -> None:
        self._began, self._at = datetime.now(), time.monotonic()

    def __call__(self) -> datetime:
        """Return the local time."""
        return self._began + timedelta(seconds=time.monotonic() - self._at)


def read_about(path: Path) -> dict[str, Any]:
    """Read what a study says of itself; raises AppError."""
    try:
        about = json.loads(STUDY_FILE.read_text(path))
    except (ValueError, RecursionError):
        about = None
    if not isinstance(about, dict) or about.get("format") != FORMAT:
        raise AppError(f"'{path}' is no study of this version of Cubeling")
    return about


def read_log(path: Path) -> tuple[list[dict[str, Any]], int]:
    """Read a log: its entries, and how many bytes of the file are whole lines; raises AppError."""
    data = LOG_FILE.read(path)
    whole = data.rfind(b"\n") + 1
    entries = []
    for number, line in enumerate(data[:whole].splitlines(), 1):
        try:
            entry = json.loads(line)
            datetime.fromisoformat(entry["at"])
        except (ValueError, RecursionError, TypeError, KeyError):
            entry = None
        if not isinstance(entry, dict):
            raise AppError(f"the study log '{path}' is damaged in line {number}")
        entries.append(entry)
    return entries, whole


class StudyFolder:
    """A study on disk.

    Parameters
    ----------
    path
        Its folder, which is made for a new study, but not the one that it is in. It is
        replaced as long as nobody has begun.
    protocol, source
        Its protocol, and the file of that.
    kind
        "study", "pilot" or "simulated"; a folder has one kind, so that none is taken for another.

    Raises
    ------
    AppError
        The folder cannot be written to, or holds another study.
    """

    def __init__(self, path: Path, protocol: Protocol, source: Path, kind: str) -> None:
        self.path, self.protocol = path, protocol
        self.durable = kind != "simulated"
        """Whether each answer is on the disk before the next one: simulated ones are made again."""
        about = {"format": FORMAT, "protocol": protocol.name, "kind": kind, "seed": protocol.seed}
        known = path / ABOUT_NAME
        begun = is_there(known) and bool(participants_in(path))
        if begun:
            before = read_about(known)
            for name, what in (("protocol", "the study"), ("kind", "participants of the kind")):
                if before.get(name) != about[name]:
                    raise AppError(
                        f"'{path}' holds {what} '{before.get(name)}', not '{about[name]}': "
                        "choose another folder"
                    )
            self._follow_change(source)
            return
        if path.exists() and not is_there(known) and (not path.is_dir() or any(path.iterdir())):
            raise AppError(f"'{path}' is not empty and holds no study: choose another folder")
        try:
            path.mkdir(exist_ok=True)
            self._copy(source)
            write_whole(known, json.dumps(about) + "\n", AppError)  # last: it makes it a study
        except OSError as error:
            raise AppError(f"cannot make the study '{path}': {error.strerror}") from None

    def _copy(self, source: Path) -> None:
        """Keep the protocol as it is, and what it reads, so that a report needs nothing else."""
        write_whole(self.path / PROTOCOL_NAME, PROTOCOL_FILE.read(source), AppError)
        for name in self.protocol.files:
            write_whole(self.path / name, PROTOCOL_FILE.read(source.parent / name), AppError)

    def _follow_change(self, source: Path) -> None:
        """Keep both protocols if it was changed since the first run; the report says so."""
        before = PROTOCOL_FILE.read(self.path / PROTOCOL_NAME)
        if before != PROTOCOL_FILE.read(source):
            number = len(list(self.path.glob(f"{EARLIER}*.toml"))) + 1
            write_whole(self.path / f"{EARLIER}{number}.toml", before, AppError)
            self._copy(source)

    @property
    def people(self) -> list[Participant]:
        """The participants, in the order of their numbers."""
        return participants_in(self.path)

    def has_finished(self, person: Participant) -> bool:
        """Return whether a participant has finished every step."""
        return all(step.key in person.done for step in plan_of(self.protocol, person.number))

    def begin(self, code: str, now: datetime) -> "ParticipantLog":
        """Return the log of a participant: a new one, or one to go on with.

        Raises
        ------
        AppError
            The code is none, has taken part, or may not go on by the policy of the protocol.
        """
        check_participant(code)
        if not code:
            raise AppError("a participant needs a code: --participant P01")
        folder = self.path / code
        codes = [person.code for person in self.people]
        for each in codes:
            if each.casefold() == code.casefold() and each != code:
                raise AppError(f"the code '{code}' is that of '{each}' in other letters")
        if not is_there(folder / LOG_NAME):
            number = len(codes)
            try:
                folder.mkdir(exist_ok=True)
            except OSError as error:
                raise AppError(f"cannot write to '{folder}': {error.strerror}") from None
            return ParticipantLog(self, folder, number, code, frozenset(), now)
        person = read_participant(folder)
        if self.has_finished(person):
            raise AppError(f"'{code}' has taken part already: use another code")
        done = self._kept(person, plan_of(self.protocol, person.number), now)
        return ParticipantLog(self, folder, person.number, code, done, now)

    def _kept(
        self, person: Participant, plan: tuple[PlannedStep, ...], now: datetime
    ) -> frozenset[str]:
        """Return the steps that an interrupted participant need not do again."""
        rules = self.protocol.resume
        if rules.policy == "block":
            raise AppError(f"'{person.code}' was interrupted, and the protocol lets nobody go on")
        last = max((str(each["at"]) for each in person.entries), default=now.isoformat())
        age = now - datetime.fromisoformat(last)
        if rules.policy == "restart" or age > timedelta(hours=rules.oldest_h):
            return frozenset()
        if rules.at == "answer":
            return person.done
        phases = {step.phase for step in plan if step.key not in person.done}
        return frozenset(s.key for s in plan if s.key in person.done and s.phase not in phases)


class ParticipantLog:
    """Appends to the log of a participant; each entry is on the disk when `write` returns."""

    def __init__(
        self,
        study: StudyFolder,
        folder: Path,
        number: int,
        code: str,
        done: frozenset[str],
        now: datetime,
    ) -> None:
        self.folder, self.number, self.code = folder, number, code
        self.plan = plan_of(study.protocol, number)
        self.left = tuple(step for step in self.plan if step.key not in done)
        """The steps that are left, in their order."""
        self._path, self._durable = folder / LOG_NAME, study.durable
        if is_there(self._path):
            _, whole = read_log(self._path)
            os.truncate(self._path, whole)
        self.write({"begins": code, "number": number, "kept": sorted(done)}, now)

    def write(self, entry: Entry, now: datetime) -> None:
        """Append an entry; raises AppError on a full disk."""
        line = json.dumps({**entry, "at": now.isoformat(timespec="milliseconds")}) + "\n"
        try:
            file = os.open(self._path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
            try:
                os.write(file, line.encode())
                if self._durable:
                    os.fsync(file)
            finally:
                os.close(file)
        except OSError as error:
            raise AppError(f"cannot write to '{self._path}': {error.strerror}") from None


def read_participant(folder: Path) -> Participant:
    """Read what a participant did; raises AppError."""
    entries, _ = read_log(folder / LOG_NAME)
    begun, number, kept, attempts = 0, 0, dict[str, Entry](), Counter[str]()
    for entry in entries:
        if "begins" in entry:
            begun += 1
            number = entry["number"] if isinstance(entry.get("number"), int) else 0
            keys = set(entry.get("kept", ()))
            kept = {key: each for key, each in kept.items() if key in keys}
        elif "tries" in entry:
            attempts[str(entry["tries"])] += 1
        elif "key" in entry:
            kept[str(entry["key"])] = entry
    return Participant(folder.name, number, folder, tuple(kept.values()), begun, attempts)


def participants_in(study: Path) -> list[Participant]:
    """Return the participants of a study, in the order of their numbers; raises AppError."""
    found: Iterator[Path] = (each.parent for each in study.glob(f"*/{LOG_NAME}"))
    people = [read_participant(folder) for folder in found]
    people = [each for each in people if each.times_begun]
    return sorted(people, key=lambda each: (each.number, _natural(each.code)))


def _natural(code: str) -> list[tuple[int, str]]:
    return [(int(part), "") if part.isdigit() else (0, part) for part in re.split(r"(\d+)", code)]


def read_study(folder: Path) -> tuple[Protocol, str, bool]:
    """Return the protocol of a study, its kind, and whether the protocol was changed.

    Raises AppError if the folder holds no study.
    """
    if not is_there(folder / ABOUT_NAME):
        raise AppError(f"'{folder}' holds no study: cubeling study run makes one")
    about = read_about(folder / ABOUT_NAME)
    protocol = replace(read_protocol(folder / PROTOCOL_NAME), name=str(about.get("protocol", "")))
    return protocol, str(about.get("kind", "study")), any(folder.glob(f"{EARLIER}*.toml"))
