"""The campaign of talks finds dead ends, silence for ever and repetition."""

from dataclasses import replace

import pytest

from cubeling.app.scenarios.talk import Talk
from tests.campaigns.talk import run

SCRIPT = Talk.script


@pytest.mark.slow(reason="hundreds of turns with a whole script; the campaign takes 10,000")
def test_the_bundled_script_has_no_dead_end():
    assert not run(300, 3).failures


@pytest.mark.parametrize(
    ("without", "failure"),
    [
        (("anything",), "no answer"),
        (("silence", "offers a joke", "story"), "silence for ever"),
    ],
)
def test_a_dead_end_is_found(without, failure):
    units = tuple(each for each in SCRIPT.units if each.name not in without)
    assert len(units) == len(SCRIPT.units) - len(without)
    failures = run(150, 1, replace(SCRIPT, units=units)).failures
    assert any(each.startswith(failure) for each in failures)


def test_repetition_is_found(monkeypatch):
    from cubeling.characters.behaviour import Dialogue

    monkeypatch.setattr(Dialogue, "_choose_text", lambda self, texts, line: texts.of("en")[0])
    units = tuple(each for each in SCRIPT.units if each.name in ("anything", "silence"))
    failures = run(200, 1, replace(SCRIPT, units=units)).failures
    assert any(each.startswith("three times running") for each in failures)
