"""The mood moves by the law of specification M11, and its label never skips neutral."""

import itertools
import math

import pytest
from hypothesis import given, strategies as st

from cubeling.affect import Feelings, Personality
from cubeling.affect.dynamics import MAX_TIME_STEP_S
from cubeling.affect.errors import AffectError
from cubeling.affect.hysteresis import Label, next_label
from cubeling.affect.impulses import AffectImpulse

FRAME_S = 1 / 30


def time_until(line: Feelings, label: Label, action, weight: float, start: float = 0.0) -> float:
    """Frames of one action until the label is reached [s]; infinite after two minutes."""
    for frame in range(int(120 / FRAME_S)):
        mood = line.update(action, weight, start + frame * FRAME_S)
        if mood.label == label:
            return frame * FRAME_S
    return math.inf


@pytest.mark.parametrize(
    ("action", "label", "weight", "seconds"),
    [
        ("kiss", "happy", 1.0, 3.3),
        ("kiss", "happy", 0.0, 6.6),
        ("kiss", "happy", -1.0, math.inf),
        ("shout", "angry", 1.0, 3.3),
        ("shout", "angry", 0.0, 6.6),
    ],
)
def test_the_way_from_neutral_takes_as_long_as_specified(action, label, weight, seconds):
    assert time_until(Feelings("thesis"), label, action, weight) == pytest.approx(
        seconds, abs=2 * FRAME_S
    )


def test_the_way_from_the_angry_extreme_to_happy_takes_13_3_seconds():
    line = Feelings("thesis")
    for frame in range(15 * 30):
        mood = line.update("shout", 1.0, frame * FRAME_S)
    assert mood.valence == -1.0
    start = 15.0
    assert time_until(line, "happy", "kiss", 1.0, start) == pytest.approx(13.3, abs=2 * FRAME_S)


@pytest.mark.parametrize("start", ["happy", "neutral", "angry"])
@pytest.mark.parametrize(
    ("action", "reaches"), [("idle", None), ("kiss", "happy"), ("shout", "angry")]
)
def test_three_actions_in_three_moods(start, action, reaches):
    line = Feelings("thesis")
    ways: dict[str, str] = {"happy": "kiss", "angry": "shout", "neutral": "idle"}
    towards = ways[start]
    mood = [line.update(towards, 1.0, frame * FRAME_S) for frame in range(150)][-1]
    assert mood.label == start
    labels = [mood.label]
    values = [mood.valence]
    for frame in range(150, 1000):
        mood = line.update(action, 1.0, frame * FRAME_S)
        labels.append(mood.label)
        values.append(mood.valence)
    assert labels[-1] == (reaches or start)
    order = [label for label, _ in itertools.groupby(labels)]
    if {start, reaches} == {"happy", "angry"}:
        assert order == [start, "neutral", reaches]
    if action == "idle":
        assert len(set(values)) == 1


actions = st.tuples(st.sampled_from(["idle", "kiss", "shout"]), st.floats(-1, 1), st.floats(0, 3))


@given(st.lists(actions, max_size=60), st.floats(0.01, 10))
def test_whatever_is_done_the_mood_stays_on_its_line_and_passes_neutral(done, gain):
    line = Feelings(
        Personality(
            "line",
            valence_half_life=math.inf,
            gains={"kiss": AffectImpulse(gain), "shout": AffectImpulse(-gain)},
            arousal="magnitude",
        )
    )
    now, before = 0.0, line.update("idle", 0, 0.0)
    for action, weight, later in done:
        now += later
        mood = line.update(action, weight, now)
        assert -1 <= mood.valence <= 1
        assert {before.label, mood.label} != {"happy", "angry"}
        assert mood.arousal == abs(mood.valence)
        if action == "idle":
            assert mood.valence == before.valence
        before = mood


def test_a_label_is_left_only_where_the_value_has_come_back_by_the_hysteresis():
    label: Label = "neutral"
    seen = []
    for value in (0.33, 0.331, 0.30, 0.281, 0.279, 0.30, -0.33, -0.331, -0.281, -0.279):
        label = next_label(label, value)
        seen.append(label)
    assert seen == ["neutral", *["happy"] * 3, *["neutral"] * 3, *["angry"] * 2, "neutral"]


def test_a_long_gap_counts_as_a_short_one():
    line = Feelings("thesis")
    line.update("kiss", 1, 0.0)
    assert line.update("kiss", 1, 60.0).valence == pytest.approx(0.1 * MAX_TIME_STEP_S)


def test_the_first_update_only_starts_the_clock():
    assert Feelings("thesis").update("kiss", 1, 1e9).valence == 0


@pytest.mark.parametrize(
    ("action", "weight", "timestamp", "says"),
    [
        ("kiss", 1.5, 1, "weight of 'kiss' must be from -1 to 1"),
        ("kiss", math.nan, 1, "weight"),
        ("kiss", 0, -1, "cannot go back"),
        ("kiss", 0, math.nan, "cannot go back"),
        ("kiss", 0, math.inf, "cannot go back"),
    ],
)
def test_nonsense_is_refused_in_one_line_and_changes_nothing(action, weight, timestamp, says):
    line = Feelings("thesis")
    line.update("idle", 0, 0.0)
    with pytest.raises(AffectError, match=says) as refusal:
        line.update(action, weight, timestamp)
    assert "\n" not in str(refusal.value)
    assert line.update("kiss", 1, 0.1).valence == pytest.approx(0.01)
