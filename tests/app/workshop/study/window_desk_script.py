"""Leads a scripted participant through a study in a window; `test_window_desk` runs this."""

import sys
from datetime import datetime
from pathlib import Path
from typing import ClassVar

import glfw

from cubeling.app.workshop.study.participants.live_task import TaskSetup
from cubeling.app.workshop.study.participants.running import run_participant
from cubeling.app.workshop.study.participants.study_log import StudyFolder
from cubeling.app.workshop.study.protocols.protocol_file import read_protocol
from cubeling.app.workshop.study.window.window_desk import QuestionWindow, WindowDesk


class Scripted(QuestionWindow):
    """A window in which each sheet is answered in the way that suits it; "stop" closes it."""

    answers: ClassVar[list[str]] = []

    def poll(self) -> None:
        """Process events, and answer once."""
        super().poll()
        if self.sheet is None or self.sheet.done:
            return
        answer = Scripted.answers.pop(0)
        if answer == "stop":
            self.quit()
            return
        for key in answer.split():
            if len(key) == 1 and self.sheet.takes_text:
                self._on_character(None, ord(key))
            self.handle_key(key)
        self.press(glfw.KEY_ENTER)


def main(protocol: str, *answers: str) -> None:
    """Lead a participant whose answers are keys, one argument for each sheet."""
    path = Path(protocol)
    study = StudyFolder(path.parent / "s", read_protocol(path), path, "study")
    Scripted.answers += answers
    with WindowDesk(study.protocol, TaskSetup(), path.parent, Scripted) as desk:
        run_participant(study.protocol, study.begin("P01", datetime.now()), desk)
        desk.thank()


if __name__ == "__main__":
    main(*sys.argv[1:])
