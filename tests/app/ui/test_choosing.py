"""The menu, and the card with a picture of each scenario."""

import numpy as np
import pytest

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.scenarios import scenario_names
from cubeling.app.ui.canvas import PICTURE_HEIGHT
from cubeling.app.ui.palette import PAPER
from cubeling.app.ui.playback.cards import draw_ending, draw_keys
from cubeling.app.ui.playback.menu import Menu
from cubeling.app.ui.playback.requests import Choose, ListChoices, Seek
from cubeling.app.ui.playback.scenario_card import ScenarioCard, _Layout
from cubeling.app.ui.playback.status import EndCard, MenuChoice
from tests.app.ui.playback_desk import desk as desk

CHOICES = (
    MenuChoice("camera", "camera:0", "camera 0", present=True),
    MenuChoice("character", "vleo", "vleo", present=True),
    MenuChoice("character", "human", "human"),
    MenuChoice("robot", "sim", "simulated robot", present=True),
)


def test_the_menu_chooses_by_key(desk):
    desk.press("Tab")
    assert desk.layer.take_requests() == (ListChoices(),)
    desk.report(looking=True)
    desk.shown()
    desk.report(choices=CHOICES[:1], looking=True)
    desk.report(choices=CHOICES)
    desk.press("→", "→", "↓", "Enter")
    assert desk.layer.take_requests() == (Choose("character", "human"),)
    desk.press("→")
    assert desk.layer.take_requests() == (Seek(5.0),), "the menu is still open"


def test_the_menu_chooses_by_mouse_and_closes_by_escape(desk):
    desk.press("Tab")
    desk.report(choices=CHOICES)
    plain = desk.shown()
    desk.layer.take_requests()
    # Four columns in the middle of the picture: the second row of the third one.
    desk.layer.click(750.0, 392.0)
    assert desk.layer.take_requests() == (Choose("character", "human"),)
    assert (desk.shown() != plain).any()
    desk.press("Tab", "Esc")
    desk.layer.click(750.0, 392.0)
    assert desk.layer.take_requests() == (ListChoices(),)
    assert desk.asked == []


def test_the_menu_lists_scenarios_too(desk):
    desk.report()
    desk.press("Tab", "↓", "Enter")
    assert desk.layer.take_requests() == (ListChoices(),)
    assert desk.layer.take_inputs() == Inputs(scenario="sketch")


def test_a_scenario_is_chosen_by_its_picture(desk):
    plain = desk.shown()
    for choose in (lambda: desk.press("2"), lambda: desk.layer.click(800.0, 300.0)):
        desk.press("0")
        assert (desk.shown() != plain).mean() > 0.2
        choose()
        assert desk.layer.take_inputs() == Inputs(scenario="sketch")
        np.testing.assert_array_equal(desk.shown(), plain)
    for close in (lambda: desk.press("Esc"), lambda: desk.layer.click(20.0, 600.0)):
        desk.press("0")
        close()
        np.testing.assert_array_equal(desk.shown(), plain)
    assert desk.layer.take_inputs() == Inputs()
    assert desk.asked == []


@pytest.mark.parametrize("count", [1, 4, 5, 9])
@pytest.mark.parametrize("width", [405.0, 960.0, 1280.0])
def test_each_scenario_has_a_place_of_its_own_on_the_card(count, width):
    card = ScenarioCard([f"scenario{number}" for number in range(count)])
    places = np.mgrid[0:720:8, 0 : int(width) : 8].reshape(2, -1).T
    found = {card.click(x, y, width) for y, x in places.tolist()}
    assert found == {None, *range(1, count + 1)}
    card.draw("scenario0", width, 1.0)  # those of broken packages, too


WIDTHS = [405.0, 960.0, 1280.0]
"""Of a picture that is upright, of 4:3 and of 16:9, in units of the canvas."""


def menu_card(width):
    menu = Menu()
    parts = ("scenario", "camera", "character", "robot")
    menu.update(tuple(MenuChoice(part, part, f"one more {part}") for part in parts), looking=False)
    return menu.draw(width, 1.0)


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize(
    "draw",
    [
        lambda width: draw_keys(width, 1.0),
        lambda width: draw_ending(
            EndCard("The end", (("Next", "cubeling " * 20),)), "", width, 1.0
        ),
        menu_card,
        lambda width: ScenarioCard(list("abcdefghi")).draw("a", width, 1.0),
    ],
    ids=["keys", "ending", "menu", "scenarios"],
)
def test_large_cards_lie_in_the_picture_with_all_their_words(draw, width):
    card = draw(width)
    left, top, right, bottom = card.box(1.0)
    assert min(left, top) >= 0.0
    assert right <= width
    assert bottom <= PICTURE_HEIGHT
    edges = (card.color[:, :5], card.color[:, -5:], card.color[:5], card.color[-5:])
    assert all((edge == PAPER).all() for edge in edges), "words are cut off"


def test_a_menu_that_is_drawn_smaller_is_chosen_from_where_it_is_seen(desk):
    menu = Menu()
    parts = ("scenario", "camera", "character", "robot")
    menu.update(tuple(MenuChoice(part, part, part) for part in parts), looking=False)
    left, top, right, bottom = menu.draw(405.0, 1.0).box(1.0)
    chosen = [
        menu.click(x, top + 0.55 * (bottom - top), 405.0) for x in np.linspace(left, right, 50)
    ]
    assert [each.part for each in dict.fromkeys(filter(None, chosen))] == list(parts)


@pytest.mark.parametrize("width", [960.0, 1280.0])
def test_what_a_bundled_scenario_is_can_be_read_to_its_end(width):
    layout = _Layout.of(scenario_names(), width)
    assert not any(line.endswith("…") for lines in layout.summaries for line in lines)
