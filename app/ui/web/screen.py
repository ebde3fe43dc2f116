"""The screen of a session in browsers."""

import re
import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from datetime import datetime
from pathlib import Path

import cv2
import numpy as np

from cubeling.app.pipeline.registry import scenario_names
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import RobotView, Step
from cubeling.app.ui.cards.hint_reader import HintReader
from cubeling.app.ui.cards.layout import CardLayout
from cubeling.app.ui.cards.overlay import overlay, virtual_robot_side
from cubeling.app.ui.cards.shown_step import shown_step
from cubeling.app.ui.cards.virtual_robot import VirtualRobot
from cubeling.app.ui.notice import Notice
from cubeling.app.ui.playback.requests import Choose, MarkMoment, Record, SessionRequest
from cubeling.app.ui.playback.snapshot import keep_snapshot
from cubeling.app.ui.playback.status import SessionStatus
from cubeling.app.ui.playback.typing_field import MAX_TYPED
from cubeling.app.ui.web.client import CARDS
from cubeling.app.ui.web.language import LANGUAGES, English, in_language
from cubeling.app.ui.web.messages import Said
from cubeling.app.ui.web.picture import PagePicture, Picture, PictureEncoder, cut_out
from cubeling.app.ui.web.server import WebServer

REPORT_S = 0.5
"""How often the pages are told that nothing has changed [s]."""

RETRY_S = 2.0
"""How often another camera is asked for [s], as long as a recording keeps the present one."""

KEY_TO_PRESS = re.compile(r"press \d+ to play (\w+)")
"""What a hint says of a key, as of `other_cube.advice`: a page has a picture to touch instead."""


