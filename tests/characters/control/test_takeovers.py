"""Acts that take over from one another turn no joint much faster than either does alone."""

import pytest

from cubeling.characters import Character
from tests.bench import takeovers
from tests.examples import some

PAIRS = (
    ("WAVE", "walk"),
    ("reach", "OPEN_ARMS"),
    ("walk", "run"),
    ("WAVE", "idle"),
    ("reach", "jump"),
    ("jump", "WAVE"),
    ("script", "OPEN_ARMS"),
)


@pytest.fixture(scope="module")
def player():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(takeovers, "MOMENTS", (0.3, 0.6, 1.0))
        patch.setattr(takeovers, "ACT_S", 3.0)
        yield takeovers.Player(Character.load("human"))


@pytest.mark.slow(reason="a body plays two acts; the benchmark plays all of them")
@pytest.mark.parametrize(("first", "second"), some(PAIRS, 2))
def test_a_takeover_is_no_faster_than_the_bar(player, first, second):
    alone = {name: player.alone(name) for name in (first, second)}
    fastest = max(peak.speed for peak, _ in alone.values())
    peak = player.takeover(second, alone[first][1])
    assert peak.speed < takeovers.MAX_RATIO * fastest, peak


@pytest.mark.slow(reason="a body plays two gestures")
def test_a_gesture_in_the_place_of_another_one_takes_as_long_as_its_way(player):
    alone = {name: player.alone(name) for name in ("OPEN_ARMS", "script")}
    fastest = max(peak.speed for peak, _ in alone.values())
    peak = player.takeover("script", alone["OPEN_ARMS"][1])
    assert peak.speed < 1.12 * fastest, peak  # 1.18 in the time that it takes from rest
