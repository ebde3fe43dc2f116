"""A study on a page: forms for each kind of question, stimuli, answers that come twice or never."""

import asyncio
import re
import threading
from contextlib import asynccontextmanager, closing
from dataclasses import replace
from datetime import datetime

import aiohttp
import cv2
import numpy as np
import pytest

from cubeling.app.admission import Token
from cubeling.app.errors import AppError
from cubeling.app.running.pages import open_pages
from cubeling.app.workshop.study.participants import page_desk, study_log
from cubeling.app.workshop.study.participants.live_task import TaskSetup
from cubeling.app.workshop.study.participants.page_desk import PageDesk
from cubeling.app.workshop.study.participants.question_sheet import (
    MAX_TEXT_CHARS,
    question_sheet,
    text_sheet,
)
from cubeling.app.workshop.study.participants.running import run_participant
from cubeling.app.workshop.study.participants.study_log import (
    SteadyClock,
    StudyFolder,
    read_participant,
)
from cubeling.app.workshop.study.protocols.protocol_file import read_protocol
from cubeling.tracking import open_source
from tests.bench.web.camera import write_camera
from tests.bench.web.chromium import chromium, program
from tests.bench.web.serving import running

TOKEN = Token("open-sesame")

PROTOCOL = """
title = "On a page"
[[phase]]
name = "p"
parts = ["hello", "pairs", "end"]
[[instruction]]
name = "hello"
text = "Welcome <you>."
[[stimuli]]
name = "pairs"
ask = "which"
pair = "pair"
file = "shown/{member}"
[[stimuli.cross]]
pair = ["red / green"]
[[questionnaire]]
name = "which"
[[questionnaire.item]]
name = "side"
text = "Which one?"
low = -1
high = 1
anchors = ["left", "same", "right"]
[[questionnaire]]
name = "end"
[[questionnaire.item]]
name = "calm"
text = "Calm?"
kind = "slider"
low = 0
high = 1
[[questionnaire.item]]
name = "colour"
text = "Colour?"
kind = "choice"
options = ["red & blue", "green"]
[[questionnaire.item]]
name = "more"
text = "More?"
kind = "text"
"""


class Browser:
    """A page without a browser."""

    def __init__(self, root, session, socket):
        self.root, self._session, self._socket = root, session, socket
        self.number = 0

    async def get(self, path, token=TOKEN):
        """Return the status and the data of what is at a path."""
        headers = {"Authorization": f"Bearer {token.text}"}
        async with self._session.get(self.root + path, headers=headers) as answer:
            return answer.status, await answer.read()

    async def picture(self, path):
        status, data = await self.get(path)
        assert status == 200
        return np.asarray(cv2.imdecode(np.frombuffer(data, np.uint8), 1))

    async def sheet(self):
        """Return the next sheet with a form, or the last one; one may come again."""
        while True:
            message = await asyncio.wait_for(self._socket.receive(), 20.0)
            said = message.json() if message.type == aiohttp.WSMsgType.TEXT else {}
            if said.get("do") != "sheet":
                continue
            is_new = "<form" in said["html"] and said["number"] != self.number
            if is_new or said.get("over"):
                self.number = said["number"]
                return said["html"] + str(said.get("words"))

    async def send(self, answer, number=None):
        told = {"do": "answer", "id": self.number if number is None else number, "name": answer}
        await self._socket.send_json(told)

    async def answers(self, *answers):
        """Answer one sheet after the other, from the one that is shown; return the last one."""
        for answer in answers:
            await self.send(answer)
            sheet = await self.sheet()
        return sheet


@asynccontextmanager
async def browser_of(server, page="page"):
    """Open a page without a browser."""
    root = f"http://127.0.0.1:{server.ports[0]}"
    async with aiohttp.ClientSession() as session:
        url = f"{root}/socket?page={page}&role=play&attempt=1"
        async with session.ws_connect(url, protocols=("cubeling", TOKEN.text)) as socket:
            yield Browser(root, session, socket)


@pytest.fixture
def study(tmp_path):
    (tmp_path / "shown").mkdir()
    for name, colour in (("red", (0, 0, 255)), ("green", (0, 255, 0))):
        picture = np.full((8, 8, 3), colour, np.uint8)
        cv2.imwrite(str(tmp_path / "shown" / f"{name}.png"), picture)
    path = tmp_path / "x.toml"
    path.write_text(PROTOCOL)
    return StudyFolder(tmp_path / "s", read_protocol(path), path, "study")


