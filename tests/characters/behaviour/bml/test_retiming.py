"""Speech that turns out slower or faster moves the rest, and nothing that has happened."""

import numpy as np
import pytest

from cubeling.characters.behaviour.bml import BlockPrediction, Scheduled
from tests.characters.behaviour.bml.suite import FRAME, Session, Until, block

TALK = (
    "<speech id='s'><text>one two three four <sync id='a'/>five six seven <sync id='b'/>eight nine"
    "</text></speech><gesture id='g' stroke='s:b'/><head id='n' start='s:end'/>"
    "<gaze id='z' start='s:a' end='s:end'/>"
)


def times(session: Session, behaviour: str) -> dict[str, float]:
    (found,) = [s for s in session.realizer.scheduled if s.behaviour.id == behaviour]
    return dict(found.times)


def test_slower_speech_moves_what_is_linked_to_it():
    session = Session(block(TALK), Until(seconds=0.5))
    before = times(session, "s")
    for sync, late in (("a", 0.3), ("b", 0.6), ("end", 0.9)):
        session.realizer.retime("bml1", "s", sync, before[sync] + late)
    session.finish()
    session.check_clean()
    session.check_time("bml1:s:a", before["a"] + 0.3)
    session.check_time("bml1:g:stroke", before["b"] + 0.6)
    session.check_time("bml1:n:start", before["end"] + 0.9)
    session.check_linked("bml1:z:start", "bml1:s:a")
    session.check_linked("bml1:z:end", "bml1:s:end")


def test_one_late_sync_point_moves_the_rest_of_the_speech():
    session = Session(block(TALK), Until(seconds=0.5))
    before = times(session, "s")
    session.realizer.retime("bml1", "s", "a", before["a"] + 0.5)
    after = times(session, "s")
    assert after["end"] - before["end"] == pytest.approx(0.5)
    assert after["start"] == before["start"]


def test_faster_speech_is_never_in_the_past():
    session = Session(block(TALK), Until(seconds=0.6))
    session.realizer.retime("bml1", "s", "end", 0.0)
    assert min(times(session, "s")["a"], times(session, "n")["start"]) >= session.now - FRAME - 1e-9
    session.finish().check_clean()


def test_what_has_happened_does_not_move():
    session = Session(block(TALK), Until(seconds=2.0))
    happened = {s.key: _past(s, session.now - FRAME) for s in session.realizer.scheduled}
    session.realizer.retime("bml1", "s", "end", session.now + 3.0)
    for scheduled in session.realizer.scheduled:
        now = dict(scheduled.times)
        assert all(now[sync] == time for sync, time in happened[scheduled.key].items())
    session.finish().check_clean()


def test_other_blocks_follow():
    session = Session(
        block(TALK),
        block("<head id='n' start='bml1:s:end'/>", name="bml2"),
        block("<gaze id='z' start='bml2:n:end'/>", name="bml3"),
        Until(seconds=0.5),
    )
    session.realizer.retime("bml1", "s", "end", 6.0)
    session.finish().check_clean()
    assert session.report("bml2:n:start").time == pytest.approx(6.0)
    session.check_linked("bml3:z:start", "bml2:n:end")


def test_a_speech_that_starts_late_takes_its_gesture_along():
    session = Session(
        block("<gesture id='g'/><speech id='s' start='g:stroke'><text>one</text></speech>"),
        Until(seconds=0.2),
    )
    session.realizer.retime("bml1", "s", "start", 1.5)
    session.finish().check_clean()
    session.check_time("bml1:g:stroke", 1.5)


def test_a_new_time_is_predicted():
    session = Session(block(TALK), Until(seconds=0.5))
    session.realizer.retime("bml1", "s", "end", 9.0)
    session.frame()
    assert session.of(BlockPrediction)[-1].end > 9.0


@pytest.mark.parametrize("point", ["x:s:end", "bml1:x:end", "bml1:s:x"])
def test_what_is_not_there_is_not_moved(point):
    name, behaviour, sync = point.split(":")
    session = Session(block(TALK), Until(seconds=0.5))
    session.realizer.retime(name, behaviour, sync, 50.0)
    assert session.finish().now < 10.0


def test_times_stay_in_order_however_often_speech_is_moved():
    random = np.random.default_rng(5)
    session = Session(block(TALK))
    while not session.realizer.idle:
        session.frame()
        if session.realizer.scheduled and random.random() < 0.3 and session.now < 20.0:
            sync = str(random.choice(["start", "a", "b", "end"]))
            session.realizer.retime("bml1", "s", sync, session.now + random.normal(0.5, 1.0))
        for scheduled in session.realizer.scheduled:
            moments = [*scheduled.times.values()]
            assert moments == sorted(moments)
    session.check_clean()
    session.check_syncs("bml1", "s", ("start", "a", "b", "end"))


def _past(scheduled: Scheduled, now: float) -> dict[str, float]:
    return {sync: time for sync, time in scheduled.times.items() if time <= now}


def test_sync_points_that_move_together_are_planned_once():
    session, other = (Session(block(TALK), Until(seconds=0.5)) for _ in range(2))
    before = times(session, "s")
    moves = [("bml1", "s", sync, before[sync] + late) for sync, late in (("a", 0.3), ("end", 0.9))]
    session.realizer.retime_all(moves)
    for move in moves:
        other.realizer.retime(*move)
    assert [times(session, name) for name in "sgnz"] == [times(other, name) for name in "sgnz"]
    session.frame()
    assert len(session.predictions("bml1")) == 2
    session.finish().check_clean()
