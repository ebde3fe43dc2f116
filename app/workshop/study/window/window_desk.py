"""A participant at a window: texts, questions, stimuli and tasks, one after the other."""

import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from datetime import timedelta
from pathlib import Path

import numpy as np

from cubeling.app.errors import AppError
from cubeling.app.ui.window.surface import WindowSurface
from cubeling.app.workshop.study.participants.live_task import LiveDesk, TaskSetup
from cubeling.app.workshop.study.participants.stimulus_files import (
    captions_of,
    files_of,
    is_film,
    pictures_of,
    read_picture,
)
from cubeling.app.workshop.study.protocols.plan import PlannedStep
from cubeling.app.workshop.study.protocols.protocol import Protocol
from cubeling.app.workshop.study.protocols.questionnaires import Answer, Item, Questionnaire
from cubeling.app.workshop.study.window.fields import SHEET_HEIGHT, SHEET_WIDTH, Picture
from cubeling.app.workshop.study.window.film_sound import FilmSounds, sound_of
from cubeling.app.workshop.study.window.sheet import Sheet, empty_sheet
from cubeling.tracking import Frame, open_source

POLL_S = 0.01
"""How often keys and mouse are looked at [s]."""

DARK_S = 0.1
"""How long a light sensor sees black before a stimulus [s]."""

SETTLE_S = 0.3
"""How long a window takes until it is where it stays [s]."""

SIZE_PX = round(SHEET_WIDTH), round(SHEET_HEIGHT)


@contextmanager
def at_first_turn() -> Iterator[None]:
    """Let this thread run as soon as it can, before all other programs, if the system allows it."""
    try:
        usual = os.sched_getscheduler(0), os.sched_getparam(0)
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    except (AttributeError, OSError):  # another system, or no right to it
        yield
        return
    try:
        yield
    finally:
        os.sched_setscheduler(0, *usual)


class QuestionWindow(WindowSurface):
    """A window with a sheet; F fills the screen, unless letters are text."""

    def __init__(self, *, fills_screen: bool = False) -> None:
        super().__init__(SIZE_PX, "Cubeling: study")
        self.sheet: Sheet | None = None
        """What is shown; None for nothing."""
        self._pointer = (0.0, 0.0)
        self._pressed = False
        if fills_screen:
            self.toggle_full_screen()
        end = time.monotonic() + SETTLE_S
        while time.monotonic() < end:  # what is shown before it has its place is seen later
            self.show_empty()
            self.poll()
            time.sleep(POLL_S)

    @property
    def scale(self) -> float:
        """Pixels of the window for a unit of the canvas."""
        return max(self.shown_size(*SIZE_PX)[1], 1) / SHEET_HEIGHT

    def show_sheet(self, sheet: Sheet, shown: Sequence[Picture] = ()) -> float:
        """Show a sheet, and return when it was there, by `time.monotonic` [s]."""
        self.sheet = sheet
        self.paint(sheet.draw(self.scale, shown))
        with at_first_turn():  # else the log is late by what other programs take
            self.present_now()
            return time.monotonic()

    def show_empty(self) -> None:
        """Show a sheet with nothing on it."""
        self.sheet = None
        self.paint(empty_sheet(self.scale))
        self.present_now()

    def handle_key(self, key: str, *, shift: bool = False, repeated: bool = False) -> None:
        """Hand a key on to the sheet; Esc and Q are too easily pressed to end a study."""
        if self.sheet is None:
            return
        if key == "F" and not self.sheet.takes_text:
            self.toggle_full_screen()
        else:
            self.sheet.press(key)

    def handle_character(self, character: str) -> bool:
        """Hand a character on to the sheet."""
        return self.sheet is not None and self.sheet.type(character)

    def handle_pointer(self, x: float, y: float) -> None:
        """Follow the mouse; a handle goes with it while the button is down."""
        unit = SHEET_HEIGHT / max(self._whole[1], 1)
        self._pointer = x * unit, y * unit
        if self._pressed and self.sheet is not None:
            self.sheet.drag(*self._pointer)

    def handle_button(self, pressed: bool) -> None:
        """Press what is below the mouse."""
        self._pressed = pressed
        if pressed and self.sheet is not None:
            self.sheet.click(*self._pointer)


