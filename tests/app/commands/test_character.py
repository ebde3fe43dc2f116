"""`cubeling character`: what it tells and draws, and what it refuses."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from cubeling.app.ui.contact_sheets import ContactSheets, save, trim
from cubeling.characters import Character, with_lent_motions
from cubeling.characters.formats import load_motion
from cubeling.characters.model.stick_figures import stick_figure
from cubeling.characters.rendering import create_context, draw_picture, standing_pose
from cubeling.characters.rendering.portrait import PAPER_BGR
from tools.cast import draw_cast

BVH = """HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT LeftUpLeg
  {
    OFFSET 0.1 -0.1 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 -0.8 0
    }
  }
  JOINT Spine
  {
    OFFSET 0 0.3 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 0.4 0
    }
  }
}
MOTION
Frames: 3
Frame Time: 0.1
0 0.9 0 0 0 0 0 0 0 0 0 0
0 0.9 0 0 0 0 0 20 0 0 10 0
0 0.9 0 0 0 0 0 0 0 0 0 0
"""


@pytest.fixture(scope="module")
def sheets():
    context = create_context()
    sheets = ContactSheets(context)
    yield sheets
    sheets.release()
    context.release()


def paper(picture):
    """Return which pixels nothing is drawn on."""
    return np.abs(picture.astype(int) - PAPER_BGR).max(axis=2) <= 6


@pytest.mark.slow(reason="a character is drawn from all sides")
def test_inspect_describes_and_draws_a_bundled_character(cubeling):
    code, out, err = cubeling("character", "inspect", "human", "-o", "seen")
    assert (code, err) == (0, "")
    for told in ("human, humanoid", "triangles", "leftLowerArm", "Walk", "left 6", "No problems"):
        assert told in out
    picture = cv2.imread("seen/turntable.png")
    assert picture is not None
    assert 0.5 < paper(picture).mean() < 0.95
    assert {path.name for path in Path("seen").iterdir()} == {"turntable.png", "faces.png"}
    assert "seen/turntable.png" in out


@pytest.mark.slow(reason="a character is written, read and drawn")
def test_a_person_without_motions_is_drawn_with_hanging_arms(cubeling, monkeypatch):
    replace(Character.load("human"), clips={}).save(Path("still.glb"))
    still = Character.load("still.glb")
    lent = with_lent_motions(still)
    seen = [
        ~paper(draw_picture(body, pose, azimuth=0.0))
        for body, pose in ((still, None), (lent, standing_pose(lent)), (still, still.skeleton.rest))
    ]
    # The shadow lies beside the legs.
    arms_hang, as_in_play, arms_spread = (
        np.ptp(np.flatnonzero(each[: len(each) * 55 // 100].any(axis=0))) for each in seen
    )
    assert arms_hang == as_in_play
    assert arms_hang < 0.7 * arms_spread
    drawn = []

    def turntable(_, body):
        drawn.append(body)
        return np.zeros((1, 1, 3), np.uint8)

    monkeypatch.setattr(ContactSheets, "turntable", turntable)
    code, _, err = cubeling("character", "inspect", "still.glb", "-o", "seen")
    assert (code, err) == (0, "")
    (body,) = drawn
    np.testing.assert_array_equal(standing_pose(body).rotations, standing_pose(lent).rotations)


@pytest.mark.slow(reason="a character is written, read and drawn")
def test_long_names_of_clips_are_shown_whole(cubeling, monkeypatch):
    name = "Armature|" + "".join(chr(97 + number % 26) for number in range(71))
    monkeypatch.setenv("COLUMNS", "80")
    human = Character.load("human")
    clip = replace(human.clips["Walk"], name=name)
    replace(human, clips={name: clip}).save(Path("named.glb"))
    code, out, _ = cubeling("character", "inspect", "named.glb")
    assert code == 0
    assert [path.name for path in Path().iterdir()] == ["named.glb"]  # nothing else was asked for
    table = out[out.index("Clips") : out.index("None of its motions")].splitlines()
    heading = next(line for line in table if "seconds" in line)
    assert "speed [m/s]" in " ".join(table)
    first_column = [line[: heading.index("seconds")].strip() for line in table]
    assert name in "".join(first_column)


def test_a_motion_without_a_body_is_drawn_as_sticks(cubeling):
    Path("nod.bvh").write_text(BVH)
    code, out, err = cubeling("character", "inspect", "nod.bvh")
    assert (code, err) == (0, "")
    assert "0.20" in out
    assert "once" in out
    assert not Path("nod-pictures").exists()
    assert cubeling("character", "inspect", "nod.bvh", "--clips")[0] == 0
    assert {path.name for path in Path("nod-pictures").iterdir()} == {"turntable.png", "clips.png"}


def test_inspect_accepts_unit_and_vertical_axis(cubeling):
    Path("nod.bvh").write_text(BVH)
    for scale, tall in (("1", "1.64 m tall"), ("0.01", "0.0164 m tall")):
        code, out, _ = cubeling("character", "inspect", "nod.bvh", "--scale", scale, "--up", "y")
        assert code == 0
        assert tall in out


@pytest.mark.parametrize(
    ("file", "content", "named"),
    [
        ("absent.glb", None, "absent.glb"),
        ("nobody", None, "nobody"),
        ("text.glb", "not a model", "text.glb"),
        ("cut.bvh", BVH[:200], "cut.bvh"),
        ("alone.amc", ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 0 0 0 0 0\n", "asf"),
        ("picture.png", "…", "picture.png"),
    ],
)
def test_unreadable_files_are_refused_in_one_line(cubeling, file, content, named):
    if content is not None:
        Path(file).write_text(content)
    code, _, err = cubeling("character", "inspect", file)
    assert code == 2
    assert err.startswith("cubeling: ")
    assert err.count("\n") == 1
    assert named in err
    assert [path.name for path in Path().iterdir()] == ([file] if content is not None else [])


def test_a_file_in_place_of_the_output_folder_is_refused(cubeling):
    Path("taken").write_text("")
    code, _, err = cubeling("character", "inspect", "human", "-o", "taken")
    assert code == 2
    assert err.count("\n") == 1
    assert "taken is a file" in err


def test_names_that_look_like_markup_are_printed_literally(cubeling, tmp_path):
    Path("[b]old[.bvh").write_text(BVH.replace("Spine", "[red]Spine"))
    code, out, _ = cubeling("character", "inspect", "[b]old[.bvh", "--clips")
    assert code == 0
    assert "[red]Spine" in out
    assert out.startswith("[b]old[, ")
    assert "[b]old[-pictures/turntable.png" in out


def test_rows_of_a_sheet_are_clips_one_below_the_other(sheets):
    human = Character.load("human")
    clips = list(human.clips.values())[:2]
    one, two = sheets.clips(human, clips[:1]), sheets.clips(human, clips)
    assert one.shape[1] == two.shape[1]
    assert two.shape[0] > 1.5 * one.shape[0]
    assert np.array_equal(one[:150], two[:150])


def test_each_morph_has_a_face(sheets):
    human = Character.load("human")
    names = human.morphs[:2]
    rest = replace(human.skeleton.rest, morphs=None)
    shy = replace(human, morphs=names, clips={}, skeleton=replace(human.skeleton, rest=rest))
    faces = np.split(sheets.faces(shy)[62:-42, 16:-16], 3, axis=1)
    assert all((paper(face).mean() < 0.8) for face in faces)
    assert not np.array_equal(faces[0], faces[1])


def test_empty_margins_are_trimmed():
    picture = np.full((100, 20, 3), PAPER_BGR, np.uint8)
    assert trim(picture).shape == picture.shape
    picture[40:50] = 0
    assert trim(picture).shape == (30, 20, 3)


def test_pictures_are_written_as_small_as_asked(tmp_path):
    noise = np.random.default_rng(1).integers(0, 255, (200, 200, 3), np.uint8)
    save(noise, tmp_path / "large.jpg")
    save(noise, tmp_path / "small.jpg", 30_000)
    assert (tmp_path / "small.jpg").stat().st_size <= 30_000 < 40_000
    assert (tmp_path / "large.jpg").stat().st_size > 30_000


def test_the_cast_is_drawn_in_small_files(tmp_path):
    Path(tmp_path / "nod.bvh").write_text(BVH)
    motion = load_motion(tmp_path / "nod.bvh")
    character = stick_figure("nod", motion.skeleton, [motion.clip])
    files = list(draw_cast([character], tmp_path / "cast"))
    assert [path.name for path in files] == ["nod.jpg", "nod-clips-1.jpg"]
    assert all(1_000 < path.stat().st_size < 300_000 for path in files)


def a_character_beside(text):
    """Write a character, and beside it a file of motions."""
    human = Character.load("human")
    replace(human, clips={"idle": human.clips["idle"]}).save("one.glb")
    Path("one.toml").write_text(text, encoding="utf-8")


def test_a_graph_shows_names_as_they_are(cubeling):
    name = "[/red] & <b>"
    a_character_beside(f"play = 'x'\n[motions]\n\"{name}\" = {{kind = 'loop', of = 'idle'}}\n"
                       f"x = {{kind = 'loop', of = \"{name}\"}}\n")  # fmt: skip
    code, out, err = cubeling("character", "graph", "one.glb", "-o", "[x] one.dot")
    assert (code, err) == (0, "")
    assert name in out
    assert "[x] one.dot is written" in out
    assert f'"{name}\\nloop"' in Path("[x] one.dot").read_text(encoding="utf-8")


def test_graph_refuses_an_invalid_plan(cubeling):
    a_character_beside("play = {kind = 'stretch', of = 'idle', seconds = -1}")
    code, _, err = cubeling("character", "graph", "one.glb", "-o", "one.dot")
    assert code == 2
    assert err == "cubeling: one.toml: play: stretch to -1.0 s; give a positive duration\n"
    assert not Path("one.dot").exists()
