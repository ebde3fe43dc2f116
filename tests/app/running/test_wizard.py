"""The wizard's desk: acts with delays and errors, in the session, in its replay, and on a page."""

import asyncio
import json
import urllib.error
import urllib.request
from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.pipeline.table.acts import Act, ActNote
from cubeling.app.running.opening import open_session
from cubeling.app.running.pages import open_pages
from cubeling.app.running.replay_check import check_session
from cubeling.app.running.runner import run
from cubeling.app.running.wizard.desk import QUIET_S, DeskRequest, WizardDesk
from cubeling.app.running.wizard.plan import WizardPlan, read_wizard_plan
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.app.session.acts import wizard_acts
from cubeling.app.session.inputs import RecordedInputs
from cubeling.app.ui.screen import NullScreen
from cubeling.characters import Character
from tests.bench.web.chromium import chromium, program

PLAN = WizardPlan(cues=("greets", "shaken"), say=("Hello!",), emotions=("happy",))


class Clock:
    """A clock that is set by hand."""

    now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def desk(clock):
    with closing(open_pages()) as server:
        yield WizardDesk(server, PLAN, clock)


def played(desk, clock, session, record, asked):
    """Play a session with what a wizard asks for by the number of the frame; return the steps."""
    options = SessionOptions(
        scenario="companion", source=str(session), record=record, pictures=False, robot="sim"
    )
    steps = []

    def progress(step):
        steps.append(step)
        clock.now += 0.05
        for request in asked.get(len(steps), ()):
            assert desk.ask(request) == ""

    with open_session(options, screen=NullScreen(), instruments=(desk,)) as opened:
        run(opened, progress)
    return steps


@pytest.fixture
def performed(desk, clock, short_session, tmp_path):
    """A recorded session in which a wizard did a bit of everything."""
    asked = {
        3: (DeskRequest("cue", "greets"),),
        5: (DeskRequest("action", "shout", 0.5), DeskRequest("gesture", "NOD")),
        8: (DeskRequest("say", "Hello!"),),
        10: (DeskRequest("emotion", "happy"), DeskRequest("go", place=(0.1, 0.05))),
        14: (DeskRequest("play", "honk"),),
        20: (DeskRequest("undo", number=5), DeskRequest("undo", number=2)),
    }
    path = tmp_path / "w.mcap"
    steps = played(desk, clock, short_session, path, asked)
    return steps, path


@pytest.mark.full
@pytest.mark.slow(reason="a second of a session is played in real time, and again")
def test_a_session_performs_the_acts_again_to_the_frame(performed):
    _, path = performed
    with SessionFile(path) as session:
        result = check_session(session, session.info.options)
    assert result.identical, result.different
    assert result.counts["/character/command"] > 20


@pytest.mark.slow(reason="a second of a session is played in real time")
def test_acts_are_kept_with_their_delay_from_the_cue_and_errors(performed):
    steps, path = performed
    with SessionFile(path) as session:
        acts = {each.number: each for each in session.wizard_acts}
    first = steps[0].frame.timestamp
    assert [(each.kind, each.name, each.undone) for each in acts.values()] == [
        ("action", "shout", True),
        ("gesture", "NOD", False),
        ("say", "Hello!", False),
        ("emotion", "happy", True),
        ("go", "10, 5 cm", False),
        ("play", "honk", False),
    ]
    assert {each.cue for each in acts.values()} == {"greets"}
    assert acts[2].at_s == pytest.approx(steps[6].frame.timestamp - first)
    assert acts[2].delay_s == pytest.approx(0.10)  # two frames of 0.05 s by the desk's clock
    assert acts[7].delay_s == pytest.approx(0.55)


