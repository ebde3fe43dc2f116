"""`cubeling gesture`."""

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner

from cubeling.app.commands.make import gesture
from cubeling.app.errors import AppError
from cubeling.app.workshop.gesture_editor.preview import Preview, PreviewedGesture
from cubeling.characters import Character, Clip, Pose
from cubeling.characters.behaviour.gestures.collection import GestureCollection
from cubeling.characters.behaviour.gestures.files import load_gesture, save_gesture
from cubeling.characters.errors import CharacterError


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Run a command of the group with a folder of gestures; return what it prints."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)

    def invoke(*arguments):
        folder = ("--folder", str(tmp_path / "gestures"))
        result = CliRunner().invoke(gesture.app, [*map(str, arguments), *folder])
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            raise result.exception
        assert result.exit_code == 0, result.output
        return result.output

    return invoke


def test_lists_all_gestures_and_says_which_are_yours(run, tmp_path):
    collection = GestureCollection.load_bundled()
    save_gesture(collection.get("WAVE"), tmp_path / "gestures" / "wave.toml")
    lines = run("list").splitlines()
    for name in collection.names:
        assert any(line.split()[:1] == [name] for line in lines), name
    assert [line.split()[0] for line in lines if "yours" in line] == ["WAVE"]


def test_shows_phases_and_keys_and_draws_a_sheet(run, tmp_path):
    shown = run("show", "wave", "-c", "robot", "-o", "wave.png")
    for words in ("preparation", "stroke", "hold", "retraction", "right hand"):
        assert words in shown
    picture = cv2.imread(str(tmp_path / "wave.png"))
    assert picture is not None
    assert picture.shape[1] > 1000


def test_a_misspelt_name_is_corrected(run):
    with pytest.raises(CharacterError, match="did you mean WAVE"):
        run("show", "WAEV")


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """The robot claps: a clip made by the layer that performs gestures."""
    robot = Character.load("robot")
    preview = Preview(None)
    performance = PreviewedGesture(GestureCollection.load_bundled().get("CLAP"), "right", "robot")
    times = np.arange(0.0, performance.cycle, 1 / 30)
    poses = [preview.pose(performance, float(time)).pose for time in times]
    path = tmp_path_factory.mktemp("recordings") / "claps.glb"
    clip = Clip("clap", 30.0, Pose.of_frames(poses), loop=False)
    Character("claps", robot.skeleton, {"clap": clip}, robot.meshes, morphs=robot.morphs).save(path)
    return path


def test_a_gesture_is_imported_under_a_name(run, recording, tmp_path):
    run("import", recording, "-o", "my clap")
    gesture = load_gesture(tmp_path / "gestures" / "my_clap.toml")
    assert gesture.name == "MY_CLAP"
    assert gesture.right
    assert gesture.left
    with pytest.raises(AppError, match="--overwrite"):
        run("import", recording, "-o", "my clap")


def test_a_gesture_is_imported_into_a_file(run, recording, tmp_path):
    run("import", recording, "--from", "0.3", "-o", "clap2.toml")
    assert load_gesture(tmp_path / "clap2.toml").name == "CLAP2"


@pytest.mark.parametrize("span", [("2", "1"), ("100", "101"), ("nan", "1")])
def test_a_span_that_is_none_is_refused(run, recording, span):
    with pytest.raises(AppError, match=r"span|start before"):
        run("import", recording, "--from", span[0], "--to", span[1])


def test_the_editor_needs_a_display(run):
    with pytest.raises(AppError, match="display"):
        run("edit", "WAVE")
