"""`cubeling talk`: in the terminal, and what it refuses."""

import io

import pytest

LINES = "Hi, I am Ana\n\nwhat is my name?\n¿Cómo te llamas?\nxyzzy\n"


def test_a_talk_in_the_terminal(cubeling, monkeypatch):
    monkeypatch.setattr("sys.stdin", io.StringIO(LINES))
    code, said, errors = cubeling("talk")
    assert (code, errors) == (0, "")
    greeting, *answers = said.splitlines()
    assert "Vleo" in greeting
    assert len(answers) == 4
    assert "Ana" in answers[1]
    assert "Vleo" in answers[2]
    assert "<" not in said


def test_lines_of_a_file(cubeling, tmp_path):
    (tmp_path / "lines.txt").write_text("hello\nbye\n")
    code, said, _ = cubeling("talk", "--typed", "lines.txt", "--only-text", "--language", "es")
    assert code == 0
    assert len(said.splitlines()) == 3
    assert "dinosaurio" in said.splitlines()[0]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("hello.txt",), "'hello.txt' is no dialogue: give an .xml file"),
        (("gone.xml",), "cannot read the script 'gone.xml': No such file"),
        (("broken.xml",), "broken.xml:1: a dialogue without a unit"),
        (("--typed", "gone.txt"), "gone.txt"),
        (("--language", "fr"), "does not speak 'fr'"),
        (("-o", "film.xyz"), "film.xyz"),
        (("--character", "nobody"), "nobody"),
    ],
)
def test_what_cannot_be_talked_is_one_line(cubeling, tmp_path, arguments, message):
    (tmp_path / "broken.xml").write_text("<dialogue/>")
    code, _, errors = cubeling("talk", *arguments)
    assert code == 2
    assert message in errors
    assert len(errors.splitlines()) == 1


@pytest.mark.parametrize(
    "command", [("play", "talk"), ("show", "antigone"), ("serve",), ("talk", "--only-text")]
)
def test_a_model_is_named_in_every_command_that_plays(cubeling, command):
    code, _, errors = cubeling(*command, "--model", "localhost")
    assert code == 2
    assert "--model localhost: give an address such as http" in errors
    assert len(errors.splitlines()) == 1


def test_a_model_that_nobody_would_ask_is_refused(cubeling):
    asked = ("--record", "x.mcap", "--model", "http://127.0.0.1:9/v1")
    code, _, errors = cubeling("show", "antigone", *asked)
    assert code == 2
    assert "nobody answers in" in errors
    assert len(errors.splitlines()) == 1
