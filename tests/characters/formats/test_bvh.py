"""BVH: agreement with an independent reader, odd but legal files, and refusals."""

import itertools
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import CharacterError, CharacterWarning
from cubeling.characters.formats import RecordedMotion, load_motion
from cubeling.characters.formats.mocap.axes_and_units import CMU_UNIT_M
from cubeling.characters.skeleton import rotations
from tests.characters.formats.mutated_text import mutated
from tests.examples import examples

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # it imports pyglm by its old name
    import bvhio

SAMPLES = sorted((Path(__file__).parents[4] / "shared" / "data" / "bvh").glob("*.bvh"))

LEG = """HIERARCHY
ROOT hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT foot
  {
    OFFSET 0 -90 0
    CHANNELS 3 Yrotation Xrotation Zrotation
    End Site
    {
      OFFSET 0 0 12
    }
  }
  JOINT head
  {
    OFFSET 0 70 0
    CHANNELS 0
  }
}
MOTION
Frames: 2
Frame Time: 0.0333333
0 95 0 0 0 0 0 0 0
10 95 20 0 0 90 0 45 0
"""


def written(folder: Path, text: str | bytes, name: str = "leg.bvh") -> Path:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def places(performance: RecordedMotion) -> np.ndarray:
    """World positions of every joint, (frames, joints, 3)."""
    return performance.clip.poses.globals(performance.skeleton)[..., :3, 3]


def shortened(path: Path, frames: int) -> str:
    """A .bvh with only some frames of another, spread over all of it."""
    head, _, motion = path.read_text().replace("\r", "").partition("MOTION\n")
    lines = [line for line in motion.split("\n") if line.strip()]
    chosen = np.linspace(2, len(lines) - 1, frames).round().astype(int)
    return "\n".join([f"{head}MOTION", f"Frames: {frames}", lines[1], *(lines[i] for i in chosen)])


@pytest.mark.skipif(not SAMPLES, reason="the real recordings are not here")
@pytest.mark.parametrize("path", SAMPLES, ids=lambda path: path.stem)
def test_joint_positions_agree_with_an_independent_reader(path: Path, tmp_path: Path) -> None:
    short = written(tmp_path, shortened(path, 10), path.name)
    performance = load_motion(short, scale=1.0, up="y")
    ours, names = places(performance), performance.skeleton.names
    root = bvhio.readAsHierarchy(str(short))
    compared = 0
    for frame in range(10):
        root.loadPose(frame, recursive=True)
        for joint, _, _ in root.layout():
            theirs = np.array(joint.PositionWorld)
            # The coarsest unit of the samples is 0.06 m.
            gap = np.abs(ours[frame, names.index(joint.Name)] - theirs).max() * CMU_UNIT_M
            assert gap < 1e-4, f"{joint.Name} in frame {frame}"
            compared += 1
    assert compared == 10 * sum(not name.endswith("_end") for name in names)


@pytest.mark.skipif(not SAMPLES, reason="the real recordings are not here")
@pytest.mark.parametrize("path", SAMPLES, ids=lambda path: path.stem)
def test_real_people_stand_upright_on_the_ground_in_metres(path: Path) -> None:
    performance = load_motion(path)
    heights = places(performance)[..., 1]
    head = performance.skeleton.index("Head")
    assert (heights[:, head] > heights[:, 0] + 0.2).mean() > 0.9
    assert 0.9 < np.median(np.ptp(heights, axis=1)) < 1.8
    assert abs(np.median(heights.min(axis=1))) < 0.1
    assert performance.clip.rate == pytest.approx(30 if path.stem == "zombie" else 120, rel=2e-3)
    assert not performance.clip.loop
    assert not performance.clip.root_motion


def test_channels_end_sites_and_units(tmp_path: Path) -> None:
    performance = load_motion(written(tmp_path, LEG))
    skeleton, clip = performance.skeleton, performance.clip
    assert skeleton.names == ("hips", "foot", "foot_end", "head")
    assert skeleton.parents == (-1, 0, 1, 0)
    assert (skeleton.rest.rotations == rotations.IDENTITY).all()
    assert (clip.name, clip.rate, len(clip)) == ("leg", 30.0, 2)
    assert any("1 cm" in note for note in performance.notes)
    # The second frame: hips turned left by 90°, the toes 45° further down.
    foot, toes = places(performance)[1, 1:3]
    np.testing.assert_allclose(foot, [0.1, 0.05, 0.2])
    down = 0.12 / np.sqrt(2)
    np.testing.assert_allclose(toes, foot + [down, -down, 0], atol=1e-12)
    assert load_motion(tmp_path / "leg.bvh", "leg").clip.name == "leg"


