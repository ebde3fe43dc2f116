"""Every preference is an option of the commands that open a window."""

from dataclasses import fields

import pytest

from cubeling.app.commands.play.preference_options import FLAGS
from cubeling.app.preferences import Preferences


def test_every_preference_has_an_option():
    """But for whether the player was welcomed: the program knows."""
    assert {*FLAGS, "welcomed"} == {field.name for field in fields(Preferences)}


@pytest.mark.parametrize("command", ["play", "replay", "demo"])
def test_a_command_with_a_window_lists_them(cubeling, command):
    code, out, _ = cubeling(command, "--help")
    assert code == 0
    for flag in FLAGS.values():
        assert flag.name.split("/")[0] in out
    assert "--no-preferences" in out


def test_without_a_window_no_file_is_read_or_written(cubeling, short_session, tmp_path):
    file = tmp_path / "preferences.toml"
    file.write_text("this is broken")
    code, out, err = cubeling(
        "replay", short_session, "--no-pictures", "--preferences", file, "--full-screen"
    )
    assert code == 0
    assert "preferences" not in out + err
    assert file.read_text() == "this is broken"


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (("--size", "wide"), "1280x720"),
        (("--size", "20x10"), "at least 320x180"),
        (("--panels", "weather"), "choose from tracking, scenario"),
    ],
)
def test_a_wrong_value_is_refused(cubeling, short_session, given, words):
    code, _, err = cubeling("replay", short_session, "--no-pictures", *given)
    assert code == 2
    assert words in err
    assert err.count("\n") == 1
