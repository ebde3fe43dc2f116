"""Words that reach a page are in its language: those of the page, and all that a session says."""

import ast
import itertools
from collections.abc import Iterator
from pathlib import Path

import pytest

from cubeling.app.pipeline.registry import scenario_names
from cubeling.app.ui.playback.scenario_card import summary_of
from cubeling.app.ui.web.language import LANGUAGES, PAGE_FOLDER, in_language, language_of
from cubeling.app.ui.web.page import document
from cubeling.toml_file import bundled
from tests.bench.web.sizes import pages

APP = Path(__file__).parents[4] / "app"

NAME = "7"
"""What stands in the tests for a name, or a number."""

SAYS = {"notify", "_wait", "English"}
"""Functions whose argument is told on pages."""

HINTS = {"_hint", "hint", "hint_of", "advice", "fault_advice", "why_it_stays"}
"""Functions that return what is told there."""

ANSWERS = "questionnaires.py"
"""Where answers to questions are refused."""

CONSTANTS = {"FOLD_IT", "HINT", "LOOK_INSIDE", "NOTHING_HEARD", "_HINTS"}
"""Constants that are."""

ELSEWHERE = (
    *("ui/playback/layer.py", "ui/window", "ui/calibration", "running/playback/transport.py"),
    *("workshop/gesture_editor", "workshop/study/window", "ui/web/language.py"),
)
"""What only a window says: keys that a page has not, and places in a recording to go to."""


def texts_of(node: ast.expr | None, names: dict[str, list[ast.expr]]) -> Iterator[str]:
    """Yield what an expression may be worth, as far as the words are in it."""
    match node:
        case ast.Constant(value=str(text)):
            yield text
        case ast.JoinedStr(values=values):
            parts = [[*texts_of(each, names)] or [NAME] for each in values]
            yield from map("".join, itertools.product(*parts))
        case ast.FormattedValue(value=value):
            yield from texts_of(value, names)
        case ast.IfExp(body=body, orelse=other):
            yield from texts_of(body, names)
            yield from texts_of(other, names)
        case ast.Name(id=name) if name in names:
            for each in names[name]:
                yield from texts_of(each, {})
        case ast.Subscript(value=ast.Dict(values=values)) | ast.Dict(values=values):
            for each in values:
                yield from texts_of(each, names)
        case ast.Call(func=ast.Name(id="English"), args=[argument]):
            yield from texts_of(argument, names)


def said_in(function: ast.AST, own: str, file: str) -> Iterator[str]:
    """Yield what a function says on pages."""
    names: dict[str, list[ast.expr]] = {}
    for node in ast.walk(function):
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            names.setdefault(node.targets[0].id, []).append(node.value)
    for node in ast.walk(function):
        match node:
            case ast.Call(func=ast.Attribute(attr=called) | ast.Name(id=called), args=[first, *_]):
                if called in SAYS:
                    yield from texts_of(first, names)
                elif called == "Notice":
                    for each in node.args:
                        yield from texts_of(each, names)
                elif called == "put" and "_notices" in ast.dump(node.func):
                    yield from texts_of(first, names)
            case ast.Raise(exc=ast.Call(args=[first])) if (file, own) == (ANSWERS, "parse"):
                yield from texts_of(first, names)
            case ast.Return(value=value) if own in HINTS:
                yield from texts_of(value, names)


def all_said() -> set[str]:
    """Return all that the code of sessions and studies says on pages."""
    found = set()
    for path in sorted(APP.rglob("*.py")):
        if path.relative_to(APP).as_posix().startswith(ELSEWHERE):
            continue
        tree = ast.parse(path.read_text())
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef):
                found |= {*said_in(node, node.name, path.name)}
            elif isinstance(node, ast.Assign):
                target = node.targets[0]
                for each in target.elts if isinstance(target, ast.Tuple) else [target]:
                    if isinstance(each, ast.Name) and each.id in CONSTANTS:
                        value = (
                            node.value.elts[0] if isinstance(node.value, ast.Tuple) else node.value
                        )
                        found |= {text.replace("{thing}", NAME) for text in texts_of(value, {})}
    return {each for each in found if any(map(str.isalpha, each))}


def test_all_that_a_session_says_on_a_page_is_known_in_spanish():
    said = all_said()
    for each in ("Show me the cube", "Playing 7", "So far! I cannot reach it", "One moment",
                 "Camera lost: plug it in again", "Look, I get the 7 for you"):  # fmt: skip
        assert each in said, "the walk finds it"
    assert len(said) > 90
    said = {each.replace("press 7 to play", "touch to play") for each in said}
    assert not [each for each in sorted(said) if in_language(each, "es").language != "es"]


def test_games_are_called_and_described_in_spanish():
    for name in scenario_names():
        for each in (name, summary_of(name)):
            assert in_language(each, "es").language == "es", each


def test_every_word_of_the_pages_is_there_in_each_language():
    for name, table in bundled(PAGE_FOLDER / "words.toml").items():
        for key, word in table.items():
            assert {*word} == {*LANGUAGES}, (name, key)
            assert type(word["en"]) is type(word["es"])
    for documents in pages().values():
        for language, found in documents.items():
            text = found.body.decode()
            assert f'<html lang="{language}">' in text
            assert "{{" not in text


def test_the_desk_refuses_in_spanish():
    tree = ast.parse((APP / "running/wizard/desk.py").read_text())
    functions = (each for each in ast.walk(tree) if isinstance(each, ast.FunctionDef))
    refusals = {
        text.replace(NAME, "500")
        for each in functions
        if each.name in ("ask", "_act", "_undo")
        for node in ast.walk(each)
        if isinstance(node, ast.Return)
        for text in texts_of(node.value, {})
        if text
    }
    assert len(refusals) == 6
    assert refusals <= {*bundled(PAGE_FOLDER / "words.toml")["desk"]["words"]["es"]}


@pytest.mark.parametrize("accepted", ["es-MX,es;q=0.9,en;q=0.8", "es", "fr,es;q=0.5"])
def test_a_browser_gets_the_page_in_its_language(accepted):
    assert language_of(accepted) == "es"
    assert (
        "He terminado"
        in document("study.html", [], [], ["view", "page", "study"])["es"].body.decode()
    )
