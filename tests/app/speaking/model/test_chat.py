"""A language model at an address: what is sent, what is said, and servers that misbehave."""

import time

import pytest
from hypothesis import given, strategies as st

from cubeling.affect import Emotion
from cubeling.app.errors import AppError
from cubeling.app.scenarios.talk import Talk
from cubeling.app.speaking.model.chat import KEY_VARIABLE, ChatModel
from cubeling.app.speaking.model.protocol import ModelError
from cubeling.app.speaking.model.tagged_reply import tagged_reply
from cubeling.characters.behaviour import MAX_LINE_CHARS
from cubeling.characters.speech import TaggedText
from tests.app.speaking.model.misbehaving import SAYS, model_server

CALM = Emotion(0.0, 0.0)
TIMEOUT_S = 0.4


def model_at(url, **settings):
    return ChatModel(url, "tiny", Talk.script, ("nod",), **settings)


def test_a_reply_keeps_its_tags_and_what_was_said_is_sent_along():
    with model_server() as server:
        model = model_at(server.url)
        model.remember("Hello! Who are you?")
        assert model.reply("why is the sky blue", CALM) == SAYS
        model.reply("and the sea", CALM)
    first, second = server.asked
    assert first["model"] == "tiny"
    assert [each["role"] for each in first["messages"]] == ["system", "assistant", "user"]
    said = [each["content"] for each in second["messages"][1:]]
    assert said == ["Hello! Who are you?", "why is the sky blue", SAYS, "and the sea"]
    assert server.keys == [None, None]


def test_the_key_comes_from_the_environment_and_is_in_no_message(monkeypatch):
    monkeypatch.setenv(KEY_VARIABLE, "s3cret")
    with model_server("no_key") as server, pytest.raises(ModelError, match="answers 401") as caught:
        model_at(server.url).reply("hello", CALM)
    assert server.keys == ["Bearer s3cret"]
    assert "s3cret" not in str(caught.value)
    monkeypatch.setenv(KEY_VARIABLE, "s3cret\nX-Evil: 1")
    with pytest.raises(AppError) as refused:
        model_at("http://127.0.0.1:1/v1")
    assert "s3cret" not in str(refused.value)


@pytest.mark.parametrize(
    ("manner", "why"),
    [
        ("number", "no chat completion"),
        ("nothing", "no chat completion"),
        ("empty", "no words"),
        ("no_choices", "no choices"),
        ("no_json", "no chat completion"),
        ("nested", "no chat completion"),
        ("broken", "answers 500"),
        ("redirect", "redirection, which is not followed"),
        ("no_http", "breaks off"),
        ("hangs_up", "cannot be reached|breaks off"),
        ("half", "no chat completion"),
        ("slow", "has not answered in 0.4 s"),
        ("endless", "has not answered in 0.4 s"),
        ("endless_header", "has not answered in 0.4 s"),
        ("huge", "more than 256 kB"),
    ],
)
def test_a_server_that_misbehaves_costs_one_line_and_a_bounded_time(manner, why):
    began = time.monotonic()
    with model_server(manner) as server:
        with pytest.raises(ModelError, match=why) as caught:
            model_at(server.url, timeout=TIMEOUT_S).reply("hello", CALM)
        assert len(server.asked) == 1, "nothing is asked twice, and no redirection followed"
    assert "\n" not in str(caught.value)
    assert time.monotonic() - began < 10 * TIMEOUT_S  # other work may slow it down


def test_a_proxy_of_the_environment_is_not_used(monkeypatch):
    monkeypatch.setenv("http_proxy", "http://127.0.0.1:1")
    with model_server() as server:
        assert model_at(server.url).reply("hello", CALM) == SAYS


def test_an_address_that_nobody_listens_at_is_one_line():
    with pytest.raises(ModelError, match="cannot be reached"):
        model_at("http://127.0.0.1:1/v1").reply("hello", CALM)


@pytest.mark.parametrize(
    "url",
    ["", "localhost:1", "ftp://x/v1", "file:///etc/passwd", "http://", "http://x:99999/v1",
     "http://me:secret@x/v1", "http://x/v1?key=1", "http://x/\n", "http://[::1/v1", "http://x:0/v1"],
)  # fmt: skip
def test_what_is_no_address_is_refused(url):
    with pytest.raises(AppError, match="--model"):
        model_at(url)


@pytest.mark.parametrize(
    ("written", "said", "note"),
    [
        (SAYS, SAYS, ""),
        ("<think>I must <b>", "", None),
        ("<think>hm</think>\n# Hello *you*", "Hello you", ""),
        ('<begin_gesture id="a" anim="explode"/>Hi<end_gesture id="a"/>!', "Hi!", "explode"),
        ('<begin_gesture id="a" anim="nod"/>Hi!', "Hi!", "do not fit"),
        ('Hi <end_gesture id="a"/>there', "Hi there", "do not fit"),
        ("a <laugh/> b", "a b", "<laugh/>"),
        ("a < b and <img", "a", "left out"),
        ("One. " * 100, ("One. " * 60).strip(), "cut"),
    ],
)
def test_what_a_model_writes_becomes_something_to_say(written, said, note):
    if note is None:
        with pytest.raises(ModelError, match="no words"):
            tagged_reply(written, ("nod",))
        return
    text, told = tagged_reply(written, ("nod",))
    assert text == said
    assert note in told
    assert bool(note) == bool(told)


@given(st.text() | st.from_regex(r"(<[a-z_/ ]*(id=\"[ab]\"|anim=\"nod\")*/?>|[ab. ])*"))
def test_whatever_a_model_writes_can_be_said_or_is_refused(written):
    try:
        text, _ = tagged_reply(written, ("nod",))
    except ModelError:
        return
    tagged = TaggedText.read(text)
    assert 0 < len(tagged.text) <= MAX_LINE_CHARS
    assert {span.name for span in tagged.spans} <= {"nod"}
    assert text.isprintable()