def led(study, folder, use, expected=""):
    """Lead a participant on a page, in a thread, and use a page; return why it failed."""
    failed = []
    with closing(open_pages(token=TOKEN, study=True)) as server:
        desk = PageDesk(study.protocol, TaskSetup(), folder, server)

        def lead():
            try:
                run_participant(study.protocol, study.begin("P01", datetime(2026, 5, 4)), desk)
                desk.thank()
            except AppError as error:
                failed.append(str(error))

        thread = threading.Thread(target=lead, daemon=True)
        thread.start()
        asyncio.run(use(server))
        thread.join(timeout=10)
        assert not thread.is_alive()
    assert failed == ([expected] if expected else [])


@pytest.fixture(autouse=True)
def no_goodbye(monkeypatch):
    monkeypatch.setattr(page_desk, "GOODBYE_S", 0.2)


def test_a_participant_reads_sees_and_answers_on_a_page(study, tmp_path):
    async def use(server):
        async with browser_of(server) as browser:
            assert "Welcome &lt;you&gt;." in await browser.sheet()
            first = browser.number
            sheet = await browser.answers("")
            pictures = re.findall(r'data-from="([^"]*/\d+/\d)"', sheet)
            assert len(pictures) == 2
            colours = [(await browser.picture(each))[0, 0] for each in pictures]
            assert len({bool(colour[2] > colour[1]) for colour in colours}) == 2
            await browser.send("", first)  # sent again from the sheet before: it counts once
            assert "a number from -1 to 1, please" in await browser.answers("3")
            assert "Thank you" in await browser.answers("1", "0.25", "1", "Ünï <b>")

    led(study, tmp_path, use)
    answers = {
        each["key"]: each.get("answer") for each in read_participant(tmp_path / "s/P01").entries
    }
    assert list(answers.values()) == [None, 1.0, 0.25, "red & blue", "Ünï <b>"]


def test_no_name_of_the_protocol_stands_above_a_sheet(tmp_path):
    (tmp_path / "x.toml").write_text(ON_A_PHONE)
    protocol = read_protocol(tmp_path / "x.toml")
    questions = protocol.questionnaires["end"]
    assert "<h1" not in question_sheet(questions, questions.item[0])
    assert "<h1>You</h1>" in question_sheet(replace(questions, title="You"), questions.item[0])
    for part in (protocol.instructions["hello"], protocol.tasks["stroll"]):
        assert "<h1" not in text_sheet(part.title, part.text)
        assert "<h1>Now</h1>" in text_sheet("Now", part.text)


def test_only_who_knows_the_token_gets_stimuli_and_only_those_that_are_shown(study, tmp_path):
    async def use(server):
        async with browser_of(server) as browser:
            await browser.sheet()
            (shown, _) = re.findall(r'data-from="([^"]*)"', await browser.answers(""))
            assert (await browser.get(shown))[0] == 200
            assert (await browser.get(shown, Token("another-token")))[0] == 403
            for other in ("/shown", "/shown/1/0", f"{shown[:-1]}9", f"{shown}/../../x"):
                assert (await browser.get(other))[0] == 404
            await browser.answers("0", "0.5", "2", "")

    led(study, tmp_path, use)


def test_a_stimulus_that_is_missing_ends_the_study_in_one_line(study, tmp_path):
    (tmp_path / "shown" / "red.png").unlink()

    async def use(server):
        async with browser_of(server) as browser:
            await browser.sheet()
            await browser.send("")

    led(study, tmp_path, use, f"there is no stimulus 'shown/red' in '{tmp_path}'")


def test_a_page_that_is_closed_in_mid_question_finds_it_again(study, tmp_path):
    async def use(server):
        async with browser_of(server) as browser:
            await browser.sheet()
            question = await browser.answers("")
        async with browser_of(server, "another") as browser:
            assert await browser.sheet() == question
            await browser.answers("0", "0.5", "2", "")

    led(study, tmp_path, use)


def test_the_longest_text_fits_into_a_message(study, tmp_path):
    longest = '"' * MAX_TEXT_CHARS

    async def use(server):
        async with browser_of(server) as browser:
            await browser.sheet()
            assert "Thank you" in await browser.answers("", "0", "0.5", "2", longest)

    led(study, tmp_path, use)
    assert read_participant(tmp_path / "s/P01").entries[-1]["answer"] == longest


def test_a_clock_that_is_set_back_changes_no_duration(study, monkeypatch):
    clock = SteadyClock()
    before = clock()

    class Earlier(datetime):
        @classmethod
        def now(cls, tz=None):
            return datetime(1999, 1, 1)

    monkeypatch.setattr(study_log, "datetime", Earlier)
    assert 0.0 <= (clock() - before).total_seconds() < 60.0
    # Who answered at a later time than now, by a clock that was wrong, goes on.
    study.begin("P01", datetime(2030, 1, 1)).write({"key": "p/hello"}, datetime(2030, 1, 1))
    log = study.begin("P01", datetime(2026, 1, 1))
    assert "p/hello" not in {step.key for step in log.left}


