"""Sync points are where constraints want them; what cannot be is left out."""

import pytest

from cubeling.characters.behaviour.bml import BlockPrediction, BmlWarning, Realizer
from cubeling.characters.behaviour.bml.parser import MAX_BEHAVIOURS, MAX_TIED
from cubeling.characters.behaviour.bml.realizer import MAX_BLOCKS, MAX_LOAD
from cubeling.characters.behaviour.bml.schedule import MAX_ATTEMPTS
from tests.characters.behaviour.bml.estimates import Estimates
from tests.characters.behaviour.bml.suite import block

SPEECH = "<speech id='s'><text>one two three <sync id='m'/>four five</text></speech>"


def schedule(inside: str, now: float = 100.0) -> tuple[dict[str, float], list[BmlWarning]]:
    """Return block times by "behaviour:sync", and warnings."""
    realizer = Realizer(Estimates())
    realizer.accept(block(inside))
    feedback = realizer.update(now)
    times = {
        f"{behaviour.id}:{sync}": time
        for prediction in feedback
        if isinstance(prediction, BlockPrediction)
        for behaviour in prediction.behaviours
        for sync, time in behaviour.times
    }
    return times, [f for f in feedback if isinstance(f, BmlWarning)]


def dropped(inside: str) -> set[str]:
    times, warnings = schedule(inside)
    gone = {warning.id.removeprefix("bml1:") for warning in warnings}
    assert not {key.split(":")[0] for key in times} & gone
    return gone


def test_free_behaviours_start_with_the_block_at_their_own_pace():
    times, _ = schedule("<gesture id='g'/><gaze id='z'/>")
    assert times["g:start"] == times["z:start"] == 0.0
    assert times["g:stroke"] == pytest.approx(0.7)
    assert times["z:end"] == pytest.approx(1.4)


def test_a_stroke_falls_on_the_word_that_it_names():
    times, _ = schedule(SPEECH + "<gesture id='g' stroke='s:m'/>")
    assert times["g:stroke"] == pytest.approx(times["s:m"], abs=1e-9)
    assert times["s:start"] == 0.0


def test_speech_waits_for_the_preparation_of_its_gesture():
    times, _ = schedule("<speech id='s'><text><sync id='m'/>one</text></speech>"
                        "<gesture id='g' stroke='s:m'/>")  # fmt: skip
    assert times["g:start"] == 0.0
    assert times["s:start"] == pytest.approx(0.7)


def test_preparation_is_shortened_where_speech_cannot_wait():
    times, warnings = schedule("<speech id='s' start='0.4'><text><sync id='m'/>one</text></speech>"
                               "<gesture id='g' stroke='s:m'/>")  # fmt: skip
    assert not warnings
    assert times["g:start"] == pytest.approx(0.0)
    assert times["g:stroke"] == pytest.approx(0.4)


def test_a_hold_takes_the_time_that_is_left():
    times, _ = schedule("<gaze id='z' start='1' end='10'/>")
    assert times["z:ready"] == pytest.approx(1.2)
    assert times["z:relax"] == pytest.approx(9.8)


def test_a_behaviour_may_say_how_long_it_takes():
    times, _ = schedule(SPEECH + "<gaze id='z' start='s:m' end='z:start+3'/>")
    assert times["z:end"] - times["s:m"] == pytest.approx(3.0)
    times, _ = schedule("<gaze id='z' relax='z:ready+3'/>")
    assert times["z:relax"] - times["z:ready"] == pytest.approx(3.0)


def test_clusters_that_a_behaviour_links_keep_its_pace():
    times, _ = schedule("<gesture id='a'/><speech id='s'><text>one</text></speech>"
                        "<head id='n' start='a:stroke' end='s:start'/>")  # fmt: skip
    assert times["n:start"] == pytest.approx(times["a:stroke"])
    assert times["n:end"] - times["n:start"] == pytest.approx(0.7)


@pytest.mark.parametrize("swap", [False, True])
def test_the_order_of_the_document_does_not_matter(swap):
    parts = [SPEECH, "<head id='n' start='s:m' end='9'/>", "<gesture id='g' end='n:start'/>"]
    times, warnings = schedule("".join(reversed(parts) if swap else parts))
    assert not warnings
    assert times["n:start"] == pytest.approx(times["s:m"])
    assert times["g:end"] == pytest.approx(times["n:start"])


def test_before_and_after_move_what_is_free():
    rule = "<constraint><{0} ref='{1}'><sync ref='{2}'/></{0}></constraint>"
    times, warnings = schedule(SPEECH + "<head id='n'/>" + rule.format("after", "s:end", "n:start"))
    assert not warnings
    assert times["n:start"] >= times["s:end"] - 1e-6
    times, warnings = schedule(
        SPEECH + "<gaze id='z' start='0'/>" + rule.format("before", "z:relax", "s:end")
    )
    assert not warnings
    assert times["z:relax"] >= times["s:end"] - 1e-6


def test_synchronize_links_several():
    times, _ = schedule(
        "<head id='a'/><gesture id='b'/><gaze id='c'/><constraint><synchronize>"
        "<sync ref='a:start'/><sync ref='b:stroke+1'/><sync ref='c:end'/></synchronize>"
        "</constraint>"
    )
    assert times["a:start"] == pytest.approx(times["b:stroke"] + 1.0)
    assert times["a:start"] == pytest.approx(times["c:end"])


