"""The screen on pages: what players ask for, other cameras, and pictures for each kind of page."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cubeling.app.pipeline.cubes.other_cube import advice
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import RobotView
from cubeling.app.ui.playback.requests import Choose, MarkMoment, Record
from cubeling.app.ui.playback.status import SessionStatus
from cubeling.app.ui.web.messages import read_said
from cubeling.app.ui.web.screen import RETRY_S, WebScreen
from cubeling.tracking import CubeModel

ROBOT = RobotView("none", 0.0, "neutral")


class Pages:
    """The server of the pages, as far as a screen sees it."""

    def __init__(self):
        self.wanted: frozenset[tuple[str, int]] = frozenset()
        self.asked, self.words, self.statuses, self.shown = [], [], [], []

    def show(self, picture):
        self.shown.append(picture)

    def take_requests(self):
        asked, self.asked = self.asked, []
        return [read_said(each) for each in asked]

    def taken_by(self, jpeg):
        return ("page", 12.5)

    def tell(self, do, **status):
        self.statuses.append(status)

    def say(self, words):
        self.words.append(words)


@pytest.fixture
def desk(tmp_path):
    """Yield a screen, its pages, its camera's URI in a list, and its clock in another one."""
    pages: Any = Pages()
    camera, now = [""], [100.0]
    screen = WebScreen(pages, lambda: camera[0], tmp_path, clock=lambda: now[0])
    yield SimpleNamespace(screen=screen, pages=pages, camera=camera, now=now, folder=tmp_path)
    screen.close()


@dataclass
class Hinting:
    """As much of a decision as a screen without cards looks at."""

    hint: str


@dataclass
class Stepped:
    """The same of a step."""

    picture: Any
    frame: Any
    outcome: Hinting
    state: Any


def step_of(picture, hint=""):
    frame = SimpleNamespace(encoded=b"", image=np.zeros_like(picture), timestamp=1.0)
    return Stepped(picture, frame, Hinting(hint), SimpleNamespace(visible=True))


def test_what_is_touched_reaches_the_scenario_and_the_session(desk):
    desk.pages.asked = [
        '{"do":"play","name":"follow"}',
        '{"do":"play","name":"/etc/passwd"}',
        '{"do":"again"}',
        '{"do":"record"}',
        '{"do":"mark"}',
    ]
    assert desk.screen.take_requests() == (Record(), MarkMoment())
    picture = np.zeros((8, 8, 3), np.uint8)
    assert desk.screen.show(step_of(picture), ROBOT) == Inputs(clear=True, scenario="follow")
    assert desk.screen.show(step_of(picture), ROBOT) == Inputs()


def test_what_is_typed_is_said_where_somebody_listens(desk):
    picture = np.zeros((8, 8, 3), np.uint8)
    desk.pages.asked = ['{"do":"type","name":"Hello"}']
    assert desk.screen.take_requests() == ()
    assert desk.screen.show(step_of(picture), ROBOT) == Inputs(), (
        "a recording holds what has effect"
    )
    desk.screen.report(SessionStatus(listens=True))
    desk.pages.asked = [
        '{"do":"type"}',
        '{"do":"type","name":" Do\\nyou "}',
        '{"do":"type","name":"sing?"}',
    ]
    assert desk.screen.take_requests() == ()
    assert desk.screen.show(step_of(picture), ROBOT) == Inputs(typed="Do you sing?", hush=True)
    assert desk.pages.statuses[-1]["listens"]


def test_another_camera_is_asked_for_until_the_session_has_it(desk):
    desk.screen.report(SessionStatus(source="phone:ab?size=720x1280"))
    assert desk.screen.take_requests() == ()
    desk.camera[0] = "phone:ab?size=1280x720"
    assert desk.screen.take_requests() == (Choose("camera", "phone:ab?size=1280x720"),)
    assert desk.screen.take_requests() == (), "not again and again"
    desk.now[0] += RETRY_S + 0.1
    assert len(desk.screen.take_requests()) == 1
    desk.now[0] += RETRY_S + 0.1
    desk.screen.report(SessionStatus(source="phone:ab?size=1280x720"))
    assert desk.screen.take_requests() == ()


def test_players_are_told_of_all_but_of_the_phone_in_their_hand(desk):
    desk.camera[0] = "phone:ab?size=1280x720"
    desk.screen.notify("The camera is now phone:ab?size=1280x720")
    desk.screen.notify("Playing follow")
    assert desk.pages.words == ["Playing follow"]


def test_a_cube_of_another_game_offers_that_game_to_be_touched(desk):
    hint = advice(CubeModel.load("locomotion"), "companion", "companion", fixed=False)
    desk.screen.show(step_of(np.zeros((8, 8, 3), np.uint8), hint), ROBOT)
    desk.screen.report(SessionStatus(scenario="companion"))
    assert desk.pages.statuses[-1]["offer"] == "follow"
    assert desk.pages.statuses[-1]["hint"].endswith("touch to play follow")


def test_pages_that_view_get_the_picture_alone_mirrored_as_asked(desk):
    rng = np.random.default_rng(3)
    picture = rng.integers(0, 255, (36, 64, 3), np.uint8)
    step = step_of(picture)
    desk.pages.wanted = frozenset({("plain", 0)})
    desk.pages.asked = ['{"do":"camera","name":"ab-front","mirror":true}']
    desk.screen.take_requests()
    desk.screen.show(step, ROBOT)
    (plain,) = desk.screen._pictures(frozenset({"plain"})).values()
    assert (plain == picture[:, ::-1]).all()
    (cut,) = desk.screen._pictures(frozenset({"cutout"})).values()
    assert cut.shape == (36, 64, 4)
    assert (step.picture == picture).all(), "the step's own picture stays"


def test_pages_are_told_that_nothing_has_changed_twice_a_second_only(desk):
    for _ in range(10):
        desk.screen.report(SessionStatus(scenario="follow"))
    assert len(desk.pages.statuses) == 1
    desk.screen.report(SessionStatus(scenario="follow", recording=1.0))
    assert len(desk.pages.statuses) == 2
    desk.now[0] += 0.6
    desk.screen.report(SessionStatus(scenario="follow", recording=1.5))
    assert desk.pages.statuses[-1] == {
        "scenario": "follow", "title": "follow", "recording": 1.5, "notice": None, "offer": "",
        "hint": "", "listens": False,
    }  # fmt: skip
