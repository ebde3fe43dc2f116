"""Marks of gestures: what is written is read, and what annotators write is understood."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters.errors import CharacterError
from cubeling.characters.synthesis.gestures.learning import RATE_HZ, find_gestures
from cubeling.characters.synthesis.gestures.marks import Agreement, GestureMarks, marks_of
from cubeling.characters.synthesis.gestures.marks_files import read_marks
from cubeling.characters.synthesis.gestures.marks_writing import write_marks

MARKS = (
    GestureMarks(0.1, 0.4, 0.5, 0.7, 0.75, 0.9, 1.3),
    GestureMarks(1.3, 1.5, 1.5, 1.8, 1.9, 2.4, 3.0),
)

ELAN = """<?xml version="1.0" encoding="UTF-8"?>
<ANNOTATION_DOCUMENT>
 <TIME_ORDER>
  <TIME_SLOT TIME_SLOT_ID="a" TIME_VALUE="200"/><TIME_SLOT TIME_SLOT_ID="b" TIME_VALUE="500"/>
  <TIME_SLOT TIME_SLOT_ID="c" TIME_VALUE="900"/><TIME_SLOT TIME_SLOT_ID="d"/>
  <TIME_SLOT TIME_SLOT_ID="e" TIME_VALUE="1400"/>
 </TIME_ORDER>
 <TIER TIER_ID="RH">
  <ANNOTATION><ALIGNABLE_ANNOTATION ANNOTATION_ID="1" TIME_SLOT_REF1="a" TIME_SLOT_REF2="b">
   <ANNOTATION_VALUE>Preparation</ANNOTATION_VALUE></ALIGNABLE_ANNOTATION></ANNOTATION>
  <ANNOTATION><ALIGNABLE_ANNOTATION ANNOTATION_ID="2" TIME_SLOT_REF1="b" TIME_SLOT_REF2="c">
   <ANNOTATION_VALUE>?</ANNOTATION_VALUE></ALIGNABLE_ANNOTATION></ANNOTATION>
  <ANNOTATION><ALIGNABLE_ANNOTATION ANNOTATION_ID="3" TIME_SLOT_REF1="c" TIME_SLOT_REF2="d">
   <ANNOTATION_VALUE>hold</ANNOTATION_VALUE></ALIGNABLE_ANNOTATION></ANNOTATION>
  <ANNOTATION><ALIGNABLE_ANNOTATION ANNOTATION_ID="4" TIME_SLOT_REF1="c" TIME_SLOT_REF2="e">
   <ANNOTATION_VALUE>retraction</ANNOTATION_VALUE></ALIGNABLE_ANNOTATION></ANNOTATION>
 </TIER>
 <TIER TIER_ID="type" PARENT_REF="RH">
  <ANNOTATION><REF_ANNOTATION ANNOTATION_ID="5" ANNOTATION_REF="2">
   <ANNOTATION_VALUE>main stroke</ANNOTATION_VALUE></REF_ANNOTATION></ANNOTATION>
 </TIER>
</ANNOTATION_DOCUMENT>"""

ANVIL = """<annotation><body>
 <track name="phase" type="primary">
  <el index="0" start="0.2" end="0.5"><attribute name="type">prep</attribute></el>
  <el index="1" start="0.5" end="0.9"><attribute name="type">main</attribute></el>
  <el index="2" start="0.9" end="1.4"><attribute name="type">retract</attribute></el>
 </track>
 <track name="kind" type="span" ref="phase">
  <el index="0" start="1" end="1"><attribute name="kind">stroke</attribute></el>
 </track>
</body></annotation>"""

BML = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:sbm="urn:sbm">
 <sbm:animation start="0.2" ready="0.5" stroke_start="0.5" stroke="0.8" stroke_end="0.9"
                relax="0.9" end="1.4"/>
 <gesture id="later" stroke="speech:tm1"/>
</bml>"""


