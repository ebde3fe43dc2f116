"""Damaged ASF and AMC files are refused in one line, with the number of the line."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import CharacterError
from cubeling.characters.formats import load_motion
from tests.characters.formats.hopper import AMC, ASF, hopper, places
from tests.characters.formats.mutated_text import mutated
from tests.examples import examples


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "leg 30 0 0",
            "leg 30 0",
            r"line 10: 'leg' has 2 numbers instead of 3, its degrees of freedom in hopper",
        ),
        ("leg 30 0 0", "leg 30", r"line 10: 'leg' has 1 number instead of 3"),
        ("leg 0 0 0", "leg 0 0 0 0", r"line 6: 'leg' has 4 numbers"),
        ("leg 30 0 0", "arm 30 0 0", r"line 10: hopper\.asf has no bone 'arm'"),
        ("leg 30 0 0", "leg 30 nan 0", "line 10: 'nan' is out of range"),
        ("leg 30 0 0", "leg 30 -inf 0", "line 10: '-inf' is out of range"),
        ("leg 30 0 0", "leg 30 x 0", "line 10: expected a number, found 'x'"),
        ("leg 30 0 0\nfoot -10\n", "", "line 8: frame 2 lacks 'leg'"),
        ("foot 0\n2\n", "foot 0\n", "line 8: frame 1 moves 'root' twice"),
        ("\n1\n", "\n", "line 4: 'root' before the number of the first frame"),
    ],
)
def test_a_damaged_motion_is_refused_with_its_line(
    old: str, new: str, message: str, tmp_path: Path
) -> None:
    assert old in AMC
    with pytest.raises(CharacterError, match=rf"hopper\.amc, {message}"):
        load_motion(hopper(tmp_path, amc=AMC.replace(old, new, 1)))


@pytest.mark.parametrize("amc", ["", ":DEGREES\n", "# nothing\n\n"])
def test_a_motion_without_frames_is_refused(amc: str, tmp_path: Path) -> None:
    with pytest.raises(CharacterError, match=r"hopper\.amc: has no frames"):
        load_motion(hopper(tmp_path, amc=amc))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("leg foot", "leg foot root", "line 46: 'root' has a parent already"),
        ("root leg head", "root head", "'leg' is not connected to the root"),
        (
            "root leg head\n    leg foot",
            "root head\n    leg foot\n    foot leg",
            "'leg' is not c",
        ),
        ("leg foot", "leg paw", "line 46: no bone named 'paw'"),
        ("root leg head", "root leg head leg", "line 45: 'leg' has a parent already"),
        ("name foot", "name leg", "line 27: a second bone 'leg'"),
        ("name foot", "", "line 27: this bone has no name"),
        ("dof rx\n", "dof rw\n", "line 33: 'rw' is not a degree of freedom"),
        ("dof rx\n", "dof rx rx\n", "line 33: 'rx' is listed twice"),
        ("axis 0 0 90 XYZ", "axis 0 0 90 XYY", "line 21: 'xyy' is not an order of axes"),
        ("axis 0 0 90 XYZ", "axis 0 0", "line 21: axis has 2 numbers"),
        ("direction 0 0 1", "direction 0 0 0", "line 27: bone 'foot' has no direction"),
        ("direction 0 0 1", "direction 0 nan 1", "line 30: 'nan' is out of range"),
        ("length 16", "length -16", "line 16: bone 'leg' has no direction or a negative length"),
        ("length 16", "length", "line 20: expected a number, found ''"),
        ("length 0.45", "length 0", "line 6: a length unit of 0"),
        ("angle deg", "angle turns", "line 7: angles in 'turns'"),
        ("  end\n:hierarchy", ":hierarchy", "line 36: this begin has no end"),
        ("     id 2", "begin", "line 28: begin inside begin"),
        (":hierarchy", ":links", "has no :hierarchy"),
        (":version", "version", "line 2: 'version' before any section"),
        (":units", ":root", "line 10: a second :root"),
    ],
)
def test_a_damaged_skeleton_is_refused_with_its_line(
    old: str, new: str, message: str, tmp_path: Path
) -> None:
    assert old in ASF
    with pytest.raises(CharacterError, match=rf"hopper\.asf(,|:|: bone) {message}"):
        load_motion(hopper(tmp_path, ASF.replace(old, new, 1)))


@given(data=st.data())
@settings(max_examples=examples(60))
def test_a_mutated_file_loads_or_is_refused_in_one_line(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    texts = {"asf": ASF, "amc": AMC}
    chosen = data.draw(st.sampled_from(sorted(texts)))
    texts[chosen] = mutated(data, texts[chosen], ["1", "begin", "end", "root", ":root", "l"])
    try:
        performance = load_motion(hopper(tmp_path_factory.mktemp("fuzz"), **texts))
    except CharacterError as error:
        assert len(str(error).splitlines()) == 1  # noqa: PT017
    else:
        assert np.isfinite(places(performance)).all()


@given(junk=st.binary(max_size=300), kind=st.sampled_from(["asf", "amc"]))
@settings(max_examples=examples(30))
def test_random_bytes_are_refused(
    junk: bytes, kind: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = hopper(tmp_path_factory.mktemp("junk"))
    path.with_suffix(f".{kind}").write_bytes(junk)
    with pytest.raises(CharacterError):
        load_motion(path)