class WebScreen:
    """A `Screen` on the pages of a server, which its caller closes, as the virtual robot.

    Parameters
    ----------
    server
        Where the pages are.
    camera_uri
        Returns the URI of the camera that the pages have now; "" for none.
    folder
        Where snapshots go.
    virtual_robot
        Shown if there is no real robot.
    clock
        Returns the time [s].
    handlers
        What players may ask for; None for `HANDLERS`.
    """

    attended = True

    def __init__(
        self,
        server: WebServer,
        camera_uri: Callable[[], str],
        folder: Path,
        virtual_robot: VirtualRobot | None = None,
        clock: Callable[[], float] = time.monotonic,
        handlers: "Mapping[str, Handler] | None" = None,
    ) -> None:
        self.closed = False
        self._handlers = HANDLERS if handlers is None else handlers
        self._server, self._camera_uri, self._folder = server, camera_uri, folder
        self._virtual_robot, self._clock = virtual_robot, clock
        self._scenarios = scenario_names()
        self._encoder = PictureEncoder(server.show)
        self._layout, self._hint_reader = CardLayout(), HintReader()
        self._inputs = Inputs()
        self._mirrored = False
        self._shown: tuple[Step, RobotView] | None = None
        self._number = 0
        self._status = SessionStatus()
        self._told: dict[str, object] = {}
        self._told_at = self._asked_at = -float("inf")
        self._notice: Notice | None = None
        self._offer = ""

    def show(self, step: Step, robot: RobotView) -> Inputs:
        """Show a step on all pages, and return what players ask of the scenario."""
        self._notice = None
        step = self._without_keys(self._hint_reader.update(step))
        self._shown = step, robot
        wanted = self._server.wanted
        if step.picture is not None and wanted:
            self._number += 1
            page = PagePicture(self._number, *self._server.taken_by(step.frame.encoded))
            self._encoder.encode(page, self._pictures({kind for kind, _ in wanted}), wanted)
        inputs, self._inputs = self._inputs, Inputs()
        return inputs

    def preview(self, step: Step, robot: RobotView) -> None:
        """Show a step on the way to another one."""
        self.show(step, robot)

    def wait(self, notice: Notice | None) -> None:
        """Tell the pages why no frame comes."""
        self._notice = notice
        self._tell()

    def take_requests(self) -> tuple[SessionRequest, ...]:
        """Return what players ask of the session; another camera, if they have another one."""
        requests: list[SessionRequest] = []
        for said in self._server.take_requests():
            if said.do in self._handlers:
                requests += self._handlers[said.do](self, said)
        camera, now = self._camera_uri(), self._clock()
        if camera and camera != self._status.source and now - self._asked_at > RETRY_S:
            self._asked_at = now
            requests.append(Choose("camera", camera))
        return tuple(requests)

    def report(self, status: SessionStatus) -> None:
        """Tell the pages the state of the session."""
        self._status = status
        self._server.keeps_camera = status.recorded
        self._tell()

    def notify(self, words: str) -> None:
        """Show a notice on the pages for some seconds."""
        camera = self._camera_uri()
        if not camera or camera not in words:  # who plays knows which phone it is
            self._server.say(words)

    def close(self) -> None:
        """Show nothing any more; a second call does nothing."""
        self._encoder.close()

    def _without_keys(self, step: Step) -> Step:
        """Return a step whose hint says what to touch; keep which scenario that is."""
        found = KEY_TO_PRESS.search(step.outcome.hint)
        self._offer = "" if found is None else found[1]
        if found is None:
            return step
        hint = KEY_TO_PRESS.sub(r"touch to play \1", step.outcome.hint)
        return replace(step, outcome=replace(step.outcome, hint=hint))

    def _pictures(self, wanted: Collection[str]) -> dict[str, Picture]:
        """Return the last step as the pages want to see it."""
        assert self._shown is not None
        step, robot = self._shown
        assert step.picture is not None
        pictures: dict[str, Picture] = {}
        for language in (each for each in LANGUAGES if f"{CARDS}{each}" in wanted):
            hint = in_language(step.outcome.hint, language).words
            told = replace(step, outcome=replace(step.outcome, hint=hint))
            pictures[f"{CARDS}{language}"] = self._with_cards(told, robot)
        if "plain" in wanted:
            pictures["plain"] = self._seen(step.picture)
        if "cutout" in wanted:
            pictures["cutout"] = self._seen(cut_out(step.picture, step.frame.image))
        return pictures

    def _seen(self, picture: Picture) -> Picture:
        """Return a copy of a picture, perhaps as in a mirror."""
        return np.asarray(cv2.flip(picture, 1), np.uint8) if self._mirrored else picture.copy()

    def _with_cards(self, step: Step, robot: RobotView) -> Picture:
        assert step.picture is not None
        picture = self._seen(step.picture)
        shown = shown_step(step, 1.0, self._mirrored)
        if self._virtual_robot is not None:
            self._virtual_robot.fit(virtual_robot_side(picture.shape[0]))
        return overlay(picture, shown, robot, self._virtual_robot, self._layout)

    def _tell(self) -> None:
        status, notice, now = self._status, self._notice, self._clock()
        told: dict[str, object] = {
            "scenario": status.scenario,
            "recording": status.recording,
            "title": English(status.scenario),
            "listens": status.listens,
            "notice": None if notice is None else [English(notice.title), English(notice.advice)],
            "offer": self._offer,
            "hint": English("" if self._shown is None else self._shown[0].outcome.hint),
        }
        recording = status.recording is not None
        known = {**told, "recording": recording} == {
            **self._told, "recording": self._told.get("recording") is not None
        }  # fmt: skip
        if not known or now - self._told_at >= REPORT_S:
            self._told, self._told_at = told, now
            self._server.tell("status", **told)

    def _play(self, said: Said) -> tuple[SessionRequest, ...]:
        if said.name in self._scenarios:
            self._inputs = replace(self._inputs, scenario=said.name)
        return ()

    def _again(self, _: Said) -> tuple[SessionRequest, ...]:
        self._inputs = replace(self._inputs, clear=True)
        return ()

    def _snapshot(self, _: Said) -> tuple[SessionRequest, ...]:
        if self._shown is not None and self._shown[0].picture is not None:
            picture = self._with_cards(*self._shown)
            self.notify(keep_snapshot(self._folder, self._status.scenario, picture, datetime.now()))
        return ()

    def _type(self, said: Said) -> tuple[SessionRequest, ...]:
        if self._status.listens:
            printed = "".join(each if each.isprintable() else " " for each in said.name[:MAX_TYPED])
            text = " ".join(f"{self._inputs.typed} {printed}".split())
            self._inputs = replace(self._inputs, typed=text, hush=True)
        return ()

    def _mirror(self, said: Said) -> tuple[SessionRequest, ...]:
        self._mirrored = said.mirror
        return ()

    def _done(self, _: Said) -> tuple[SessionRequest, ...]:
        self.closed = True
        return ()


Handler = Callable[[WebScreen, Said], tuple[SessionRequest, ...]]
"""Carries out a request of a page."""

HANDLERS: Mapping[str, Handler] = {
    "play": WebScreen._play,
    "again": WebScreen._again,
    "snapshot": WebScreen._snapshot,
    "camera": WebScreen._mirror,
    "record": lambda screen, said: (Record(),),
    "mark": lambda screen, said: (MarkMoment(),),
    "type": WebScreen._type,
}
"""What carries out each request of a page."""

STUDY_HANDLERS: Mapping[str, Handler] = {"camera": WebScreen._mirror, "done": WebScreen._done}
"""The same in a study, whose participants choose nothing, but may end a task that says so."""
