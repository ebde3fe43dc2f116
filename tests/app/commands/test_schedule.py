"""`cubeling schedule`."""

import shutil
from pathlib import Path

import av
import numpy as np
import pytest

from cubeling.app.commands.make.schedule import read_schedule
from cubeling.bad_input import BadInputError
from cubeling.characters import Character, load_motion

EXAMPLES = Path(__file__).parents[3] / "docs" / "schedules"


@pytest.mark.parametrize(
    ("name", "rate", "frames"),
    [("copy", "25", 226), ("copy", "10", 91), ("stretch", "25", 126), ("endless", "25", 91)],
)
def test_the_examples_become_motions(cubeling, tmp_path, name, rate, frames) -> None:
    code, out, _ = cubeling(
        "schedule", str(EXAMPLES / f"{name}.xml"), "-o", "a.bvh", "--rate", rate
    )
    assert code == 0
    assert f"a.bvh is written: {frames} frames" in out
    assert len(load_motion(tmp_path / "a.bvh", scale=1.0).clip) == frames


@pytest.mark.slow(reason="a character is written, and a film")
def test_it_writes_characters_and_films(cubeling, tmp_path) -> None:
    schedule = str(EXAMPLES / "fade.xml")
    assert cubeling("schedule", schedule, "-o", "fade.glb")[0] == 0
    assert Character.load(tmp_path / "fade.glb").clips["fade"].duration == pytest.approx(9.0)
    short = ("-o", "fade.mp4", "--seconds", "0.5", "--rate", "10")
    assert cubeling("schedule", schedule, *short)[0] == 0
    with av.open(str(tmp_path / "fade.mp4")) as film:
        assert len(list(film.decode(video=0))) == 6


def test_motions_are_found_beside_the_schedule(cubeling, tmp_path) -> None:
    (tmp_path / "own").mkdir()
    text = (EXAMPLES / "copy.xml").read_text().replace("human#idle", "mine.bvh")
    (tmp_path / "own" / "copy.xml").write_text(text)
    cubeling("schedule", str(EXAMPLES / "stretch.xml"), "-o", "first.bvh")
    shutil.move(tmp_path / "first.bvh", tmp_path / "own" / "mine.bvh")
    code, out, _ = cubeling("schedule", "own/copy.xml", "-o", "second.bvh")
    assert code == 0
    assert "126 frames, 5.00 s" in out


@pytest.mark.slow(reason="three characters are written")
def test_a_gesture_moves_what_depends_on_it(cubeling, tmp_path) -> None:
    plain = (EXAMPLES / "copy.xml").read_text().replace("idle", "wave")
    own = '<blendableobject type="keyframebodyanimation">human#wave</blendableobject>'
    for kind in ("dependentjoints", "selfcollision"):
        modified = f'<blendableobject type="modifier"><modifier type="{kind}"/>{own}'
        text = plain.replace(own, f"{modified}</blendableobject>")
        (tmp_path / f"{kind}.xml").write_text(text)
        assert cubeling("schedule", f"{kind}.xml", "-o", f"{kind}.glb", "--rate", "5")[0] == 0
    (tmp_path / "plain.xml").write_text(plain)
    cubeling("schedule", "plain.xml", "-o", "plain.glb", "--rate", "5")
    clips = {n: Character.load(tmp_path / f"{n}.glb").clips[n].poses.rotations
             for n in ("plain", "dependentjoints", "selfcollision")}  # fmt: skip
    human = Character.load("human")
    spine, leg = (human.anatomy.joints[part] for part in ("spine", "leftUpperLeg"))
    assert not np.allclose(clips["plain"][:, spine], clips["dependentjoints"][:, spine], atol=1e-3)
    assert np.allclose(clips["plain"][:, leg], clips["dependentjoints"][:, leg], atol=1e-6)
    assert np.allclose(clips["plain"][:, leg], clips["selfcollision"][:, leg], atol=1e-6)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<a>", "bad.xml:1: not XML"),
        (
            (EXAMPLES / "copy.xml").read_text().replace("human#idle", "no.bvh"),
            "bad.xml:5: cannot read the motion",
        ),
        ((EXAMPLES / "copy.xml").read_text().replace("activate", "start"), "<start> is not known"),
        ((EXAMPLES / "copy.xml").read_text().replace("0.0f", "1e12"), "ends at 1e+12 s; give"),
        ((EXAMPLES / "copy.xml").read_text().replace("0.0f", "-50"), "ends at -41 s"),
        (
            (EXAMPLES / "endless.xml").read_text().replace(">human<", ">vleo<"),
            "bad.xml:10: vleo and human have different bodies",
        ),
    ],
)
def test_refuses_in_one_line(cubeling, tmp_path, text, message) -> None:
    (tmp_path / "bad.xml").write_text(text)
    code, _, error = cubeling("schedule", "bad.xml")
    assert code == 2
    assert message in error
    assert error.count("\n") == 1
    assert not (tmp_path / "schedule.bvh").exists()


def test_a_name_that_no_file_can_have_is_refused_as_any_other(tmp_path) -> None:
    text = (EXAMPLES / "copy.xml").read_text().replace("human#idle", "x" * 300)
    (tmp_path / "bad.xml").write_text(text)
    with pytest.raises(BadInputError, match="xxx"):
        read_schedule(tmp_path / "bad.xml")


def test_a_file_that_many_actions_name_is_read_once(tmp_path, monkeypatch) -> None:
    action = """<blendingaction id="{0}"><blendingparams type="joints"><default weight="1.0"/>
    </blendingparams><blendableobject type="keyframebodyanimation">human#{1}</blendableobject>
    </blendingaction>"""
    clips = "idle", "wave", "nod"
    pool = "".join(action.format(number, clips[number % 3]) for number in range(30))
    order = "".join(f'<activate id="{number}" offset="0.0"/>' for number in range(30))
    path = tmp_path / "many.xml"
    path.write_text(f"<blendingschedule><actionpool>{pool}</actionpool>{order}</blendingschedule>")
    human, read = Character.load("human"), []

    def load(name):
        read.append(name)
        return human

    monkeypatch.setattr(Character, "load", staticmethod(load))
    assert len(read_schedule(path, human).actions) == 30
    assert read == ["human"]
