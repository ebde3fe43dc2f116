"""Blocks start, end, replace and follow each other as the standard says."""

import pytest

from cubeling.characters.behaviour.bml import (
    FACE_SYNCS,
    GESTURE_SYNCS,
    HOLD_SYNCS,
    SHIFT_SYNCS,
    SYNCS,
    BlockPrediction,
)
from tests.characters.behaviour.bml.suite import Session, Until, block

LONG = "<speech id='s'><text>" + "word " * 30 + "<sync id='m'/>" + "word " * 30 + "</text></speech>"


@pytest.mark.parametrize("kind", SYNCS)
def test_every_kind_of_behaviour_reports_its_sync_points_in_order(kind):
    end = " end='4'" if kind == "posture" else ""
    session = Session(block(f"<{kind} id='b' start='0.5'{end}/>")).finish()
    session.check_clean()
    session.check_blocks("bml1")
    session.check_syncs("bml1", "b", SYNCS[kind])
    session.check_time("bml1:b:start", 0.5)


def test_sync_points_of_the_kinds():
    assert SYNCS["gesture"] == SYNCS["pointing"] == SYNCS["head"] == GESTURE_SYNCS
    assert SYNCS["gaze"] == SYNCS["posture"] == HOLD_SYNCS
    assert SYNCS["faceLexeme"] == FACE_SYNCS
    assert SYNCS["speech"] == SHIFT_SYNCS


def test_an_empty_block_starts_and_ends():
    session = Session(block()).finish()
    session.check_clean()
    session.check_blocks("bml1")


def test_a_document_that_is_no_block_is_one_warning():
    session = Session("<bml/>").finish()
    assert [w.type for w in session.warnings] == ["PARSING_FAILURE"]
    assert not session.blocks("start")


def test_an_id_is_used_again_only_when_its_block_is_over():
    session = Session(block("<head id='n'/>"), block("<head id='n'/>")).finish()
    assert [w.type for w in session.warnings] == ["PARSING_FAILURE"]
    session.realizer.accept(block("<head id='n'/>"))
    session.finish()
    assert session.blocks("end") == ["bml1", "bml1"]


def test_a_block_of_nothing_that_can_be_done_still_ends():
    session = Session(block("<dance id='d'/>")).finish()
    session.check_blocks("bml1")
    assert [(w.id, w.type) for w in session.warnings] == [("bml1:d", "BEHAVIOR_TYPE_NOT_SUPPORTED")]


def test_foreign_behaviours_are_warned_of_as_such():
    session = Session(block("<x:dance xmlns:x='urn:x' id='d'/>")).finish()
    assert [w.type for w in session.warnings] == ["CUSTOM_BEHAVIOR_NOT_SUPPORTED"]


def test_merged_blocks_play_together():
    session = Session(
        block(LONG), Until(seconds=1.0), block("<head id='n'/>", name="bml2")
    ).finish()
    session.check_clean()
    assert session.blocks("end") == ["bml2", "bml1"]


def test_a_merged_block_cannot_take_what_another_one_uses():
    session = Session(
        block("<gaze id='z' start='0' end='5'/>"), block("<gaze id='z'/>", name="bml2")
    ).finish()
    assert [w.id for w in session.warnings] == ["bml2:z"]
    session.check_syncs("bml1", "z", HOLD_SYNCS)


def test_appended_blocks_follow_without_a_gap():
    session = Session(
        block(LONG),
        block("<head id='n'/>", name="bml2", more='composition="APPEND"'),
        block("<head id='n'/>", name="bml3", more='composition="APPEND"'),
    ).finish()
    session.check_clean()
    session.check_blocks("bml1", "bml2", "bml3")
    for earlier, later in (("bml1", "bml2"), ("bml2", "bml3")):
        assert session.block_time(later, "start") == session.block_time(earlier, "end")


def test_append_after_waits_for_the_blocks_it_names_only():
    session = Session(
        block(LONG),
        block("<head id='n'/>", name="bml2"),
        block("<head id='n'/>", name="bml3", more='composition="APPEND-AFTER(bml2)"'),
    ).finish()
    session.check_clean()
    session.check_after_block("bml3", "bml2")
    assert session.blocks("end") == ["bml2", "bml3", "bml1"]


def test_replace_ends_all_before_it_starts():
    session = Session(
        block("<gesture id='g' start='0' end='30'/>"),
        block("<head id='n'/>", name="bml2", more='composition="APPEND"'),
        block("<head id='n'/>", name="bml3", more='bmla:preplan="true"'),
        Until(seconds=2.0),
        block("<head id='n'/>", name="bml4", more='composition="REPLACE"'),
    ).finish()
    session.check_clean()
    assert session.blocks("start") == ["bml1", "bml4"]
    assert sorted(session.blocks("end")) == ["bml1", "bml2", "bml3", "bml4"]
    session.check_after_block("bml4", "bml1")
    session.check_time("bml1:g:relax", 2.0)
    assert session.report("bml1:g:end").time > session.report("bml1:g:relax").time


def test_what_never_ends_is_ended_by_replace():
    session = Session(block("<posture id='p'/>"), Until(seconds=60.0))
    assert session.syncs("bml1", "p") == ["start", "ready"]
    session.realizer.accept(block(name="bml2", more='composition="REPLACE"'))
    session.finish().check_blocks("bml1", "bml2")


def test_interrupt_ends_a_block_before_the_next_one_starts():
    session = Session(
        block(LONG),
        Until(seconds=1.0),
        block("<head id='n'/>", name="b2", more='bmla:interrupt="bml1"'),
    ).finish()
    session.check_clean()
    session.check_after_block("b2", "bml1")
    session.check_time("bml1:s:end", 1.0)
    assert session.syncs("bml1", "s") == ["start", "end"]