@pytest.mark.slow(reason="a second of a session is played in real time")
def test_character_and_robot_do_it_until_it_is_taken_back(performed):
    steps, _ = performed
    # The desk is read with the frame that follows, and that after it does it.
    shouting = [at for at, step in enumerate(steps) if step.command.activity == "shout"]
    assert shouting == list(range(6, 21))
    happy = [at for at, step in enumerate(steps) if step.emotion.emotion.word == "happy"]
    assert happy == list(range(11, 21))
    sent = [at for at, step in enumerate(steps) if _goal(step) == [0.1, 0.05]]
    assert sent == list(range(11, len(steps)))
    assert steps[8].command.behaviour is not None
    assert steps[5].command.behaviour is None
    assert any(step.line is not None and "Hello" in step.line.utterance.text for step in steps)


def _goal(step):
    going = step.command.locomotion
    return None if going is None or going.target is None else np.asarray(going.target).tolist()


def recorded(*acts):
    """What came in with frames, one act with each."""
    blank = RecordedInputs(clear=False, inside=False, speech=None, timestamp=0.0)
    return {1.0 + 0.1 * at: replace(blank, acts=(act,)) for at, act in enumerate(acts)}


def test_a_wrong_cue_takes_the_delay_of_what_answered_it():
    acts = wizard_acts(
        recorded(
            Act("cue", "a", note=ActNote(1)),
            Act("say", "x", note=ActNote(2, "a", 0.4)),
            Act("undo", note=ActNote(1)),
            Act("cue", "b", note=ActNote(3)),
            Act("say", "y", note=ActNote(4, "b", 0.6)),
            Act("say", "of another program"),
        ),
        1.0,
    )
    assert [(each.name, each.cue, each.delay_s) for each in acts] == [
        ("x", "", None),
        ("y", "b", 0.6),
    ]
    assert acts[1].at_s == pytest.approx(0.4)


def test_an_event_that_the_plan_names_is_a_cue_when_it_happens(desk, clock):
    desk._followed = clock.now
    desk.happen("shaken front", 99.5)
    desk.happen("lifted", 99.9)
    clock.now = 100.25
    assert desk.ask(DeskRequest("say", "Hello!")) == ""
    cue, say = desk._waiting
    assert (cue.kind, cue.text) == ("cue", "shaken")
    assert (say.note.cue, say.note.delay_s) == ("shaken", 0.75)


@pytest.mark.parametrize(
    ("request_", "words"),
    [
        (DeskRequest("say", ""), "1 to 500"),
        (DeskRequest("say", "x" * 501), "1 to 500"),
        (DeskRequest("say", '<begin_gesture id="a" anim="wave"/>Hi'), "never ends"),
        (DeskRequest("go", place=(3.0, 0.0)), "off the table"),
        (DeskRequest("go", "cube"), "the cube is not seen"),
        (DeskRequest("undo", number=7), "not there"),
    ],
)
def test_what_cannot_be_done_is_told_in_one_line(desk, clock, request_, words):
    desk._followed = clock.now
    assert words in desk.ask(request_)
    clock.now += QUIET_S + 1.0
    assert desk.ask(DeskRequest("say", "Hello!")) == "nothing is played now"


def test_to_the_cube_leads_beside_it_wherever_it_is(desk, clock):
    desk._followed = clock.now
    for cube, place in (([0.0, 0.0], (-0.06, 0.08)), ([0.3, -0.4], (0.234, -0.325))):
        desk._doing = {
            "cube": cube,
            "character": [-0.3, 0.4] if cube == [0.0, 0.0] else [0.0, -0.06],
        }
        assert desk.ask(DeskRequest("go", "cube")) == ""
        assert desk._waiting[-1].place == pytest.approx(place, abs=0.001)
        assert desk._waiting[-1].note.number == len(desk._waiting)


