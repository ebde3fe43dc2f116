"""A study on a page: forms for each kind of question, stimuli, answers that come twice or never."""

import re
import socket
import threading
import urllib.error
import urllib.parse
import urllib.request
from contextlib import contextmanager
from datetime import datetime

import cv2
import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.ui.local_pages import LocalPages
from cubeling.app.workshop.study.participants import study_log
from cubeling.app.workshop.study.participants.live_task import TaskSetup
from cubeling.app.workshop.study.participants.page_desk import PageDesk
from cubeling.app.workshop.study.participants.running import run_participant
from cubeling.app.workshop.study.participants.study_log import (
    SteadyClock,
    StudyFolder,
    read_participant,
)
from cubeling.app.workshop.study.protocols.protocol_file import read_protocol

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
    """Fetches pages, and sends their forms."""

    def __init__(self, address):
        self.address = address

    def get(self, path="", **headers):
        request = urllib.request.Request(self.address + path, headers=headers)
        with urllib.request.urlopen(request, timeout=5) as reply:
            return reply.read()

    def page(self):
        """Return the page with a form, once there is one."""
        for _ in range(100):
            page = self.get().decode()
            if "<form" in page or "Thank" in page:
                return page
            threading.Event().wait(0.05)
        raise AssertionError(page)

    def send(self, answer, number=None):
        numbers = [number] if number else re.findall(r'name="number" value="(\d+)"', self.page())
        number = numbers[0]
        data = urllib.parse.urlencode({"number": number, "answer": answer}).encode()
        with urllib.request.urlopen(self.address, data, timeout=5) as reply:
            reply.read()
        return number


@pytest.fixture
def study(tmp_path):
    (tmp_path / "shown").mkdir()
    for name, colour in (("red", (0, 0, 255)), ("green", (0, 255, 0))):
        picture = np.full((8, 8, 3), colour, np.uint8)
        cv2.imwrite(str(tmp_path / "shown" / f"{name}.png"), picture)
    path = tmp_path / "x.toml"
    path.write_text(PROTOCOL)
    return StudyFolder(tmp_path / "s", read_protocol(path), path, "study")


@contextmanager
def led(study, folder):
    """Lead a participant on a page, in a thread; yield a browser."""
    pages = LocalPages()
    desk = PageDesk(study.protocol, TaskSetup(), folder, pages)
    failed = []

    def lead():
        try:
            run_participant(study.protocol, study.begin("P01", datetime(2026, 5, 4)), desk)
            desk.thank()
        except AppError as error:
            failed.append(error)

    thread = threading.Thread(target=lead, daemon=True)
    thread.start()
    try:
        yield Browser(desk.address), failed
        thread.join(timeout=5)
        assert not thread.is_alive()
    finally:
        pages.close()
        pages.close()


def test_a_participant_reads_sees_and_answers_on_a_page(study, tmp_path):
    with led(study, tmp_path) as (browser, _):
        assert "Welcome &lt;you&gt;." in browser.page()
        first = browser.send("")
        page = browser.page()
        pictures = re.findall(r'src="[^"]*(/\d+/\d)"', page)
        assert len(pictures) == 2
        (step,) = (s for s in study.begin("P02", datetime(2026, 5, 4)).plan if s.item == "side")
        decoded = [cv2.imdecode(np.frombuffer(browser.get(p), np.uint8), 1) for p in pictures]
        colours = [np.asarray(each)[0, 0] for each in decoded]
        reds = [bool(colour[2] > colour[1]) for colour in colours]
        assert len(set(reds)) == 2
        assert len(step.stimulus) == 1
        browser.send("", first)  # sent again from the page before: it counts once
        browser.send("3")
        assert "a number from -1 to 1, please" in browser.page()
        browser.send("1")
        browser.send("0.25")
        browser.send("1")
        browser.send("Ünï <b>")
        assert "Thank you" in browser.page()
    answers = {
        each["key"]: each.get("answer") for each in read_participant(tmp_path / "s/P01").entries
    }
    assert list(answers.values()) == [None, 1.0, 0.25, "red & blue", "Ünï <b>"]


def test_only_who_knows_the_address_gets_anything(study, tmp_path):
    with led(study, tmp_path) as (browser, _):
        browser.page()
        good = browser.address
        for wrong in (good[:-1], good.rpartition("/")[0] + "/", f"{good}/1/0", f"{good}/../x"):
            browser.address = wrong
            with pytest.raises(urllib.error.HTTPError, match="404"):
                browser.get()
        browser.address = good
        with pytest.raises(urllib.error.HTTPError, match="404"):
            browser.get(Host="evil.example:80")
        with pytest.raises(urllib.error.HTTPError, match="413"):
            browser.send("x" * 70_000)
        for answer in ("", "0", "0.5", "2", ""):
            browser.send(answer)


def test_a_stimulus_that_is_missing_ends_the_study_in_one_line(study, tmp_path):
    (tmp_path / "shown" / "red.png").unlink()
    with led(study, tmp_path) as (browser, failed):
        browser.send("")
    assert str(failed[0]) == f"there is no stimulus 'shown/red' in '{tmp_path}'"


def test_a_browser_that_closes_while_it_answers_answers_nothing(study, tmp_path, capfd):
    with led(study, tmp_path) as (browser, _):
        number = browser.send("")
        host, _, path = browser.address.removeprefix("http://").partition("/")
        question = re.findall(r'name="number" value="(\d+)"', browser.page())[0]
        assert question != number
        with socket.create_connection(tuple(host.split(":"))) as half:
            head = f"POST /{path} HTTP/1.1\r\nHost: {host}\r\nContent-Length: 60\r\n\r\n"
            half.sendall(f"{head}number={question}&answer=1".encode())
        assert f'value="{question}"' in browser.page()  # it still waits, and goes on
        for answer in ("0", "0.5", "2", ""):
            browser.send(answer)
    assert "Traceback" not in capfd.readouterr().err


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
    with led(study, tmp_path) as (browser, _):
        pictures = re.findall(r'<label><img src="[^"]*(/\d+/\d)"', browser.page())
        decoded = [cv2.imdecode(np.frombuffer(browser.get(p), np.uint8), 1) for p in pictures]
        assert len({np.asarray(each).tobytes() for each in decoded}) == 3
        browser.send("2")


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