@pytest.mark.parametrize("order", ["".join(order) for order in itertools.permutations("XYZ")])
def test_any_order_of_axes_turns_the_first_outermost(order: str, tmp_path: Path) -> None:
    axes = " ".join(f"{axis}rotation" for axis in order)
    text = LEG.replace("3 Yrotation Xrotation Zrotation", f"3 {axes}")
    text = text.replace("0 0 90 0 45 0", "0 0 0 10 20 30")
    matrix = np.eye(3)
    for axis, degrees in zip(order, (10, 20, 30), strict=True):
        matrix = matrix @ rotations.to_matrix(rotations.about(axis.lower(), np.radians(degrees)))
    turned = load_motion(written(tmp_path, text)).clip.poses.rotations[1, 1]
    np.testing.assert_allclose(rotations.to_matrix(turned), matrix, atol=1e-12)


def test_positions_of_any_joint_replace_its_offset(tmp_path: Path) -> None:
    text = LEG.replace("CHANNELS 0", "CHANNELS 1 Zposition")
    text = text.replace("0 95 0 0 0 0 0 0 0", "0 95 0 0 0 0 0 0 0 5")
    text = text.replace("0 0 90 0 45 0", "0 0 90 0 45 0 -5")
    performance = load_motion(written(tmp_path, text), scale=0.01)
    translations = performance.clip.poses.translations[:, 3]
    np.testing.assert_allclose(translations, [[0, 0.7, 0.05], [0, 0.7, -0.05]])


def test_several_roots_spaces_in_names_and_names_used_twice(tmp_path: Path) -> None:
    prop = "ROOT hips { OFFSET 0 0 30 CHANNELS 3 Xposition Yposition Zposition }"
    text = LEG.replace("MOTION", prop + "\nMOTION").replace("JOINT foot", "JOINT left foot")
    text = text.replace(" 0 0 0 0\n", " 0 0 0 0 1 2 3\n").replace("45 0\n", "45 0 1 2 3\n")
    with pytest.warns(CharacterWarning, match=r"2 roots \('hips', 'hips_2'\)"):
        performance = load_motion(written(tmp_path, text))
    assert performance.skeleton.names == ("hips", "left foot", "left foot_end", "head", "hips_2")
    assert performance.skeleton.parents[-1] == -1
    assert any("as hips, repeat" in note for note in performance.notes)


def test_all_frames_are_read_where_there_are_more_than_stated(tmp_path: Path) -> None:
    performance = load_motion(written(tmp_path, LEG.replace("Frames: 2", "Frames: 1")))
    assert len(performance.clip) == 2
    assert any("all are read" in note for note in performance.notes)


@pytest.mark.parametrize(
    ("old", "new", "warning"),
    [
        ("Frames: 2", "Frames: 900000000", "it has 2 of the 900000000 frames"),
        ("End Site", "End Site_Foot", "end sites have names"),
        ("End Site", "End Site of the foot", "end sites have names"),
        ("45 0\n", "45 0\n\0\0\0", "zero bytes follow the text"),
        ("0.0333333", "30", "taken as 30 frames a second, --fps"),
    ],
)
def test_what_other_exporters_write_is_read_with_a_warning(
    old: str, new: str, warning: str, tmp_path: Path
) -> None:
    plain = load_motion(written(tmp_path, LEG))
    path = written(tmp_path, LEG.replace(old, new, 1))
    with pytest.warns(CharacterWarning, match=rf"leg\.bvh: .*{warning}"):
        performance = load_motion(path)
    assert performance.skeleton.names == plain.skeleton.names
    assert performance.clip.rate == plain.clip.rate
    np.testing.assert_array_equal(places(performance), places(plain))


def test_the_rate_can_be_stated(tmp_path: Path) -> None:
    path = written(tmp_path, LEG.replace("0.0333333", "0"))
    assert load_motion(path, rate=25.0).clip.rate == 25.0
    with pytest.raises(CharacterError, match="invalid rate of 0 frames"):
        load_motion(path, rate=0.0)


