"""In `reach`, what is told to the player agrees with what the character does, and with why."""

from itertools import product
from typing import get_args

import numpy as np
import pytest

from cubeling.app.scenarios.reach.catching import (
    EASY,
    HARD,
    Catching,
    Doing as CatchingDoing,
    Prospect,
)
from cubeling.app.scenarios.reach.gifts import Doing as GiftDoing
from cubeling.app.scenarios.reach.hints import facts_of, hint_of
from cubeling.app.scenarios.reach.scenario import ICONS
from cubeling.tracking import has_icon

EDGE, BODY = 0.06, 0.17

CLAIMS = {
    "Push the cube": lambda at, doing: not at["aloft"] and at["effort"] > EASY,
    "Hold the cube lower": lambda at, doing: at["aloft"] and at["effort"] > EASY,
    "down to me": lambda at, doing: at["aloft"] and at["effort"] > EASY,
    "nearer to me": lambda at, doing: not at["aloft"] and at["effort"] > HARD,
    "Move the cube a little": lambda at, doing: at["effort"] <= EASY,
    "So far": lambda at, doing: not at["aloft"] and at["effort"] > HARD,
    "So high": lambda at, doing: at["aloft"] and at["effort"] > EASY,
    "cannot reach": lambda at, doing: at["effort"] > HARD,
    "Nearly": lambda at, doing: at["effort"] <= HARD,
    "Not quite": lambda at, doing: at["effort"] <= HARD,
    "I have it": lambda at, doing: at["effort"] <= HARD and doing == "touch",
    "I come": lambda at, doing: not at["high"] and at["effort"] > EASY,
    "Now move the cube": lambda at, doing: not at["moved"],
    "Where is the cube": lambda at, doing: not at["seen"],
    "There it is!": lambda at, doing: at["seen"] or doing != "search",
    "Put the cube down": lambda at, doing: at["aloft"],
    "Leave the cube there": lambda at, doing: not at["aloft"],
}
"""What a hint says is so, by words that only such hints have. A cube that fingers hide for a moment
is not sought yet."""

ACTS = {
    "stretch": ("Push", "Hold"),
    "shrug": ("cannot reach", "Not quite"),
    "touch": ("I have it",),
    "point": ("I come",),
    "come": ("I come",),
    "sulk": ("Bring the cube", "Push", "Hold", "a little"),
    "shade": ("So high",),
    "search": ("cube", "There"),
    "cheer": ("Hooray",),
}
"""What is said of each act: one of these."""

SPENT_S = (0.0, 1.0, 60.0)
HEIGHTS = {"table": 0.03, "aloft": 0.10, "high": 0.25}
EFFORTS = (0.5 * EASY, 0.5 * (EASY + HARD), 2.0 * HARD)
GAPS = (0.0, 0.1, 0.4)


def states():
    """Yield an act, for how long, what is known of the cube, and what came before."""
    yield from product(
        get_args(CatchingDoing), SPENT_S, HEIGHTS.values(), EFFORTS, GAPS,
        (False, True), (False, True), (False, True), (False, True),
    )  # fmt: skip


def test_hint_and_act_agree_in_every_state():
    seen_hints = set()
    for doing, spent, height, effort, gap, seen, touching, moved, was_high in states():
        place = np.array([0.0, height, 0.0])
        catching = Catching()
        catching.doing, catching.since, catching.high = doing, -spent, was_high
        catching.caught = catching.gave_up_on = place + ([0.2, 0, 0] if moved else 0.0)
        catching.gave_up_at = 3.0
        prospect = Prospect(0.0, seen, place, place, effort, gap, height / BODY, touching)
        catching.update(prospect)
        facts = facts_of(catching.doing, prospect, catching, EDGE, "flag")
        hint = hint_of(facts)
        seen_hints.add(hint)
        at = {
            "aloft": height > EDGE,
            "high": catching.high,
            "effort": effort,
            "seen": seen,
            "moved": moved and not (catching.doing == "cheer" != doing),
        }
        said = [words for words in CLAIMS if words in hint]
        assert all(CLAIMS[words](at, catching.doing) for words in said), (hint, at, doing)
        asked = ACTS.get(catching.doing)
        assert asked is None or any(words in hint for words in asked), (hint, catching.doing)
    assert len(seen_hints) >= 12


@pytest.mark.parametrize("height", HEIGHTS.values())
@pytest.mark.parametrize("doing", ["hold", *get_args(GiftDoing)])
def test_what_is_said_of_a_thing_names_it_or_its_player(doing, height):
    if doing == "wait":
        return
    place = np.array([0.0, height, 0.0])
    prospect = Prospect(0.0, True, place, place, 0.5, 0.0, height / BODY, False)
    hint = hint_of(facts_of(doing, prospect, Catching(), EDGE, "flag"))
    said = [words for words in CLAIMS if words in hint]
    at = {"aloft": height > EDGE}
    assert all(CLAIMS[words](at, doing) for words in said)
    assert "flag" in hint or doing in ("give", "rejoice")


def test_every_act_has_an_icon():
    acts = {*get_args(CatchingDoing), *get_args(GiftDoing), "hold"} - {"come"}
    assert [act for act in acts if not has_icon(ICONS.get(act, act))] == []
