"""A participant at a page: questions, stimuli and tasks in a browser, as of the phone in a hand.

A browser that is closed in mid-question is opened again at the same address, where the question
still waits.
"""

import time
from pathlib import Path

import cv2

from cubeling.app.errors import AppError
from cubeling.app.running.pages import awaited_camera, page_front_end
from cubeling.app.session import SessionOptions
from cubeling.app.ui.web.language import English
from cubeling.app.ui.web.server import WebServer
from cubeling.app.workshop.study.participants.live_task import LiveDesk, TaskSetup, play_task
from cubeling.app.workshop.study.participants.question_sheet import (
    WAITING_SHEET,
    question_sheet,
    text_sheet,
)
from cubeling.app.workshop.study.participants.stimulus_files import (
    MEDIA_TYPES,
    STIMULUS_FILE,
    captions_of,
    files_of,
    pictures_of,
)
from cubeling.app.workshop.study.protocols.goals import TaskResult
from cubeling.app.workshop.study.protocols.plan import PlannedStep
from cubeling.app.workshop.study.protocols.protocol import Protocol, StudyTask
from cubeling.app.workshop.study.protocols.questionnaires import Answer, Item, Questionnaire

SHOWN_PATH = "/shown"
"""Where the server has stimuli, and pictures of answers."""

GOODBYE_S = 2.5
"""How long the last sheet may come that thanks the participant [s]."""

POLL_S = 0.2
"""How often a wait looks for Ctrl-C [s]."""

Shown = Path | tuple[str, bytes]
"""What is shown on a sheet: a file, or the media type and the data of a picture."""


class PageDesk(LiveDesk):
    """Asks on a page, on which tasks are played, too; a `StudyDesk` and `WebContent`.

    Parameters
    ----------
    protocol, setup, folder
        See `LiveDesk`.
    server
        Serves the page, with `study`; whoever opened it closes it.
    """

    def __init__(
        self, protocol: Protocol, setup: TaskSetup, folder: Path, server: WebServer
    ) -> None:
        super().__init__(protocol, setup, folder)
        self._server, self._number = server, 0
        self._shown: tuple[Shown, ...] = ()
        server.open(SHOWN_PATH, self)
        self._wait("The study begins in a moment")

    def tell(self, title: str, text: str) -> None:
        """Show a text until the participant goes on."""
        self._wait_for(text_sheet(title, text))

    def ask(self, step: PlannedStep, questionnaire: Questionnaire, item: Item) -> Answer:
        """Show what the question is about and the question, until there is an answer."""
        files = files_of(self._protocol, step, self._folder)
        pictures = [
            ("image/png", cv2.imencode(".png", picture)[1].tobytes())
            for picture in pictures_of(item, self._folder)
        ]
        problem = ""
        while True:
            at = f"{SHOWN_PATH}/{self._number + 1}"
            shown = [
                (f"{at}/{place}", MEDIA_TYPES[file.suffix.lower()], caption)
                for place, (file, caption) in enumerate(zip(files, captions_of(files), strict=True))
            ]
            points = [f"{at}/{len(files) + place}" for place in range(len(pictures))]
            sheet = question_sheet(questionnaire, item, shown, points, again=bool(problem))
            try:
                return item.parse(self._wait_for(sheet, (*files, *pictures), problem))
            except AppError as error:
                problem = str(error)

    def give_way(self) -> None:
        """Show the picture of the task; without one, where it is."""
        if self._setup.pictures:
            self._show("")
        else:
            self._wait("You play now")

    def thank(self) -> None:
        """Show that all is done, for as long as a browser needs to be told."""
        self._wait("Thank you! You have finished.", over=True)
        time.sleep(GOODBYE_S)

    def get(self, place: str) -> tuple[str, bytes] | None:
        """Return a stimulus, or a picture of an answer, of the sheet that is shown."""
        number, _, index = place.partition("/")
        known = number == f"{self._number}" and index.isdecimal() and len(index) < 3
        if not known or int(index) >= len(self._shown):
            return None
        found = self._shown[int(index)]
        if isinstance(found, Path):
            return MEDIA_TYPES[found.suffix.lower()], STIMULUS_FILE.read(found)
        return found

    def post(self, data: bytes) -> None:
        """Take nothing: answers are messages."""

    def _play(self, options: SessionOptions, task: StudyTask) -> TaskResult:
        """Play a task on the page."""
        if options.pictures:
            self._show("", ends=task.ends == "person")
        with awaited_camera(options, self._server) as (found, camera):
            front_end = page_front_end(self._server, study=True) if options.pictures else None
            return play_task(found, task, self._setup.instruments, camera, front_end)

    def _show(self, html: str, **more: object) -> None:
        self._server.tell("sheet", number=self._number, html=html, **more)

    def _wait(self, words: str, **more: object) -> None:
        """Show why nothing is asked."""
        self._show(WAITING_SHEET, words={"waiting": English(words)}, **more)

    def _wait_for(self, html: str, shown: tuple[Shown, ...] = (), problem: str = "") -> str:
        """Show a sheet until it is answered; what answers an earlier one is left out."""
        self._number, self._shown = self._number + 1, shown
        self._show(html, words={"problem": English(problem)} if problem else {})
        while True:
            for said in self._server.take_requests(POLL_S):
                if said.do == "answer" and said.id == self._number:
                    self._wait("One moment")
                    return said.name