@given(
    axis=st.sampled_from(["+y", "+z", "-y", "-z"]),
    unit=st.sampled_from([1.0, 0.3048, 0.0254, 0.01, 0.001]),
    yaw=st.floats(-np.pi, np.pi),
)
@settings(max_examples=examples(25))
def test_vertical_axis_and_unit_are_recognised(
    axis: str, unit: float, yaw: float, tmp_path_factory: pytest.TempPathFactory
) -> None:
    sign, number = (-1.0 if axis[0] == "-" else 1.0), "xyz".index(axis[1])

    def vector(height: float) -> str:
        values = np.zeros(3)
        values[number] = sign * height / unit
        return " ".join(f"{value:.6f}" for value in values)

    turn = f"{axis[1].upper()}rotation"
    text = (
        f"HIERARCHY\nROOT hips {{ OFFSET 0 0 0 CHANNELS 4 Xposition Yposition Zposition {turn}\n"
        f"JOINT LeftFoot {{ OFFSET {vector(-0.9)} End Site {{ OFFSET 0 0 0 }} }}\n"
        f"JOINT Head {{ OFFSET {vector(0.75)} CHANNELS 0 }} }}\n"
        f"MOTION\nFrames: 1\nFrame Time: 0.02\n{vector(0.9)} {np.degrees(yaw):.4f}\n"
    )
    performance = load_motion(written(tmp_path_factory.mktemp("up"), text))
    expected = np.array([[0, 0.9, 0], [0, 0, 0], [0, 0, 0], [0, 1.65, 0]])
    np.testing.assert_allclose(places(performance)[0], expected, atol=2e-3)
    assert (performance.skeleton.rest.rotations == rotations.IDENTITY).all()


CRAWLER = """HIERARCHY
ROOT Hips {{ OFFSET 0 0 0 CHANNELS 6 Xposition Yposition Zposition Xrotation Yrotation Zrotation
JOINT LeftFoot {{ OFFSET 0 -0.9 0 End Site {{ OFFSET 0 0 0.15 }} }}
JOINT Head {{ OFFSET 0 0.75 0 End Site {{ OFFSET 0 0.1 0 }} }} }}
MOTION
Frames: 3
Frame Time: 0.5
0 0.4 {0} 90 0 0
0 0.4 {1} 90 0 0
0 0.4 {2} 90 0 0
"""


def test_a_crawling_performer_is_not_turned_upright(tmp_path: Path) -> None:
    performance = load_motion(written(tmp_path, CRAWLER.format(0, 0.5, 1)))
    assert any("+y is taken as up" in note for note in performance.notes)
    np.testing.assert_allclose(places(performance)[:, 0], [[0, 0.4, 0], [0, 0.4, 0.5], [0, 0.4, 1]])


def test_up_is_recognised_for_a_quadruped(tmp_path: Path) -> None:
    paws = "".join(
        f"JOINT {name} {{ OFFSET {x} -0.5 {z} End Site {{ OFFSET 0 0 0.05 }} }}\n"
        for name, x, z in (
            ("lfoot", 0.1, 0),
            ("rfoot", -0.1, 0),
            ("lpaw", 0.1, 1),
            ("rpaw", -0.1, 1),
        )
    )
    text = (
        "HIERARCHY\nROOT pelvis { OFFSET 0 0 0 CHANNELS 3 Xposition Yposition Zposition\n"
        f"JOINT head {{ OFFSET 0 0.1 1.3 }}\n{paws}}}\n"
        "MOTION\nFrames: 1\nFrame Time: 0.5\n0 0.5 0\n"
    )
    performance = load_motion(written(tmp_path, text), scale=1.0)
    assert performance.notes == ()
    assert places(performance)[0, 0, 1] == 0.5


