"""Acclaim ASF/AMC: agreement with a walk over 4×4 matrices, and odd but legal files."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import CharacterError
from cubeling.characters.formats import load_motion
from cubeling.characters.formats.mocap import amc
from cubeling.characters.formats.mocap.axes_and_units import CMU_UNIT_M
from cubeling.characters.skeleton import rotations
from tests.characters.formats.hopper import AMC, ASF, hopper, places
from tests.examples import examples, some

DATA = Path(__file__).parents[4] / "shared" / "data"
SAMPLES = sorted((DATA / "cmu-mocap").glob("*/*.amc"))

# Metres a second over the ground, as measured for the data's own README.
SPEEDS = {
    "02_01": 1.14,
    "02_03": 2.56,
    "16_15": 1.07,
    "16_22": 1.6,
    "16_35": 2.75,
    "16_46": 4.17,
    "49_01": 0.83,
}


def rotation(degrees: list[float], order: str = "xyz") -> np.ndarray:
    """4×4: turned about the fixed axes one after the other, written out with sines."""
    matrix = np.eye(4)
    for axis, angle in zip(order, degrees, strict=True):
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        one = {
            "x": [[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1]],
            "y": [[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1]],
            "z": [[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
        }[axis]
        matrix = np.array(one) @ matrix
    return matrix


def shift(x: float, y: float, z: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def bones_of(asf: str) -> dict[str, dict[str, list[str]]]:
    """Every bone's words after each keyword, by splitting at begin and end."""
    bones = {}
    for part in asf.partition(":bonedata")[2].partition(":hierarchy")[0].split("begin")[1:]:
        rows = [line.split() for line in part.partition("end")[0].splitlines() if line.strip()]
        words = {row[0]: row[1:] for row in rows}
        bones[words["name"][0]] = words
    return bones


def walk(asf: str, frame: dict[str, list[float]]) -> dict[str, np.ndarray]:
    """Where each bone ends in one frame [file's unit], down the tree, matrix after matrix.

    The published definition: bone_from_parent = T(end of parent) C M C⁻¹, with C the bone's axis
    and M its motion about the axes of C.
    """
    bones, links = bones_of(asf), {}
    for line in asf.partition(":hierarchy")[2].splitlines():
        words = line.split()
        if words and words[0] not in ("begin", "end"):
            links[words[0]] = words[1:]
    x, y, z, *angles = frame["root"]
    ends = {"root": np.array([x, y, z])}

    def descend(name: str, world: np.ndarray) -> None:
        for child in links.get(name, []):
            bone = bones[child]
            frame_of_bone = rotation([float(word) for word in bone["axis"][:3]])
            turns = dict(zip(bone.get("dof", []), frame.get(child, []), strict=True))
            motion = rotation([turns.get(f"r{axis}", 0.0) for axis in "xyz"])
            turned = world @ frame_of_bone @ motion @ np.linalg.inv(frame_of_bone)
            along = np.array([float(word) for word in bone["direction"]])
            end = turned @ shift(*(along * float(bone["length"][0])))
            ends[child] = end[:3, 3]
            descend(child, end)

    descend("root", shift(x, y, z) @ rotation(angles))
    return ends


def frames_of(amc: str) -> list[dict[str, list[float]]]:
    frames: list[dict[str, list[float]]] = []
    for line in amc.splitlines():
        words = line.split()
        if words[0].isdigit():
            frames.append({})
        elif frames:
            frames[-1][words[0]] = [float(word) for word in words[1:]]
    return frames


def assert_like_the_walk(path: Path, looks: int) -> None:
    asf = next(path.parent.glob("*.asf")).read_text()
    performance = load_motion(path, scale=CMU_UNIT_M, up="y")
    assert performance.notes == ()
    ours, skeleton = places(performance), performance.skeleton
    frames = frames_of(path.read_text())
    assert len(frames) == len(performance.clip)
    for number in np.linspace(0, len(frames) - 1, looks).round().astype(int):
        ends = walk(asf, frames[number])
        for joint, (name, parent) in enumerate(zip(skeleton.names, skeleton.parents, strict=True)):
            # A joint is where its bone starts, which is where its parent's ends.
            bone = name if parent < 0 else skeleton.names[parent]
            gap = np.abs(ours[number, joint] - ends[bone] * CMU_UNIT_M).max()
            assert gap < 1e-4, f"{name} in frame {number + 1}"


@pytest.mark.skipif(not SAMPLES, reason="the real recordings are not here")
@pytest.mark.parametrize("path", some(SAMPLES, 3), ids=lambda path: path.stem)
def test_joint_positions_agree_with_matrix_products(path: Path) -> None:
    assert_like_the_walk(path, looks=10)