def test_children_see_pictures_at_the_points_of_a_scale(tmp_path):
    path = tmp_path / "x.toml"
    path.write_text(PICTURES)
    study = StudyFolder(tmp_path / "s", read_protocol(path), path, "study")

    async def use(server):
        async with browser_of(server) as browser:
            pictures = re.findall(r'<label><img data-from="([^"]*)"', await browser.sheet())
            found = [(await browser.picture(each)).tobytes() for each in pictures]
            assert len({*found}) == 3
            await browser.answers("2")

    led(study, tmp_path, use)


PICTURES = """
title = "Faces"
[[phase]]
name = "p"
parts = ["liking"]
[[questionnaire]]
name = "liking"
[[questionnaire.item]]
name = "fun"
text = "Was it fun?"
high = 3
pictures = ["faces"]
"""

ON_A_PHONE = """
title = "On a phone"
[[phase]]
name = "p"
parts = ["hello", "stroll", "end"]
[[instruction]]
name = "hello"
text = "Welcome."
[[task]]
name = "stroll"
text = "Play with the cube."
scenario = "companion"
goal = { value = "mood", equals = "happy" }
limit_s = 120
ends = "person"
[[questionnaire]]
name = "end"
[[questionnaire.item]]
name = "fun"
text = "Was it fun?"
high = 3
pictures = ["faces"]
[[questionnaire.item]]
name = "calm"
text = "How calm were you?"
kind = "slider"
high = 9
"""


@pytest.mark.slow("starts a browser and a session")
@pytest.mark.full
@pytest.mark.skipif(program() is None, reason="there is no Chromium")
def test_a_phone_is_the_page_of_the_questions_the_window_and_the_camera(tmp_path):
    (tmp_path / "x.toml").write_text(ON_A_PHONE)
    write_camera(tmp_path / "camera.mjpeg", "companion", 2.0)
    command = ["study", "run", "x.toml", "-o", "s", "--participant", "P01", "--page"]
    more = ["--source", "phone", "--wizard"]

    async def use():
        async with (
            chromium(tmp_path / "camera.mjpeg") as browser,
            running(tmp_path, *command, *more) as study,
        ):
            tab = await browser.tab()
            await tab.open(study.address)
            for question in ("Welcome.", "Play with the cube."):
                await tab.until(f"$('sheet').textContent.includes({question!r})")
                assert await tab.run("stream") is None, "its camera is not open meanwhile"
                await tab.run("document.querySelector('#sheet button').click()")
            await tab.until("$('sheet').hidden && shown > 5", 60.0)
            assert await tab.run("Object.keys(bar).join()") == "turn,sound,done"
            await tab.run("say({do: 'record'}); say({do: 'play', name: 'follow'})")
            await tab.until("shown > 30", 60.0)
            assert await tab.run("session.scenario") == "companion"
            desk = await browser.tab()
            await desk.open(study.desk)
            await desk.until("!$('picture').hidden && state.playing")
            wrong = await browser.tab()
            await wrong.open(study.address.replace("/#", "/desk#"))  # with the participant's token
            await wrong.until("$('doing').textContent.includes('no longer')")
            await tab.run("done.click()")
            await tab.until("$('sheet').textContent.includes('fun?')", 60.0)
            await tab.until("!stream && sheet.querySelectorAll('img[src]').length === 3")
            await tab.run("sheet.querySelectorAll('input')[2].click()")
            await tab.run("document.querySelector('#sheet button').click()")
            await tab.until("$('sheet').textContent.includes('How calm')")
            await tab.run("document.querySelector('#sheet button').click()")
            # Nobody has touched it: its middle is no answer.
            await tab.until("$('sheet').textContent.includes('an answer is needed here')")
            await tab.run("document.querySelector('#sheet input').click()")
            await tab.run("document.querySelector('#sheet button').click()")
            await tab.until("over && $('sheet').textContent.includes('Thank you')")
            assert not [each for each in tab.log if "exception" in each]

    asyncio.run(use())
    _, task, answer, calm = read_participant(tmp_path / "s/P01").entries
    assert (answer["answer"], calm["answer"]) == (3.0, 5.0)
    assert task["ended_by"] == "person"
    assert task["played_s"] > 1.0
    with open_source(str(tmp_path / "s/P01" / task["recording"])) as frames:
        assert next(iter(frames)).encoded, "the phone's own picture"