def test_scale_and_up_can_be_stated(tmp_path: Path) -> None:
    path = written(tmp_path, LEG)
    performance = load_motion(path, scale=0.02, up="-z")
    assert performance.notes == ()
    np.testing.assert_allclose(performance.skeleton.rest.translations[3], [0, 0, 1.4])
    for wrong in (
        {"scale": 0.0},
        {"scale": 1e300},
        {"scale": float("nan")},
        {"up": "w"},
        {"up": ""},
    ):
        with pytest.raises(CharacterError, match=r"leg\.bvh: (scale|up)"):
            load_motion(path, **wrong)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("10 95 20 0 0 90 0 45 0", "10 95 20 0 0 90 0 45", "line 25: frame 2 has 8 numbers, not 9"),
        (
            "10 95 20 0 0 90 0 45 0",
            "10 95 20 0 0 90 0 45 0 7",
            "line 25: frame 2 has 10 numbers, not 9",
        ),
        ("Frames: 2", "Frames: -3x", "line 22: expected a number, found '-3x'"),
        ("20 0 0 90", "20 nan 0 90", "line 25: 'nan' is out of range"),
        ("20 0 0 90", "20 0 1e999 90", "line 25: '1e999' is out of range"),
        ("20 0 0 90", "20 0 zero 90", "line 25: expected a number, found 'zero'"),
        ("OFFSET 0 -90 0", "OFFSET 0 inf 0", "line 8: 'inf' is out of range"),
        ("Xposition", "Wposition", "line 5: expected a channel of 'hips', found 'Wposition'"),
        ("CHANNELS 6", "CHANNELS 5", "line 5: expected JOINT or END or"),
        ("CHANNELS 6", "CHANNELS 99999999999", "line 5: '99999999999' is not a number of channels"),
        ("MOTION", "}", "line 21: expected ROOT or MOTION, found '}'"),
        ("\n}\nMOTION", "\nMOTION", "line 20: expected JOINT"),
        ("0.0333333", "0", "line 23: an invalid frame time of 0 s"),
        ("0.0333333", "2", "line 23: an invalid frame time of 2 s; .* --fps"),
        ("0.0333333", "5000", "line 23: an invalid frame time of 5000 s"),
        ("End Site", "End Effector", "line 11: expected SITE, found 'Effector'"),
        ("End Site", "End", "line 11: expected SITE, found '{'"),
        ("Frame Time", "Time", "line 23: expected 'frame time', found"),
        ("ROOT hips", "ROOT", "line 3: this ROOT has no name"),
        ("HIERARCHY", "GIF89a", "line 1: expected HIERARCHY, found 'GIF89a'"),
    ],
)
def test_a_damaged_file_is_refused_with_its_line(
    old: str, new: str, message: str, tmp_path: Path
) -> None:
    assert old in LEG
    with pytest.raises(CharacterError, match=rf"leg\.bvh, {message}"):
        load_motion(written(tmp_path, LEG.replace(old, new, 1)))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "line 1: ends where HIERARCHY is expected"),
        (LEG.partition("MOTION")[0].encode(), "line 20: ends where ROOT or MOTION is expected"),
        (LEG.encode() + b"\xff", "line 26: byte 0xff is not UTF-8"),
        (LEG.encode("utf-16"), "line 1: byte 0xff is not UTF-8"),
        (LEG.replace("hips", "hi\0ps").encode(), "line 2: holds binary data"),
        (LEG.partition("0 95")[0].encode(), "line 23: no frames follow"),
    ],
)
def test_incomplete_or_binary_text_is_refused(data: bytes, message: str, tmp_path: Path) -> None:
    with pytest.raises(CharacterError, match=message):
        load_motion(written(tmp_path, data))


def test_line_ends_marks_and_capitals_do_not_matter(tmp_path: Path) -> None:
    plain = load_motion(written(tmp_path, LEG))
    odd = LEG.replace("JOINT", "Joint").replace("rotation", "ROTATION").replace("\n", "\r\n")
    other = load_motion(written(tmp_path, b"\xef\xbb\xbf" + odd.encode()))
    np.testing.assert_array_equal(places(plain), places(other))


def test_absent_files_and_wrong_names_are_refused(tmp_path: Path) -> None:
    with pytest.raises(CharacterError, match=r"cannot read .*none\.bvh"):
        load_motion(tmp_path / "none.bvh")
    with pytest.raises(CharacterError, match="no clip 'run', only 'leg'"):
        load_motion(written(tmp_path, LEG), "run")


def test_a_motion_too_large_for_memory_is_refused(tmp_path: Path) -> None:
    joints = "".join(f"JOINT j{n} {{ OFFSET 0 1 0 }}\n" for n in range(20000))
    text = f"HIERARCHY\nROOT r {{ OFFSET 0 0 0 CHANNELS 1 Xposition\n{joints}}}\nMOTION\n"
    text += "Frames: 2000\nFrame Time: 0.01\n" + "0\n" * 2000
    with pytest.raises(CharacterError, match="2000 frames of 20001 joints"):
        load_motion(written(tmp_path, text))


@pytest.mark.filterwarnings("ignore::cubeling.characters.CharacterWarning")
@given(data=st.data())
@settings(max_examples=examples(60))
def test_a_mutated_file_loads_or_is_refused_in_one_line(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    text = mutated(data, LEG, ["{", "}", "End", "JOINT x"])
    path = written(tmp_path_factory.mktemp("fuzz"), text)
    try:
        performance = load_motion(path)
    except CharacterError as error:
        assert len(str(error).splitlines()) == 1  # noqa: PT017
    else:
        assert np.isfinite(places(performance)).all()


@given(junk=st.binary(max_size=300))
@settings(max_examples=examples(30))
def test_random_bytes_are_refused(junk: bytes, tmp_path_factory: pytest.TempPathFactory) -> None:
    with pytest.raises(CharacterError):
        load_motion(written(tmp_path_factory.mktemp("junk"), junk))