@pytest.mark.skipif(not SAMPLES, reason="the real recordings are not here")
@pytest.mark.parametrize(
    "path", some([p for p in SAMPLES if p.stem in SPEEDS], 2), ids=lambda p: p.stem
)
def test_real_people_walk_in_metres_on_the_ground(path: Path) -> None:
    performance = load_motion(path)
    assert performance.notes == ()
    world = places(performance)
    hips = world[:, 0, [0, 2]]
    mean = np.linalg.norm(np.diff(hips, axis=0), axis=1).mean() * performance.clip.rate
    # The way of the hips also sways from side to side.
    assert mean == pytest.approx(SPEEDS[path.stem], rel=0.08)
    # Runners are in the air part of the time.
    assert abs(np.percentile(world[..., 1].min(axis=1), 10)) < 0.03
    assert 1.5 < np.median(np.ptp(world[..., 1], axis=1)) < 1.7
    assert (performance.skeleton.rest.rotations == rotations.IDENTITY).all()


@pytest.mark.skipif(not SAMPLES, reason="the real recordings are not here")
def test_acclaim_and_bvh_of_one_database_have_the_same_scale() -> None:
    """Thighs of two people of one database, one by each reader: within a tenth."""
    acclaim = load_motion(SAMPLES[0]).skeleton
    biovision = load_motion(DATA / "bvh" / "131_01.bvh").skeleton
    thighs = [
        np.linalg.norm(skeleton.rest.translations[skeleton.index(knee)])
        for skeleton, knee in ((acclaim, "ltibia"), (biovision, "LeftKnee"))
    ]
    assert thighs[0] == pytest.approx(thighs[1], rel=0.1)


def test_bones_tips_rate_and_units(tmp_path: Path) -> None:
    performance = load_motion(hopper(tmp_path))
    skeleton, clip = performance.skeleton, performance.clip
    assert skeleton.names == ("root", "leg", "foot", "head", "foot_end", "head_end")
    assert skeleton.parents == (-1, 0, 1, 0, 2, 3)
    assert (clip.name, clip.rate, len(clip)) == ("hopper", 120.0, 2)
    assert not clip.loop
    assert not clip.root_motion
    rest = [[0, 0, 0], [0, 0, 0], [0, -16, 0], [0, 0, 0], [0, 0, 4], [0, 12, 0]]
    np.testing.assert_allclose(skeleton.rest.translations, np.array(rest) * CMU_UNIT_M)
    assert_like_the_walk(tmp_path / "hopper.amc", looks=2)