class WindowDesk(LiveDesk):
    """Asks in a window; a `StudyDesk`. Close it after use; a second `close` does nothing.

    A window that is closed ends the study for now, as Ctrl-C does: what was answered is kept.

    Parameters
    ----------
    protocol, setup, folder
        See `LiveDesk`.
    opened
        Opens the window: again after each task, which has a window of its own.
    say
        Called with lines for the experimenter.
    """

    def __init__(
        self,
        protocol: Protocol,
        setup: TaskSetup,
        folder: Path,
        opened: Callable[[], QuestionWindow] = QuestionWindow,
        say: Callable[[str], None] = lambda line: None,
    ) -> None:
        super().__init__(protocol, setup, folder)
        self._open, self._sounds = opened, FilmSounds(say)
        self._window: QuestionWindow | None = opened()

    def __enter__(self) -> "WindowDesk":
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the window; a second call does nothing."""
        self.give_way()
        self._sounds.close()

    def tell(self, title: str, text: str) -> None:
        """Show a text until the participant goes on."""
        self._show(Sheet(title, text))

    def ask(self, step: PlannedStep, questionnaire: Questionnaire, item: Item) -> Answer:
        """Show what the question is about and the question, until there is an answer."""
        files = files_of(self._protocol, step, self._folder)
        sheet = Sheet(
            questionnaire.title,
            item=item,
            captions=captions_of(files),
            pictures=pictures_of(item, self._folder),
            patch=self._protocol.light_patch,
        )
        self._show(sheet, files)
        return sheet.answer

    def give_way(self) -> None:
        """Close the window; what is shown next opens another one."""
        if self._window is not None:
            self._window.close()
            self._window = None

    def thank(self) -> None:
        """Show that all is done, until the participant goes on."""
        self.tell("Thank you!", "You have finished.")

    def _show(self, sheet: Sheet, files: Sequence[Path] = ()) -> None:
        """Show a sheet until it is done; films begin again at their ends."""
        window = self._window = self._window or self._open()
        shown = [_Shown(file) for file in files]
        scale = window.scale
        # The onset is that of a picture that is ready: nothing is decoded while it is waited for.
        pictures = [each.picture for each in shown]
        self._sounds.prepare([each.sound for each in shown])
        if files and self._protocol.light_patch:
            window.show_empty()
            time.sleep(DARK_S)
        began = window.show_sheet(sheet, pictures)
        for place, each in enumerate(shown):
            self._sounds.play(place, len(shown), each.sound)
        since = time.monotonic() - began
        self.onset = self.now() - timedelta(seconds=since) if files else None
        try:
            while not sheet.done:
                window.poll()
                if window.closed:
                    raise KeyboardInterrupt
                elapsed = time.monotonic() - began
                moved = [each.follow(elapsed) for each in shown]
                for place, each in enumerate(shown):
                    if each.begins_again:
                        self._sounds.play(place, len(shown), each.sound)
                if any(moved) or sheet.changed or window.scale != scale:
                    scale = window.scale
                    window.show_sheet(sheet, [each.picture for each in shown])
                else:
                    time.sleep(POLL_S)
        finally:
            self._sounds.hush(len(shown))
            for each in shown:
                each.close()


class _Shown:
    """A picture, or a film of which the picture of the moment is shown."""

    def __init__(self, file: Path) -> None:
        self._file, self._frames = file, None if not is_film(file) else self._read(file)
        self._next: Frame | None = None
        self._first = self._offset = 0.0
        self.sound = np.zeros(0) if self._frames is None else sound_of(file)
        """What is heard with it, (n,) at `SAMPLE_RATE`."""
        self.begins_again = False
        """Whether a film has begun again since it was followed last."""
        if self._frames is None:
            self.picture = read_picture(file)
            """What is shown now, (height, width, 3) BGR."""
        else:
            first = next(self._frames, None)
            if first is None:
                raise AppError(f"'{file}' has no picture")
            self.picture, self._first = first.image, first.timestamp
            self._next = next(self._frames, None)

    @staticmethod
    def _read(file: Path) -> Iterator[Frame]:
        with open_source(str(file)) as source:
            yield from source

    def follow(self, elapsed: float) -> bool:
        """Take the picture of a time since the onset [s]; return whether it is another one."""
        moved = self.begins_again = False
        if self._frames is None:
            return False
        while (
            self._next is not None and self._next.timestamp - self._first <= elapsed - self._offset
        ):
            self.picture, moved = self._next.image, True
            self._next = next(self._frames, None)
        if self._next is None:  # again from its beginning, after its last picture was seen
            self._frames.close()  # type: ignore[attr-defined] # it is a generator
            self._frames, self._offset, self.begins_again = self._read(self._file), elapsed, True
            with suppress(StopIteration):
                self._next = next(self._frames)
        return moved

    def close(self) -> None:
        """Close the file of a film."""
        if self._frames is not None:
            self._frames.close()  # type: ignore[attr-defined] # it is a generator
