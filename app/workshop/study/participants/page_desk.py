"""A participant at a page of this computer: questions and stimuli in a browser, tasks in a window.

The page is served on the loopback address alone, under an address that nobody can guess. A browser
that is closed in mid-question is opened again at the same address, where the question still waits.
"""

import queue
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs

from cubeling.app.admission import Token
from cubeling.app.errors import AppError
from cubeling.app.workshop.study.participants.live_task import (
    TaskSetup,
    free_recording,
    play_task,
    task_options,
)
from cubeling.app.workshop.study.participants.question_page import (
    question_page,
    text_page,
    waiting_page,
)
from cubeling.app.workshop.study.participants.stimulus_files import (
    MEDIA_TYPES,
    find_file,
    names_of,
)
from cubeling.app.workshop.study.participants.study_log import ParticipantLog
from cubeling.app.workshop.study.protocols.goals import TaskResult
from cubeling.app.workshop.study.protocols.plan import PlannedStep
from cubeling.app.workshop.study.protocols.protocol import Protocol, Settings, StudyTask
from cubeling.app.workshop.study.protocols.questionnaires import Answer, Item, Questionnaire
from cubeling.files import FileKind

MAX_ANSWER_BYTES = 65_536
"""Longest answer that is read [bytes]."""

MAX_STIMULUS_BYTES = 1 << 30

NEXT_S = 1.0
"""How long an answer waits at most for the page that follows [s]."""

POLL_S = 0.2
"""How often a wait looks for Ctrl-C [s]."""

STIMULUS_FILE = FileKind(
    "stimulus", tuple(MEDIA_TYPES), AppError, MAX_STIMULUS_BYTES, "pathlib:Path.read_bytes"
)
"""A picture or a film that is shown."""


@dataclass(frozen=True)
class ShownPage:
    """What the browser gets."""

    number: int
    """Which answer it waits for; −1 for none."""

    html: str
    files: tuple[Path, ...] = ()
    """What is shown on it."""


