"""A participant at a page of this computer: questions and stimuli in a browser, tasks in a window.

The page is served on the loopback address alone, under an address that nobody can guess. A browser
that is closed in mid-question is opened again at the same address, where the question still waits.
"""

import queue
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import parse_qs

import cv2

from cubeling.app.errors import AppError
from cubeling.app.ui.local_pages import HTML, LocalPages, PageReply
from cubeling.app.workshop.study.participants.live_task import LiveDesk, TaskSetup
from cubeling.app.workshop.study.participants.question_page import (
    question_page,
    text_page,
    waiting_page,
)
from cubeling.app.workshop.study.participants.stimulus_files import (
    MEDIA_TYPES,
    STIMULUS_FILE,
    captions_of,
    files_of,
    pictures_of,
)
from cubeling.app.workshop.study.protocols.plan import PlannedStep
from cubeling.app.workshop.study.protocols.protocol import Protocol
from cubeling.app.workshop.study.protocols.questionnaires import Answer, Item, Questionnaire

MAX_FIELDS = 16
"""Most fields of a form."""

NEXT_S = 1.0
"""How long an answer waits at most for the page that follows [s]."""

GOODBYE_S = 2.5
"""How long the last page may be fetched that thanks the participant [s]."""

POLL_S = 0.2
"""How often a wait looks for Ctrl-C [s]."""


@dataclass(frozen=True)
class ShownPage:
    """What the browser gets."""

    number: int
    """Which answer it waits for; −1 for none."""

    html: str
    shown: tuple[Path | PageReply, ...] = ()
    """What is shown on it: files, and pictures of answers."""


class PageDesk(LiveDesk):
    """Asks on a page; a `StudyDesk` and a `LocalPage`.

    Parameters
    ----------
    protocol, setup, folder
        See `LiveDesk`.
    pages
        Serves the page; whoever opened it closes it.
    """

    def __init__(
        self, protocol: Protocol, setup: TaskSetup, folder: Path, pages: LocalPages
    ) -> None:
        super().__init__(protocol, setup, folder)
        self._shown = ShownPage(-1, waiting_page("The study begins in a moment"))
        self._count = 0
        self._answers: queue.Queue[tuple[int, str]] = queue.Queue()
        self.address = pages.open(self)
        """Where the participant's browser finds the page."""

    def tell(self, title: str, text: str) -> None:
        """Show a text until the participant goes on."""
        self._wait_for(lambda number, _: ShownPage(number, text_page(number, title, text)))

    def ask(self, step: PlannedStep, questionnaire: Questionnaire, item: Item) -> Answer:
        """Show what the question is about and the question, until there is an answer."""
        files = files_of(self._protocol, step, self._folder)
        pictures = [
            PageReply("image/png", cv2.imencode(".png", picture)[1].tobytes())
            for picture in pictures_of(item, self._folder)
        ]

        def make(number: int, problem: str) -> ShownPage:
            at = f"{self.address}/{number}"
            shown = [
                (f"{at}/{place}", MEDIA_TYPES[file.suffix.lower()], caption)
                for place, (file, caption) in enumerate(zip(files, captions_of(files), strict=True))
            ]
            points = [f"{at}/{len(files) + place}" for place in range(len(pictures))]
            page = question_page(number, questionnaire, item, shown, points, problem)
            return ShownPage(number, page, (*files, *pictures))

        problem = ""
        while True:
            text = self._wait_for(make, problem)
            try:
                return item.parse(text)
            except AppError as error:
                problem = str(error)

    def give_way(self) -> None:
        """Show on the page where the task is."""
        self._shown = ShownPage(-1, waiting_page("Look at the other window: you play now"))

    def thank(self) -> None:
        """Show that all is done, for as long as a browser needs to fetch it."""
        self._shown = ShownPage(-1, waiting_page("Thank you! You have finished."))
        time.sleep(GOODBYE_S)

    def get(self, place: str) -> PageReply | None:
        """Return the page, or a stimulus that is shown on it."""
        shown = self._shown
        if not place:
            return PageReply(HTML, shown.html.encode())
        number, _, index = place.partition("/")
        known = number == f"{shown.number}" and index.isdecimal() and len(index) < 3
        if not known or int(index) >= len(shown.shown):
            return None
        file = shown.shown[int(index)]
        if isinstance(file, PageReply):
            return file
        return PageReply(MEDIA_TYPES[file.suffix.lower()], STIMULUS_FILE.read(file))

    def post(self, data: bytes) -> None:
        """Take an answer, and show what follows."""
        try:
            text = data.decode()
            fields = parse_qs(text, keep_blank_values=True, max_num_fields=MAX_FIELDS)
        except ValueError:  # this is no form of ours
            return
        number = fields.get("number", [""])[0]
        if number.isdecimal() and len(number) < 9:
            self._answers.put((int(number), fields.get("answer", [""])[0]))
            self._wait_for_next(int(number))

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
