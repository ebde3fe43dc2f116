"""Acts that take over from one another turn no joint much faster than either does alone."""

import pytest

from cubeling.characters import Character
from tests.bench import takeovers

PAIRS = (
    ("WAVE", "walk"),
    ("WAVE", "idle"),
    ("walk", "run"),
    ("reach", "jump"),
    ("jump", "WAVE"),
    ("reach", "OPEN_ARMS"),
    ("script", "OPEN_ARMS"),
)


@pytest.mark.slow(reason="a body plays a dozen acts; the benchmark plays all of them")
def test_a_takeover_is_no_faster_than_the_bar(monkeypatch):
    monkeypatch.setattr(takeovers, "MOMENTS", (0.3, 0.6, 1.0))
    monkeypatch.setattr(takeovers, "ACT_S", 3.0)
    player = takeovers.Player(Character.load("human"))
    alone = {name: player.alone(name) for name in {each for pair in PAIRS for each in pair}}
    for first, second in PAIRS:
        fastest = max(alone[name][0].speed for name in (first, second))
        peak = player.takeover(second, alone[first][1])
        assert peak.speed < takeovers.MAX_RATIO * fastest, (first, second, peak)