@pytest.mark.parametrize(("which", "left"), [("include='s'", "z"), ("exclude='z'", "z")])
def test_interrupt_of_some_behaviours_leaves_the_others(which, left):
    session = Session(
        block(LONG + "<gaze id='z' start='0' end='9'/>"),
        block(f"<bmla:interrupt id='i' target='bml1' start='2' {which}/>", name="bml2"),
    ).finish()
    session.check_clean()
    session.check_linked("bml1:s:end", "bml2:i:start")
    session.check_syncs("bml1", left, HOLD_SYNCS)
    session.check_time("bml1:z:end", 9)


def test_interrupt_at_a_sync_point_lets_it_come_first():
    session = Session(
        block(LONG), block("<bmla:interrupt id='i' target='bml1' start='bml1:s:m'/>", name="bml2")
    ).finish()
    session.check_clean()
    session.check_syncs("bml1", "s", ("start", "m", "end"))
    session.check_linked("bml1:s:m", "bml1:s:end")


def test_a_behaviour_that_is_interrupted_before_it_starts_never_does():
    session = Session(
        block("<head id='n' start='5'/><gaze id='z' end='2'/>"),
        block("<bmla:interrupt id='i' target='bml1' start='1' include='n'/>", name="bml2"),
    ).finish()
    session.check_clean()
    assert session.syncs("bml1", "n") == []
    session.check_time("bml1:z:end", 2)
    assert session.block_time("bml1", "end") == pytest.approx(2.0)


def test_targets_that_are_not_there_are_warned_of():
    session = Session(
        block("<bmla:interrupt id='i' target='x'/><bmla:activate id='a' target='y'/>")
    ).finish()
    assert [w.type for w in session.warnings] == ["NO_SUCH_TARGET", "NO_SUCH_TARGET"]
    session.check_blocks("bml1")


def test_a_planned_block_waits_to_be_activated():
    session = Session(
        block("<head id='n'/>", name="later", more='bmla:preplan="true"'), Until(seconds=3.0)
    )
    assert not session.blocks("start")
    assert session.predictions("later")
    session.realizer.accept(
        block("<head id='n'/><bmla:activate id='a' target='later' start='n:end'/>")
    )
    session.finish().check_clean()
    session.check_linked("bml1:n:end", "later:n:start")


def test_a_planned_block_leaves_what_runs_alone():
    session = Session(
        block("<gesture id='g'/>"),
        Until(seconds=1.2),
        block("<gesture id='g'/>", name="later", more='bmla:preplan="true"'),
    )
    session.finish()
    session.check_time("bml1:g:end", 1.5)


def test_a_block_activates_others_at_its_start():
    session = Session(
        block("<head id='n'/>", name="later", more='bmla:preplan="true"'),
        block("<head id='n'/>", more='bmla:onStart="later"'),
    ).finish()
    session.check_clean()
    assert session.block_time("later", "start") == session.block_time("bml1", "start")


def test_the_first_chunk_leads_over_to_the_second():
    chunk = (
        "<speech id='s'><text>a chunk<sync id='m'/></text></speech><gesture id='g' stroke='s:m'/>"
    )
    session = Session(
        block(chunk), block(chunk, name="bml2", more='bmla:chunkAfter="bml1"')
    ).finish()
    session.check_clean()
    session.check_blocks("bml1", "bml2")
    session.check_linked("bml1:g:relax", "bml1:g:end")
    session.check_linked("bml1:g:relax", "bml2:g:start")


def test_times_of_other_blocks_are_known():
    session = Session(
        block(LONG), block("<head id='n' start='bml1:s:m+0.5'/>", name="bml2")
    ).finish()
    session.check_clean()
    session.check_linked("bml2:n:start", "bml1:s:m", 0.5)


def test_a_sync_point_that_is_just_over_counts_as_now():
    session = Session(
        block(LONG), Until(seconds=0.08), block("<head id='n' start='bml1:s:start'/>", name="bml2")
    ).finish()
    session.check_clean()
    session = Session(
        block(LONG), Until(seconds=1.0), block("<head id='n' start='bml1:s:start'/>", name="bml2")
    ).finish()
    assert [w.id for w in session.warnings] == ["bml2:n"]


def test_active_behaviours_are_those_between_start_and_end():
    session = Session(block("<gaze id='z' start='1' end='3'/>"), Until(seconds=0.5))
    assert not session.realizer.active(0.5)
    assert [s.key for s in session.realizer.scheduled] == ["bml1:z"]
    (active,) = session.realizer.active(1.0)
    assert dict(active.times)["relax"] == pytest.approx(2.8)
    assert not session.realizer.active(3.0)


def test_controls_are_not_for_the_performer():
    session = Session(block("<bmla:interrupt id='i' target='bml1' start='5'/>"), Until(seconds=0.1))
    assert not session.realizer.scheduled


def test_predictions_tell_when_a_block_will_be():
    session = Session(block("<head id='n' start='2'/>", more='characterId="Anna"')).finish()
    (prediction,) = session.of(BlockPrediction)
    assert prediction.start == session.block_time("bml1", "start")
    assert prediction.end == pytest.approx(session.block_time("bml1", "end"))
    assert dict(prediction.behaviours[0].times)["start"] == pytest.approx(2.0)
    assert {getattr(f, "character", "") for f in session.feedback} == {"Anna"}


def test_a_large_frame_shifts_nothing():
    fine = Session(block(LONG + "<gesture id='g' stroke='s:m'/>")).finish()
    realizer = Session().realizer
    realizer.accept(block(LONG + "<gesture id='g' stroke='s:m'/>"))
    coarse = [f for now in (0.0, 7.0, 50.0) for f in realizer.update(now)]
    assert coarse == fine.feedback
