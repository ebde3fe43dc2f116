"""Settings that are changed while a scenario is played take effect at once; it plays on."""

from typing import Any

import pytest

from cubeling.affect import Personality
from cubeling.app.scenarios import Inputs, ScenarioSettings, Situation, make_scenario
from tests.app.conftest import FRAME


def made(name) -> Any:
    """Return a scenario; those of this test can all be adjusted."""
    return make_scenario(name)


def play(scenario, frames):
    return [scenario.update(controls, Situation(), Inputs()) for controls in frames]


def test_fewer_turns_change_the_intensity_faster_from_where_it_is(hand):
    scenario = made("companion")
    hand.frame(top_face="bottom")
    play(scenario, [*hand.tip("back"), *hand.turn(0.5, 1.0)])
    before = play(scenario, [hand.frame()])[0].command.weight
    scenario.adjust(ScenarioSettings(turns=1.0))
    assert play(scenario, [hand.frame()])[0].command.weight == before
    after = play(scenario, hand.turn(0.1, 1.0))[-1].command.weight
    assert after == pytest.approx(before + 0.2)


def test_another_speed_map_changes_the_speed_without_a_jump(hand):
    scenario = made("follow")
    frames = [hand.heading(90.0) for _ in range(60)]
    assert play(scenario, frames)[-1].command.speed == pytest.approx(1.75, abs=0.01)
    scenario.adjust(ScenarioSettings(speed_map="legacy"))
    outcomes = play(scenario, [hand.heading(90.0) for _ in range(60)])
    assert outcomes[0].command.speed < 1.75 + 1.8 * FRAME / 0.15
    assert outcomes[-1].command.speed == pytest.approx(3.55, abs=0.01)


@pytest.mark.parametrize("name", ["companion", "follow", "sketch"])
def test_another_personality_starts_at_its_baseline_and_the_same_one_goes_on(hand, name):
    scenario = made(name)
    own = Personality.load(scenario.personality)
    play(scenario, [hand.frame(gestures=("shaken",)), *hand.wait(0.5)])
    before = play(scenario, [hand.frame()])[0].emotion.emotion
    scenario.adjust(ScenarioSettings(personality=own))
    assert play(scenario, [hand.frame()])[0].emotion.emotion.valence == pytest.approx(
        before.valence, abs=0.02
    )
    other = Personality.load("grumpy")
    scenario.adjust(ScenarioSettings(personality=other))
    after = play(scenario, [hand.frame()])[0].emotion.emotion
    assert (after.valence, after.arousal) == pytest.approx(
        (other.temperament.valence, other.temperament.arousal), abs=0.02
    )
