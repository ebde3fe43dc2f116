"""The thesis' calls: what they write, and the example of the documents."""

import re
from pathlib import Path

import pytest

from cubeling.app.errors import AppError
from cubeling.app.show.script import read_show
from cubeling.app.show.services import PlayServices
from tests.app.show.test_show import VOICE_S, Theatre

PAGE = Path("docs/shows.md")


def example(language):
    (first, *_) = re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(), re.DOTALL)
    return first


def test_the_example_of_the_page_plays_in_the_order_of_its_calls(hand, tmp_path):
    code = example("python").replace('"my.show"', f'"{tmp_path}/my.show"')
    exec(compile(code, "shows.md", "exec"), {})
    script = read_show(tmp_path / "my.show")
    kinds = [cue.kind for cue in script.cues]
    assert kinds == ["sound", "say", "wait", "do", "wait", "stop", "say", "wait", "stop"]
    theatre = Theatre(hand, tmp_path / "my.show")
    theatre.play(40.0)
    assert theatre.over
    (creon,), (antigone,) = theatre.times(0, "speaks"), theatre.times(1, "speaks")
    (nods,) = theatre.times(1, "nod")
    assert nods == pytest.approx(creon + VOICE_S - 2.0, abs=0.1)
    assert antigone == pytest.approx(creon + VOICE_S, abs=0.2)


def test_the_file_of_the_page_is_a_play(tmp_path):
    (tmp_path / "my.show").write_text(example("xml"))
    script = read_show(tmp_path / "my.show")
    assert [each.name for each in script.cast] == ["ann", "leo"]
    assert script.cues[-2].kind == "bml"


def test_a_block_is_an_action(tmp_path):
    play = PlayServices({"ann": "human"})
    (tmp_path / "bow.bml").write_text(
        '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h"/></bml>'
    )
    play.animationService.activateAction_body("ann", "bow.bml")
    play.animationService.waitUntilActionHasFinished_body("ann", "bow.bml", 1.5)
    play.save(tmp_path / "my.show")
    block, wait, then = read_show(tmp_path / "my.show").cues
    assert (block.kind, wait.text, then.seconds) == ("bml", block.id, 1.5)


def test_what_has_not_begun_is_neither_awaited_nor_cut_off():
    play = PlayServices({"ann": "human"})
    with pytest.raises(AppError, match="'nod' of 'ann' has not begun"):
        play.animationService.cutOffAction_body("ann", "nod", 1.0)
    with pytest.raises(AppError, match="'wind' of '' has not begun"):
        play.soundService.sndmpStopMedia("wind")


def test_a_play_that_cannot_be_shown_is_named_by_line(tmp_path):
    play = PlayServices({"ann": "human"})
    play.voiceService.activateAction("bob", "Hello")
    with pytest.raises(AppError, match=r"my\.show:\d+: nobody is called 'bob'"):
        play.save(tmp_path / "my.show")