def test_the_page_is_for_who_knows_its_token_and_says_what_is_wrong(desk, clock):
    desk._followed = clock.now
    page, token = desk.addresses[0].split("#")

    def fetch(path="", data=None, token=token):
        headers = {"Authorization": f"Bearer {token}"}
        request = urllib.request.Request(page + path, data, headers)
        with urllib.request.urlopen(request, timeout=5) as reply:
            return reply.read(), reply.headers

    document, headers = fetch()
    assert b"The wizard's desk" in document
    assert "script-src 'sha256-" in headers["Content-Security-Policy"]
    state = json.loads(fetch("", b'{"do": "say", "name": "Hello!"}')[0])
    assert [act["name"] for act in state["acts"]] == ["Hello!"]
    for data in (b"{", b'{"do": "fly"}', b'{"do": "say", "more": 1}', b"\xff"):
        assert "no request" in json.loads(fetch("", data)[0])["problem"]
    for path, secret, why in (
        ("/picture", token, "404"),
        ("/x", token, "404"),
        ("/state", token[:-1], "403"),
        ("/state", "", "403"),
    ):
        with pytest.raises(urllib.error.HTTPError, match=why):
            fetch(path, token=secret)
    with pytest.raises(urllib.error.HTTPError, match="403"):
        fetch("", b'{"do": "say", "name": "Hello!"}', token="")


def test_buttons_come_from_a_file_or_from_what_the_character_can_do(tmp_path):
    path = tmp_path / "desk.toml"
    path.write_text('say = ["Hi"]\nactions = []\n[[place]]\nname = "left"\nx_cm = -10\nz_cm = 0\n')
    vleo = Character.load("vleo")
    groups = {each["kind"]: each["names"] for each in read_wizard_plan(path).buttons(vleo)}
    assert (groups["say"], groups["action"]) == (("Hi",), ())
    assert "WAVE" in groups["gesture"]
    usual = {each["kind"]: each["names"] for each in WizardPlan().buttons(vleo)}
    assert "shout" in usual["action"]
    assert "happy" in usual["emotion"]
    for text, words in (
        ('emotions = ["joyous"]', "no emotion is called 'joyous'"),
        ('[[place]]\nname = "x"\nx_cm = 500\nz_cm = 0', "off the table"),
        ("says = []", "did you mean 'say'"),
    ):
        path.write_text(text)
        with pytest.raises(AppError, match=words):
            read_wizard_plan(path)


ALL = "[...document.querySelectorAll"


@pytest.mark.slow(reason="starts a browser")
@pytest.mark.full
@pytest.mark.skipif(program() is None, reason="there is no Chromium")
def test_a_browser_has_the_buttons_and_takes_clicks_keys_and_places(desk, clock):
    vleo = Character.load("vleo")
    desk.begin([vleo])
    desk._followed = clock.now

    async def use():
        async with chromium() as browser:
            tab = await browser.tab()
            await tab.open(desk.addresses[0])
            await tab.until("document.querySelectorAll('#buttons button').length > 20")
            press = "document.dispatchEvent(new KeyboardEvent('keydown', {key: '%s'}))"
            await tab.run(press % " ")
            await tab.until("document.querySelectorAll('#acts li').length == 1")
            await tab.run(press % "1")
            await tab.until("document.querySelectorAll('#acts li').length == 2")
            await tab.run(f"{ALL}('button')].find(b => b.textContent == 'shout').click()")
            await tab.until("document.querySelectorAll('#acts li').length == 3")
            # The middle of the right half of the table: 16 cm to the right.
            await tab.run(
                "{ const b = $('table').getBoundingClientRect(); $('table').dispatchEvent("
                "new MouseEvent('click', {clientX: b.left + 0.75 * b.width, "
                "clientY: b.top + 0.5 * b.height, bubbles: true})) }"
            )
            await tab.until("document.querySelectorAll('#acts li').length == 4")
            await tab.run(
                "document.querySelectorAll('#acts li')[1].querySelector('button').click()"
            )
            await tab.until("document.querySelectorAll('#acts .undone').length == 1")
            assert not [each for each in tab.log if "exception" in each]

    asyncio.run(use())
    assert [act.kind for act in desk._waiting] == ["cue", "say", "action", "go", "undo"]
    cue, say, action, go, undo = desk._waiting
    assert (cue.text, say.text, action.text) == ("greets", "Hello!", "shout")
    assert go.place == pytest.approx((0.16, 0.0), abs=0.01)
    assert undo.note.number == action.note.number
