"""Blocks performed for a file: poses, sounds at their times, and feedback."""

import math

import numpy as np
import pytest

from cubeling.app.behaving.recording import TAIL_S, record_behaviour
from cubeling.app.sound import SAMPLE_RATE
from cubeling.characters.behaviour.bml import BlockProgress, BmlWarning, SyncPointProgress
from cubeling.characters.control.controllers import default_height
from cubeling.characters.skeleton import rotations
from tests.app.behaving.players import HUMAN, LateSource, block, player

RATE = 25.0


def loud(recording):
    """Return the times at which the sound is on [s]."""
    return np.flatnonzero(np.abs(recording.sound()[:, 0]) > 0.1) / SAMPLE_RATE


def test_speeches_sound_at_their_times_to_the_sample():
    speeches = "".join(
        f'<speech id="s{at}" start="{at}"><text>One two</text></speech>' for at in (0.51, 3.013)
    )
    sounding = loud(record_behaviour(player(), [block(speeches)], RATE))
    first = sounding[sounding < 2.5]
    second = sounding[sounding > 2.5]
    for part, start in ((first, 0.51), (second, 3.013)):
        assert part[0] == pytest.approx(start, abs=0.001)
        assert part[-1] == pytest.approx(start + 1.0, abs=0.001)


def test_a_speech_that_is_cut_off_is_heard_no_more():
    long = block('<speech id="s" start="0"><text>One two three four five six</text></speech>', "a")
    stop = block('<head lexeme="NOD"/>', "b", 'composition="REPLACE"')
    recording = record_behaviour(player(), [long, stop], RATE, together=True)
    assert loud(recording).size == 0 or loud(recording)[-1] < 0.2


def test_files_are_performed_one_after_the_other():
    documents = [block('<wait duration="1"/>', name) for name in "abc"]
    recording = record_behaviour(player(), documents, RATE)
    progress = [e for e in recording.feedback if isinstance(e, BlockProgress)]
    assert [(e.block, e.sync) for e in progress] == [
        (name, sync) for name in "abc" for sync in ("start", "end")
    ]
    starts = [e.time for e in progress if e.sync == "start"]
    assert starts == pytest.approx([0.0, 1.0, 2.0], abs=1.5 / RATE)
    assert recording.clip.duration == pytest.approx(3.0 + TAIL_S, abs=3.0 / RATE)


def test_a_look_without_an_end_does_not_last_for_ever():
    recording = record_behaviour(
        player(), [block('<gaze target="cube"/><wait duration="1"/>')], RATE
    )
    assert recording.clip.duration < 10.0


def test_a_way_is_in_the_root_of_the_motion():
    recording = record_behaviour(player(), [block('<locomotion target="0.2,0,0.2"/>')], RATE)
    root = recording.clip.poses.translations[:, 0]
    scale = default_height(HUMAN) / HUMAN.height
    gone = np.linalg.norm(root[-1] - root[0]) * scale
    assert gone == pytest.approx(math.hypot(0.2, 0.2), abs=0.07)
    ended = next(
        e.time for e in recording.feedback if isinstance(e, SyncPointProgress) and e.sync == "end"
    )
    assert ended == pytest.approx(3.0, abs=1.5)


@pytest.mark.slow(reason="seven seconds are performed")
def test_a_voice_that_is_late_does_not_make_the_body_jump():
    behaviours = """<speech id="s" start="0"><text>One <sync id="m"/>two three four</text></speech>
        <head lexeme="NOD" stroke="s:m"/><gaze target="cube" end="s:end" influence="WAIST"/>"""

    def steps(ready_at):
        lines = LateSource()
        performing = player(lines=lines)
        performing.settle(1.0, 25.0)
        performing.director.accept(block(behaviours))
        turns = []
        for number in range(90):
            lines.ready = number / 25.0 >= ready_at
            frame = performing.update(number / 25.0)
            turns.append(frame.posed.pose.rotations)
        stacked = np.stack(turns)
        moved = rotations.multiply(rotations.conjugate(stacked[:-1]), stacked[1:])
        return np.linalg.norm(rotations.to_rotation_vector(moved), axis=-1)

    eyes = [HUMAN.anatomy.joints[f"{side}Eye"] for side in ("left", "right")]
    loose = [HUMAN.skeleton.index(bone.joint) for bone in HUMAN.springs]
    leaping = eyes + loose  # by nature
    late, prompt = (np.delete(steps(at), leaping, axis=1).max() for at in (0.3, 0.0))
    assert late < 1.5 * prompt


def test_the_same_blocks_give_the_same_motion():
    document = block('<head lexeme="SHAKE"/><faceLexeme lexeme="SMILE"/>')
    one, other = (record_behaviour(player(), [document], RATE).clip.poses for _ in range(2))
    assert np.array_equal(one.rotations, other.rotations)
    assert one.morphs is not None
    assert other.morphs is not None
    assert np.array_equal(one.morphs, other.morphs)


def test_intentions_of_fml_are_performed_and_a_bad_document_is_a_warning():
    playing = player()
    playing.director.accept('<fml id="f"><performative type="agree"/></fml>')
    playing.director.accept(b"<bml")
    shown = playing.update(0.0)
    assert shown.realized.heads[0].lexeme == "NOD"
    warnings = [each for each in shown.feedback if isinstance(each, BmlWarning)]
    assert [each.type for each in warnings] == ["PARSING_FAILURE"]
