"""Cards leave corners in which they hide something, and come back."""

import itertools
from pathlib import Path

import numpy as np
import pytest

from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.step import Step
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.ui.cards.layout import MIN_STAY_S, SLIDING_S, CardLayout, Corner, card_box
from cubeling.tracking import open_source
from tests.app import session_parts
from tests.app.scripted import PICTURE_WIDTH, play_script
from tests.examples import some

CARDS: dict[Corner, tuple[float, float]] = {
    "bottom right": (196.0, 298.0),
    "bottom left": (292.0, 108.0),
}
WIDTH = 1280.0
CUBE = (1050.0, 500.0, 1250.0, 700.0)
"""Bottom right."""


def played(layout, subjects, start, seconds):
    """Lay the cards out for some seconds; return the corners in the end."""
    for number in range(round(seconds * 30)):
        corners = layout.update(CARDS, subjects, WIDTH, start + number / 30)
    return corners


def test_nothing_in_the_way_leaves_the_cards_where_they_are():
    middle = (500.0, 200.0, 700.0, 500.0)
    corners = played(CardLayout(), [middle], 0.0, 5.0)
    assert corners == {home: home for home in CARDS}


def test_a_card_leaves_a_corner_with_the_cube_and_moves_again_only_if_it_must():
    layout = CardLayout()
    played(layout, [], 0.0, 3.0)
    away = played(layout, [CUBE], 3.0, 2.0)["bottom right"]
    assert away in ("top right", "top left")
    assert played(layout, [], 5.0, 6.0)["bottom right"] == away  # there is no need to come back
    other = (0.0, 0.0, 250.0, 320.0) if away == "top left" else (1030.0, 0.0, 1280.0, 320.0)
    assert played(layout, [other], 11.0, 3.0)["bottom right"] != away


def test_a_cube_that_passes_by_moves_no_card():
    layout = CardLayout()
    played(layout, [], 0.0, 3.0)
    assert played(layout, [CUBE], 3.0, 0.03)["bottom right"] == "bottom right"


def test_cards_do_not_flicker():
    layout, random, changes, last = CardLayout(), np.random.default_rng(1), [], None
    for number in range(30 * 60):
        x, y = random.uniform((0, 0), (1100, 560))
        corners = layout.update(CARDS, [(x, y, x + 180, y + 160)], WIDTH, number / 30)
        assert len(set(corners.values())) == len(CARDS)
        if corners["bottom right"] != last:
            changes.append(number / 30)
            last = corners["bottom right"]
    assert np.diff(changes[1:]).min(initial=np.inf) >= MIN_STAY_S - 0.05


def overlaps(corner, size, subjects):
    x, y, end, low = card_box(corner, size, WIDTH)
    return any(
        left < end and right > x and top < low and bottom > y
        for left, top, right, bottom in subjects
    )


def subjects_of_recording(computed_session):
    """Return times and subjects of most of the bundled sketch."""
    path = str(computed_session("sketch"))
    with open_source(path) as source:
        playground = Playground("sketch", intrinsics_for(source.intrinsics, source.size))
        recorded = session_parts.replay_inputs(Path(path), "command")
        return [
            (frame.timestamp, playground.step(frame, replay=replay).subjects)
            for frame, replay in itertools.islice(zip(source, recorded, strict=True), 700)
        ]


def subjects_of_script(_):
    """Return times and subjects of the script of the bundled sketch, in pictures as large."""
    steps: list[Step] = []
    play_script("sketch", progress=steps.append, seconds=700 / 30)
    return [
        (
            step.frame.timestamp,
            [tuple(WIDTH / PICTURE_WIDTH * edge for edge in subject) for subject in step.subjects],
        )
        for step in steps
    ]


@pytest.mark.full
@pytest.mark.slow(reason="most of a session is played")
@pytest.mark.parametrize("subjects_of", some([subjects_of_script, subjects_of_recording]))
def test_in_the_bundled_sketch_cube_and_character_are_seldom_behind_a_card(
    computed_session, subjects_of
):
    layout, hidden, at_home = CardLayout(), [], []
    for time, subjects in subjects_of(computed_session):
        corners = layout.update(CARDS, subjects, WIDTH, time)
        hidden.append([overlaps(corners[home], CARDS[home], subjects) for home in CARDS])
        at_home.append([overlaps(home, CARDS[home], subjects) for home in CARDS])
    assert np.any(at_home, axis=1).mean() > 0.3  # cards that stay would hide something
    assert np.any(hidden, axis=1).mean() < 0.1


def test_a_card_slides_to_its_corner_and_never_jumps():
    layout = CardLayout()
    near, far = (24.0, 588.0, 316.0, 696.0), (964.0, 24.0, 1256.0, 132.0)
    assert layout.slide("bottom left", near, 0.0) == near[:2], "a new card is there at once"
    times = np.arange(1.0, 1.0 + 2 * SLIDING_S, 1 / 60)
    places = np.array([layout.slide("bottom left", far, time) for time in times])
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert (places[0], places[-1]) == (pytest.approx(near[:2]), pytest.approx(far[:2]))
    assert steps.max() < 0.1 * np.linalg.norm(np.subtract(far[:2], near[:2]))
    # Back again, from half way: it turns where it is.
    layout.slide("bottom left", near, 5.0)
    middle = layout.slide("bottom left", near, 5.0 + SLIDING_S / 2)
    assert layout.slide("bottom left", far, 5.0 + SLIDING_S / 2) == middle
