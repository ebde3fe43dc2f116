"""Parts of recorded sessions, read from their files."""

from pathlib import Path

from cubeling.app.pipeline.step import ReplayInputs
from cubeling.app.pipeline.table.spoken_line import LEAD, SpokenLine
from cubeling.app.running.replay_check import ComparisonResult, check_session
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.app.session.inputs import RecordedInputs


def events(path: Path) -> list[tuple[float, str]]:
    with SessionFile(path) as session:
        return session.events


def inputs(path: Path) -> dict[float, RecordedInputs]:
    with SessionFile(path) as session:
        return session.inputs


def start_overs(path: Path) -> frozenset[float]:
    with SessionFile(path) as session:
        return session.start_overs


def openings(path: Path) -> frozenset[float]:
    with SessionFile(path) as session:
        return session.openings


def lines(path: Path) -> dict[float, SpokenLine]:
    with SessionFile(path) as session:
        return {time: said[LEAD] for time, said in session.lines.items() if LEAD in said}


def has_channels(path: Path) -> bool:
    with SessionFile(path) as session:
        return session.has_channels


def replay_inputs(path: Path, start: str) -> list[ReplayInputs]:
    with SessionFile(path) as session:
        return list(session.replay_inputs(start))


def check(path: Path, options: SessionOptions) -> ComparisonResult:
    with SessionFile(path) as session:
        return check_session(session, options)