@given(data=st.data())
@settings(max_examples=examples(25))
def test_any_axes_and_angles_agree_with_the_reference(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    angle = st.integers(-1800, 1800).map(lambda tenths: tenths / 10)
    draw = [data.draw(angle) for _ in range(10)]
    asf = ASF.replace("axis 0 0 90", f"axis {draw[0]} {draw[1]} {draw[2]}", 1)
    asf = asf.replace("axis 0 0 0 XYZ\n    dof rx", f"axis {draw[3]} {draw[4]} 0 XYZ\n    dof rx")
    amc = AMC.replace("leg 30 0 0", f"leg {draw[5]} {draw[6]} {draw[7]}")
    amc = amc.replace("0 90 0", f"{draw[8]} 90 {draw[9]}")
    assert_like_the_walk(hopper(tmp_path_factory.mktemp("axes"), asf, amc), looks=2)


def test_the_first_axis_listed_turns_first(tmp_path: Path) -> None:
    asf = ASF.replace("dof rx ry rz", "dof rz rx").replace("axis 0 0 90", "axis 0 0 0")
    amc = AMC.replace("leg 0 0 0", "leg 20 30").replace("leg 30 0 0", "leg 0 0")
    turned = load_motion(hopper(tmp_path, asf, amc)).clip.poses.rotations[0, 1]
    expected = rotation([20, 30], "zx")[:3, :3]
    np.testing.assert_allclose(rotations.to_matrix(turned), expected, atol=1e-12)


def test_radians_lengths_and_shifts(tmp_path: Path) -> None:
    asf = ASF.replace("dof rx\n", "dof rx tz l\n").replace("angle deg", "angle rad")
    asf = asf.replace("axis 0 0 90", f"axis 0 0 {math.pi / 2}")
    amc = AMC.replace(":DEGREES", ":RADIANS").replace("foot 0", "foot 0 0 0")
    amc = amc.replace("0 90 0\n", f"0 {math.pi / 2} 0\n").replace("foot -10", "foot 0 2 3")
    amc = amc.replace("leg 30", f"leg {math.pi / 6}")
    performance = load_motion(hopper(tmp_path, asf, amc), scale=1.0, up="y")
    degrees = load_motion(hopper(tmp_path), scale=1.0, up="y")
    np.testing.assert_allclose(places(performance)[:, 2][0], places(degrees)[:, 2][0], atol=1e-9)
    translations = performance.clip.poses.translations[1]
    np.testing.assert_allclose(translations[2], [0, -16, 2])
    np.testing.assert_allclose(translations[4], [0, 0, 7])
    turns = [motion.clip.poses.rotations[1, :2] for motion in (performance, degrees)]
    np.testing.assert_allclose(turns[0], turns[1], atol=1e-12)


def test_frames_may_list_bones_in_any_order_and_hold_comments(tmp_path: Path) -> None:
    plain = places(load_motion(hopper(tmp_path)))
    amc = AMC.replace("leg 30 0 0\nfoot -10\n", "foot -10 # down\n\nleg 30 0 0\n")
    np.testing.assert_array_equal(places(load_motion(hopper(tmp_path, amc=amc))), plain)
    np.testing.assert_array_equal(
        places(load_motion(hopper(tmp_path, amc=amc.replace("\n", "\r\n")))), plain
    )


def test_the_block_size_of_reading_does_not_matter(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    head = AMC.partition("1\n")[0]
    text = head + "".join(
        f"{number}\nroot {number / 7} 16 0 0 0 0\nleg {number} 0 0\nfoot 1\n"
        for number in range(1, 60)
    )
    whole = load_motion(hopper(tmp_path, amc=text)).clip.poses
    for block in (64, 97, 200):
        monkeypatch.setattr(amc, "BLOCK_CHARACTERS", block)
        pieces = load_motion(tmp_path / "hopper.amc").clip.poses
        np.testing.assert_array_equal(pieces.rotations, whole.rotations)
        np.testing.assert_array_equal(pieces.translations, whole.translations)
    np.testing.assert_allclose(whole.translations[:, 0, 0], np.arange(1, 60) / 7 * CMU_UNIT_M)


def test_bones_and_frames_missing_in_an_amc_are_noted(tmp_path: Path) -> None:
    amc = AMC.replace("foot 0\n", "").replace("foot -10\n", "").replace("\n2\n", "\n7\n")
    notes = " ".join(load_motion(hopper(tmp_path, amc=amc)).notes)
    assert "foot does not move" in notes
    assert "gaps" in notes


def test_an_implausible_stated_unit_is_ignored(tmp_path: Path) -> None:
    performance = load_motion(hopper(tmp_path, ASF.replace("length 0.45", "length 100")))
    assert any("1 unit is taken as" in note for note in performance.notes)
    assert 1.0 < np.ptp(places(performance)[0, :, 1]) < 2.5


def test_the_asf_is_found_by_name_or_alone_or_given(tmp_path: Path) -> None:
    path = hopper(tmp_path)
    number = path.rename(tmp_path / "07_01.amc")
    assert len(load_motion(number).clip) == 2  # the only .asf there
    (tmp_path / "other.asf").write_text("nonsense")
    with pytest.raises(CharacterError, match=r"07_01\.amc: .* 2 \.asf files, none of its name"):
        load_motion(number)
    (tmp_path / "hopper.asf").rename(tmp_path / "07.asf")
    assert len(load_motion(number).clip) == 2  # the performer's
    (tmp_path / "07.asf").rename(tmp_path / "elsewhere.asf")
    assert len(load_motion(number, skeleton=tmp_path / "elsewhere.asf").clip) == 2
    (tmp_path / "elsewhere.asf").unlink()
    (tmp_path / "other.asf").unlink()
    with pytest.raises(CharacterError, match=r"needs its skeleton, .* no \.asf file"):
        load_motion(number)
    with pytest.raises(CharacterError, match=r"cannot read the motion capture .*gone\.asf"):
        load_motion(number, skeleton=tmp_path / "gone.asf")
    with pytest.raises(CharacterError, match=r"a skeleton without motion"):
        load_motion(tmp_path / "hopper.asf")


def test_the_rate_is_given_or_stated_or_120_hz(tmp_path: Path) -> None:
    stated = AMC.replace(":DEGREES", ":DEGREES\n:SAMPLES-PER-SECOND 60")
    assert load_motion(hopper(tmp_path, amc=stated)).clip.rate == 60.0
    assert load_motion(tmp_path / "hopper.amc", rate=30.0).clip.rate == 30.0
    with pytest.raises(CharacterError, match="invalid rate of 0 frames"):
        load_motion(tmp_path / "hopper.amc", rate=0.0)