@pytest.mark.parametrize(
    ("inside", "gone"),
    [
        ("<head id='a' start='2' end='1'/>", {"a"}),
        ("<head id='a' start='0' end='0.00001'/>", {"a"}),
        ("<head id='a' start='-3'/>", {"a"}),
        ("<head id='a' start='b:end'/>", {"a"}),
        ("<head id='a' start='a:start+1'/>", {"a"}),
        ("<head id='a' start='nowhere:b:end'/>", {"a"}),
        ("<gazeShift id='a' ready='1'/>", {"a"}),
        ("<head id='a' start='b:end'/><gaze id='b' start='a:end'/>", {"a", "b"}),
        ("<head id='a' start='b:end'/><dance id='b'/>", {"a", "b"}),
        ("<gaze id='a'/><gaze id='b'/>", {"b"}),
        ("<gesture id='a'/><pointing id='b'/><head id='c'/>", {"b"}),
        ("<posture id='a'/><head id='b' start='a:end'/>", {"b"}),
        ("<head id='a' start='1'/><constraint id='c'><synchronize><sync ref='a:start'/>"
         "<sync ref='2'/></synchronize></constraint>", {"c"}),
        ("<head id='a' start='1'/><constraint id='c'><after ref='5'><sync ref='a:start'/></after>"
         "</constraint>", {"c"}),
        ("<constraint id='c'><synchronize><sync ref='1'/><sync ref='2'/></synchronize>"
         "</constraint>", {"c"}),
    ],
)  # fmt: skip
def test_what_cannot_be_is_left_out_with_one_warning_each(inside, gone):
    assert dropped(f"{inside}<wait id='w'/>") == gone


def test_a_block_fails_if_what_it_requires_cannot_be():
    times, warnings = schedule(
        "<required><head id='a' start='2' end='1'/></required><gaze id='z'/>"
    )
    assert not times
    assert [warning.id for warning in warnings] == ["bml1"]


def test_gestures_that_follow_each_other_do_not_return_to_rest():
    times, warnings = schedule("<gesture id='a' start='0'/><gesture id='b' start='1.2'/>")
    assert not warnings
    assert times["a:relax"] <= times["a:end"] == times["b:start"] == pytest.approx(1.2)


def test_a_behaviour_is_over_an_hour_after_its_block_has_started():
    times, warnings = schedule(
        "<wait id='a' end='3600'/><wait id='b' start='a:end' end='a:end+1'/><gaze id='c'/>"
    )
    assert [warning.id for warning in warnings] == ["bml1:b"]
    assert "3600 s" in warnings[0].description
    assert {"a:end", "c:end"} <= times.keys()


def test_what_is_tied_to_what_is_left_out_is_left_out_at_once():
    """A chain that was left out link by link, each time planned again."""
    heads = [f"<head id='h{i}' start='h{i - 1}:end'/>" for i in range(1, MAX_BEHAVIOURS - 1)]
    gone = dropped(f"<head id='h0' start='2' end='1'/>{''.join(heads)}<gaze id='z'/>")
    assert len(gone) == MAX_BEHAVIOURS - 1


def test_constraints_that_are_not_met_are_left_out_at_once():
    rules = [
        f"<synchronize><sync ref='w:start'/><sync ref='g:start+{i}'/></synchronize>"
        for i in range(MAX_TIED // 2)
    ]
    inside = f"<wait id='w'/><head id='g'/><constraint>{''.join(rules)}</constraint>"
    assert len(dropped(inside)) == MAX_TIED // 2 - 1


def test_a_block_that_contradicts_itself_in_too_many_ways_fails_in_one_line():
    """Constraints of several moments, which have to be left out one after the other."""
    rules = [
        f"<synchronize><sync ref='w:start+{i}'/><sync ref='g:start'/><sync ref='g:end'/>"
        "</synchronize>"
        for i in range(MAX_ATTEMPTS + 1)
    ]
    times, warnings = schedule(
        f"<wait id='w'/><gesture id='g'/><constraint>{''.join(rules)}</constraint>"
    )
    assert not times
    assert [warning.id for warning in warnings] == ["bml1"]
    assert str(MAX_ATTEMPTS) in warnings[0].description


@pytest.mark.parametrize(
    ("inside", "taken"),
    [
        ("<posture/>", MAX_BLOCKS),
        ("<head/>" * MAX_BEHAVIOURS, MAX_LOAD // MAX_BEHAVIOURS),
    ],
)
def test_there_is_room_for_so_many_blocks_and_one_that_replaces_them(inside, taken):
    realizer = Realizer(Estimates())
    for number in range(MAX_BLOCKS + 3):
        realizer.accept(block(inside, name=f"b{number}"))
    feedback = realizer.update(0.0)
    warnings = [each for each in feedback if isinstance(each, BmlWarning)]
    assert [each.id for each in warnings] == [f"b{n}" for n in range(taken, MAX_BLOCKS + 3)]
    assert all("replace them" in each.description for each in warnings)
    realizer.accept(block("<wait/>", name="last", more='composition="REPLACE"'))
    later = [*realizer.update(0.1), *realizer.update(9.0)]
    assert not any(isinstance(each, BmlWarning) for each in later)
    assert any(isinstance(each, BlockPrediction) and each.block == "last" for each in later)