class PageDesk:
    """Asks on a page; a `StudyDesk`. Close it after use; a second `close` does nothing.

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
        self._token = Token.generate()
        self._shown = ShownPage(-1, waiting_page("The study begins in a moment"))
        self._count, self._closed = 0, False
        self._answers: queue.Queue[tuple[int, str]] = queue.Queue()
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), self._handler())
        self._server.daemon_threads = True
        self._thread = threading.Thread(target=self._server.serve_forever, daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        """Where the participant's browser finds the page."""
        return f"http://127.0.0.1:{self._server.server_port}/{self._token.text}"

    def close(self) -> None:
        """Stop serving the page; a second call does nothing."""
        if self._closed:
            return
        self._closed = True
        self._server.shutdown()
        self._server.server_close()
        self._thread.join(timeout=5.0)

    def now(self) -> datetime:
        """Return the local time of this computer."""
        return datetime.now()

    def tell(self, title: str, text: str) -> None:
        """Show a text until the participant goes on."""
        self._wait_for(lambda number, _: ShownPage(number, text_page(number, title, text)))

    def ask(self, step: PlannedStep, questionnaire: Questionnaire, item: Item) -> Answer:
        """Show what the question is about and the question, until there is an answer."""
        files = self._files(step)
        captions = ("left", "right") if len(files) == 2 else ("",) * len(files)

        def make(number: int, problem: str) -> ShownPage:
            shown = [
                (f"{self._token.text}/{number}/{place}", MEDIA_TYPES[file.suffix.lower()], caption)
                for place, (file, caption) in enumerate(zip(files, captions, strict=True))
            ]
            page = question_page(number, questionnaire, item, shown, problem)
            return ShownPage(number, page, files)

        problem = ""
        while True:
            text = self._wait_for(make, problem)
            try:
                return item.parse(text)
            except AppError as error:
                problem = str(error)

    def play(
        self, step: PlannedStep, task: StudyTask, settings: Settings, log: ParticipantLog
    ) -> tuple[TaskResult, str]:
        """Say what the task is, and let it be played in a window."""
        self.tell(task.name, task.text)
        self._shown = ShownPage(-1, waiting_page("Look at the other window: you play now"))
        record = free_recording(log.folder, task, step.condition)
        options = task_options(task, settings, self._setup, record, log.code, step.condition)
        return play_task(options, task), record.name

    def thank(self) -> None:
        """Show that all is done."""
        self._shown = ShownPage(-1, waiting_page("Thank you! You have finished."))

    def _files(self, step: PlannedStep) -> tuple[Path, ...]:
        if not step.stimulus:
            return ()
        names = names_of(self._protocol.stimuli[step.part], step)
        found = [(name, find_file(name, self._folder)) for name in names]
        for name, file in found:
            if file is None:
                raise AppError(f"there is no stimulus '{name}' in '{self._folder}'")
        return tuple(file for _, file in found if file is not None)

    def _wait_for(self, make: Callable[[int, str], ShownPage], problem: str = "") -> str:
        """Show a page until it is answered; what an earlier one sends again is left out."""
        self._count += 1
        self._shown = make(self._count, problem)
        while True:
            try:
                number, text = self._answers.get(timeout=POLL_S)
            except queue.Empty:
                continue
            if number == self._count:
                self._shown = ShownPage(-1, waiting_page("One moment"))
                return text

    def _wait_for_next(self, number: int) -> None:
        """Give the study a moment to show what follows, so that the browser asks for that."""
        end = time.monotonic() + NEXT_S
        while self._shown.number in (number, -1) and time.monotonic() < end:
            time.sleep(0.02)

    def _handler(self) -> type[BaseHTTPRequestHandler]:
        desk = self

        class Handler(BaseHTTPRequestHandler):
            timeout = 30.0

            def do_GET(self) -> None:
                shown = desk._shown
                path, _, rest = self.path.lstrip("/").partition("/")
                if not desk._token.admits(path) or not self._is_local():
                    self.send_error(HTTPStatus.NOT_FOUND)
                elif not rest:
                    self._send("text/html; charset=utf-8", shown.html.encode())
                else:
                    self._send_stimulus(shown, rest)

            def do_POST(self) -> None:
                length = self.headers.get("Content-Length", "")
                path = self.path.lstrip("/")
                if not desk._token.admits(path) or not self._is_local():
                    self.send_error(HTTPStatus.NOT_FOUND)
                    return
                if not length.isdecimal() or int(length) > MAX_ANSWER_BYTES:
                    self.send_error(HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
                    return
                text = self.rfile.read(int(length)).decode(errors="replace")
                fields = parse_qs(text, keep_blank_values=True, max_num_fields=16)
                number = fields.get("number", [""])[0]
                if number.isdecimal() and len(number) < 9:
                    desk._answers.put((int(number), fields.get("answer", [""])[0]))
                    desk._wait_for_next(int(number))
                self.send_response(HTTPStatus.SEE_OTHER)
                self.send_header("Location", f"/{path}")
                self.send_header("Content-Length", "0")
                self.end_headers()

            def _is_local(self) -> bool:
                """Return whether the page was asked for by this address, not by a name for it."""
                return self.headers.get("Host", "").rpartition(":")[0] in ("127.0.0.1", "localhost")

            def _send_stimulus(self, shown: ShownPage, rest: str) -> None:
                number, _, place = rest.partition("/")
                known = number == f"{shown.number}" and place.isdecimal() and len(place) < 3
                if not known or int(place) >= len(shown.files):
                    self.send_error(HTTPStatus.NOT_FOUND)
                    return
                file = shown.files[int(place)]
                self._send(MEDIA_TYPES[file.suffix.lower()], STIMULUS_FILE.read(file))

            def _send(self, kind: str, content: bytes) -> None:
                self.send_response(HTTPStatus.OK)
                self.send_header("Content-Type", kind)
                self.send_header("Content-Length", f"{len(content)}")
                self.send_header("Cache-Control", "no-store")
                self.send_header(
                    "Content-Security-Policy",
                    "default-src 'none'; img-src 'self'; media-src 'self'; "
                    "style-src 'unsafe-inline'; form-action 'self'",
                )
                self.end_headers()
                self.wfile.write(content)

            def log_message(self, format: str, *args: Any) -> None:
                """Keep the terminal for the experimenter."""

        return Handler