@pytest.mark.parametrize("suffix", [".csv", ".eaf", ".anvil", ".bml"])
def test_marks_that_are_written_are_read(tmp_path, suffix):
    path = tmp_path / f"talk{suffix}"
    write_marks(path, {"talk": MARKS})
    (found,) = read_marks(path).values()
    times = [list(vars(each).values()) for each in found]
    assert np.abs(np.array(times) - [list(vars(each).values()) for each in MARKS]).max() < 1e-9


@pytest.mark.parametrize(
    ("suffix", "text", "stroke"),
    [(".eaf", ELAN, 0.9), (".anvil", ANVIL, 0.9), (".bml", BML, 0.8)],
)
def test_marks_of_other_programs_are_understood(tmp_path, suffix, text, stroke):
    path = tmp_path / f"talk{suffix}"
    path.write_text(text)
    expected = GestureMarks(0.2, 0.5, 0.5, stroke, 0.9, 0.9, 1.4)
    assert read_marks(path) == {"talk": [expected]}


def test_a_table_names_clips_with_or_without_a_suffix(tmp_path):
    path = tmp_path / "marks.csv"
    path.write_text("clip,stroke_start_s,emphasis_s,stroke_end_s\na.bvh,1,1.5,2\nb,3,3.5,4\n")
    table = read_marks(path)
    assert [each.stroke for each in marks_of(table, "b")] == [3.5]
    assert [each.stroke for each in marks_of(table, "a")] == [1.5]
    assert not marks_of(table, "c")


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("m.csv", "clip,stroke_start_s,stroke_end_s\na,soon,2\n", "m.csv:2: 'soon' is no time"),
        ("m.csv", "clip,stroke_start_s\na,1\n", "m.csv:2: a gesture needs"),
        ("m.csv", "", "no stroke of a gesture"),
        ("m.eaf", "<a/>", "no stroke of a gesture"),
        ("m.anvil", "<a>", "m.anvil:1: not XML"),
        ("m.txt", "", "are files with"),
    ],
)
def test_what_has_no_marks_is_refused_in_one_line(tmp_path, name, text, message):
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(CharacterError, match=message) as caught:
        read_marks(path)
    assert "\n" not in str(caught.value)


times = st.lists(st.floats(0.0, 1e6), min_size=7, max_size=7)


@given(times, st.integers(3, 300))
def test_marks_are_frames_of_their_clip_in_order(values, frames):
    bounds, apex = GestureMarks(*values).frames(RATE_HZ, frames)
    assert list(bounds) == sorted(bounds)
    assert 0 <= bounds[0] <= bounds[2] < bounds[3] <= bounds[5] < frames
    assert bounds[2] <= apex <= bounds[5]


def test_what_agrees_is_all_found_and_what_is_elsewhere_is_missed():
    same = Agreement.of(MARKS, MARKS)
    assert (same.miss_share, same.same_f1, same.apex_share) == (0.0, 1.0, 1.0)
    assert same.time_f1 == pytest.approx(1.0)
    late = [GestureMarks(5.0, 5.0, 5.0, 5.1, 5.2, 5.2, 5.3)]
    other = Agreement.of(MARKS, late)
    assert (other.miss_share, other.same_f1, other.time_f1, other.apex_share) == (1, 0, 0, 0)
    assert (same + other).miss_share == 0.5


def test_marks_of_a_person_take_the_place_of_what_is_found(human, beating):
    clip = beating([(0, 0), (0.5, 0), (1.0, 90), (1.4, 30), (2.0, 30), (2.6, 0), (3.1, 0)])
    marks = GestureMarks(0.5, 1.0, 1.0, 1.35, 1.4, 2.0, None)
    (phrase,) = find_gestures(clip, human.skeleton, human.anatomy, [marks]).phrases
    assert phrase.hand == "right"
    assert phrase.bounds == (30, 60, 60, 84, 120, 186)
    assert phrase.apex == 81
