"""The command line: its help, and one line for every error that the user can correct."""

import os
import re
import subprocess
import sys
import warnings
from importlib.metadata import version
from pathlib import Path

import pytest

from cubeling.app.cli import COMMANDS, load_command
from cubeling.app.workshop.scenario_templates import RULES
from cubeling.characters import Character, CharacterError, rendering
from cubeling.characters.errors import CharacterWarning
from cubeling.tracking import NoCameraError, TrackingError
from tests.characters.formats.built_gltf import Builder

COMMANDS_WITH_EXAMPLES = [
    ["demo"],
    ["play"],
    ["replay"],
    ["cube"],
    ["character", "inspect"],
    ["robot", "simulate"],
    ["robot", "list"],
    ["sounds"],
    ["doctor"],
]


@pytest.mark.parametrize("command", COMMANDS_WITH_EXAMPLES, ids=" ".join)
def test_every_help_has_an_example(cubeling, command):
    code, out, _ = cubeling(*command, "--help")
    assert code == 0
    assert "Example: cubeling" in out


def test_cubeling_without_arguments_shows_the_help(cubeling):
    code, out, err = cubeling()
    assert (code, err) == (0, "")
    assert "companion" in out


def test_the_help_imports_no_other_room_and_no_large_library():
    program = (
        "import sys; sys.argv = ['cubeling', '--help']\n"
        "from cubeling.app.entry import main\n"
        "try: main()\n"
        "except SystemExit as end: code = end.code\n"
        "large = {'affect', 'tracking', 'characters', 'robot', 'numpy', 'cv2', 'av', 'moderngl'}\n"
        "sys.exit(f'exit code {code}; imported: {large & sys.modules.keys()}')"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert "companion" in run.stdout
    assert run.stderr.strip() == "exit code 0; imported: set()"


@pytest.mark.parametrize("name", COMMANDS)
def test_the_list_of_commands_shows_the_first_sentence_of_their_help(name):
    first_paragraph = load_command(name).help.partition("\n\n")[0]
    assert COMMANDS[name] == " ".join(first_paragraph.split())


def test_the_list_of_commands_is_in_groups(cubeling):
    _, out, _ = cubeling("--help")
    headings = [line[:-1] for line in out.splitlines() if line.endswith(":") and line[0] != " "]
    assert headings == ["Play", "Make", "Study", "Robots", "Look", "Options"]
    places = [out.index(f"\n  {name} ") for name in COMMANDS]
    assert places == sorted(places)


def test_the_help_of_play_begins_with_the_ten_options_that_matter(cubeling):
    _, out, _ = cubeling("play", "--help")
    first = out.partition("\nOptions:\n")[2].partition("\n\n")[0]
    names = re.findall(r"^  (?:-\w, )?--([\w-]+)", first, re.MULTILINE)
    assert set(names) - {"help"} == {
        *("source", "cube", "character", "intrinsics", "robot", "record", "output", "overwrite"),
        *("personality", "language"),
    }
    assert out.index("\nOptions:\n") < out.index("\nThe character:\n") < out.index("--mqtt")


def test_a_unit_in_brackets_is_shown(cubeling):
    assert "Edge [mm]" in cubeling("cube", "--help")[1]


def test_only_a_terminal_gets_colours(cubeling):
    assert "\x1b" not in cubeling("--help")[1]


@pytest.mark.parametrize(
    ("line", "refused"),
    [
        ("speak hi --lang en -o a.abc", "a speech is written as"),
        ("speech show none.wav --lang=ca", "none.wav"),
        ("play companion --window-size wide", "1280x720, not as 'wide'"),
        ("calibrate --camera missing.mp4", "cannot read the video 'missing.mp4'"),
        ("gesture import none.bvh --from 1 --to 2 -o A", "none.bvh"),
        ("robot try sim --seconds 0 --settings x.toml", "a mood is held for 0.1"),
        ("replay none.mcap --from pose", "none.mcap"),
    ],
)
def test_former_spellings_are_still_understood(cubeling, line, refused):
    code, _, err = cubeling(*line.split())
    assert code == 2
    assert refused in err


@pytest.mark.parametrize(
    ("line", "former"),
    [
        ("speak", "--lang "),
        ("play", "--window-size"),
        ("calibrate", "--camera"),
        ("gesture import", "--from"),
        ("robot try", " --settings"),
    ],
)
def test_a_help_shows_one_spelling(cubeling, line, former):
    assert former not in cubeling(*line.split(), "--help")[1]


def test_the_version_is_that_of_the_package(cubeling):
    assert cubeling("--version") == (0, f"cubeling {version('cubeling')}\n", "")


@pytest.mark.parametrize(
    ("words", "completed"),
    [
        ("cubeling pl", "play"),
        ("cubeling robot co", "conform"),
        ("cubeling play --person", "--personality"),
        ("cubeling play comp", "companion"),
    ],
)
def test_the_shell_completes_commands_options_and_scenarios(
    cubeling, monkeypatch, words, completed
):
    monkeypatch.setenv("_CUBELING_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", words)
    monkeypatch.setenv("COMP_CWORD", str(len(words.split()) - 1))
    assert cubeling()[1].split() == [completed]


def test_only_the_whole_command_installs_completion(cubeling):
    assert "--install-completion" in cubeling("--help")[1]
    assert "completion" not in cubeling("robot", "--help")[1]


def test_an_unknown_command_is_one_line_that_suggests_a_known_one(cubeling):
    code, _, err = cubeling("docter")
    assert code == 2
    assert err.startswith("cubeling: No such command 'docter'. Did you mean 'doctor'?")


EQUAL_IDS = """
dictionary = "DICT_4X4_50"
edge_mm = 60
marker_mm = 45
[[face]]
name = "top"
marker_id = 3
[[face]]
name = "front"
marker_id = 3
"""
TOO_LARGE = EQUAL_IDS.replace("marker_mm = 45", "marker_mm = 61")


def wrong_inputs():
    """Return for each bad input its command and what the error message must name."""
    video = ["--output", "out.mp4", "--robot", "none"]
    return {
        "no such scenario": (["play", "dance"], "dance"),
        "no such camera": (["play", "follow", "-s", "camera:97", *video], "camera"),
        "not a video": (["play", "follow", "-s", "text.mp4", *video], "text.mp4"),
        "no such file": (["play", "follow", "-s", "absent.mp4", *video], "absent.mp4"),
        "not a session": (["replay", "text.mcap"], "text.mcap"),
        "no such session": (["replay", "absent.mcap"], "absent.mcap"),
        "equal ids": (["cube", "equal.toml"], "marker_id 3"),
        "marker too large": (["cube", "large.toml"], "61"),
        "no such cube": (["cube", "teapot"], "teapot"),
        "no such codec": (
            [
                "play",
                "companion",
                "-s",
                "SESSION",
                "--record",
                "new.mcap",
                "--codec",
                "vp8",
                "--no-pictures",
            ],
            "choose one of auto, jpeg, h264",
        ),
        "a graph over a file": (["character", "graph", "human", "-o", "old.dot"], "--overwrite"),
        "no such paper": (["cube", "companion", "--paper", "a9"], "a9"),
        "no skin": (["play", "follow", "--character", "bare.glb", *video], "skin"),
        "no such port": (
            ["replay", "SESSION", "--output", "out.mp4", "--robot", "/dev/absent"],
            "/dev/absent",
        ),
        "recording over a file": (
            ["play", "follow", "-s", "camera:97", "--record", "text.mcap", *video],
            "exists",
        ),
        "a recording that is none": (["play", "follow", "--record", "x.bag", *video], ".mcap"),
        "writing over a file": (["demo", "-o", "text.mp4"], "--overwrite"),
        "a folder as the video": (["demo", "-o", "."], "not a file"),
        "no such kind of video": (["demo", "-o", "x.avi"], ".mp4, .mkv, .webm, .gif, .png"),
        "a video without a suffix": (["replay", "SESSION", "-o", "video"], ".mp4, .mkv"),
        "a video without pictures": (
            ["replay", "SESSION", "-o", "x.mp4", "--no-pictures"],
            "without pictures",
        ),
        "a sheet that is a picture": (["cube", "companion", "-o", "x.png"], ".pdf"),
        "a sheet over a file": (["cube", "companion", "-o", "sheet.pdf"], "--overwrite"),
        "no such folder": (["play", "follow", "-s", "camera:97", "-o", "no/x.mp4"], "folder"),
        "no display": (["play", "follow"], "display"),
        "nonsense option": (["play", "follow", "--colour"], "--colour"),
        "nonsense number": (["play", "companion", "--turns", "many"], "--turns"),
    }


@pytest.mark.parametrize("case", wrong_inputs())
def test_bad_input_is_one_line_and_exit_code_2(cubeling, case, bundled_session):
    Path("text.mp4").write_text("not a video")
    Path("text.mcap").write_text("not a session")
    Path("sheet.pdf").write_text("not a sheet")
    Path("old.dot").write_text("not a graph")
    Path("equal.toml").write_text(EQUAL_IDS)
    Path("large.toml").write_text(TOO_LARGE)
    write_bare_glb(Path("bare.glb"))
    before = sorted(Path().iterdir())
    command, named = wrong_inputs()[case]
    command = [str(bundled_session) if word == "SESSION" else word for word in command]
    code, _, err = cubeling(*command)
    assert code == 2
    assert err.startswith("cubeling: ")
    assert err.count("\n") == 1
    assert named in err
    assert sorted(Path().iterdir()) == before, "something was left behind"


@pytest.mark.parametrize(
    ("scenario", "way"),
    [
        ("follow", "cubeling demo follow --recording"),
        ("talk", "cubeling talk"),
        ("hello.toml", "cubeling play hello.toml --source synthetic:companion"),
    ],
)
def test_who_has_no_camera_is_told_how_to_play_without(cubeling, monkeypatch, scenario, way):
    def refuse(uri):
        raise NoCameraError(f"{uri} does not exist")

    monkeypatch.setattr("cubeling.app.running.opening.open_source", refuse)
    Path("hello.toml").write_text(RULES)
    code, _, err = cubeling("play", scenario, "--no-pictures")
    assert code == 2
    assert err == f"cubeling: camera:0 does not exist; without a camera: {way}\n"


@pytest.mark.parametrize(
    ("chosen", "why"),
    [(["-o", "chosen.mp4"], "as --output asks"), ([], "as there is no display")],
)
def test_demo_says_why_it_renders_a_file(cubeling, monkeypatch, chosen, why):
    played = []
    monkeypatch.setattr(
        "cubeling.app.commands.play.progress.play_session", lambda *each, **_: played.append(each)
    )
    monkeypatch.setattr("cubeling.app.commands.play.demo.has_display", lambda: False)
    code, out, _ = cubeling("demo", *chosen)
    assert (code, len(played)) == (0, 1)
    assert why in " ".join(out.split())


@pytest.mark.parametrize("place", [0, 2, 4])
def test_debug_raises_the_error_wherever_it_stands(cubeling, place):
    command = ["play", "follow", "--cube", "nope.toml"]
    with pytest.raises(TrackingError, match=r"nope\.toml"):
        cubeling(*command[:place], "--debug", *command[place:])


def write_bare_glb(path):
    """Write a valid .glb that holds a triangle and no skin."""
    build = Builder()
    points = build.floats([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "VEC3")
    build.document["meshes"] = [{"primitives": [{"attributes": {"POSITION": points}}]}]
    build.document["nodes"] = [{"mesh": 0}]
    path.write_bytes(build.bytes())


def test_an_output_that_cannot_show_a_curve_shows_the_rest():
    script = (
        "from cubeling.app.cli import print_what_can_be_encoded as allow; allow(); print('mood ▄▅')"
    )
    environment = os.environ | {"PYTHONIOENCODING": "cp1252"}
    command = [sys.executable, "-c", script]
    result = subprocess.run(command, env=environment, capture_output=True, check=True)
    assert result.stdout.split() == [b"mood", b"??"]


def test_a_silent_port_is_one_line(cubeling, bundled_session):
    near, far = os.openpty()
    try:
        code, _, err = cubeling(
            "replay", bundled_session, "-o", "out.mp4", "--robot", os.ttyname(far)
        )
    finally:
        os.close(near)
        os.close(far)
    assert code == 2
    assert err.count("\n") == 1
    assert "answer" in err
    assert not list(Path().iterdir())


def test_the_bundled_characters_are_there():
    assert {"idle", "Walk", "Run"} <= set(Character.load("human").clips)
    assert {"idle", "kiss_head", "shout_tail"} <= set(Character.load("vleo").clips)


def test_the_doctor_lists_what_it_checked(cubeling):
    code, out, _ = cubeling("doctor", "--no-cameras")
    assert code == 0
    for name in ("Python", "OpenCV", "drawing", "recordings", "display"):
        assert name in out


def test_the_doctor_names_a_missing_driver_and_its_remedy(cubeling, monkeypatch):
    def fail():
        raise CharacterError("cannot draw: the library libEGL is missing")

    monkeypatch.setattr(rendering, "create_context", fail)
    monkeypatch.setattr("shutil.which", lambda tool: f"/usr/bin/{tool}")
    code, out, _ = cubeling("doctor", "--no-cameras")
    assert code == 2
    assert "libEGL is missing" in out
    assert "apt-get install -y libegl1" in out


def test_a_repaired_character_is_one_warning_line(cubeling, monkeypatch):
    def repaired():
        for _ in range(2):
            with warnings.catch_warnings():  # makes Python forget which warnings it has shown
                pass
            warnings.warn("x.glb: weights\ndid not sum to one", CharacterWarning, stacklevel=1)
        raise CharacterError("cannot draw")

    monkeypatch.setattr(rendering, "create_context", repaired)
    _, _, err = cubeling("doctor", "--no-cameras")
    assert err == "cubeling: x.glb: weights did not sum to one\n"


@pytest.mark.parametrize("wrong", [OSError(28, "No space left on device", "x.png"), MemoryError()])
def test_an_error_of_the_operating_system_is_one_line(cubeling, monkeypatch, wrong):
    def load(name):
        raise wrong

    monkeypatch.setattr(Character, "load", load)
    code, _, err = cubeling("character", "graph", "human")
    assert code == 2
    assert err.count("\n") == 1
    assert "x.png: No space left on device" in err or "memory" in err


def test_a_cube_sheet_is_written(cubeling):
    code, out, _ = cubeling("cube", "companion")
    assert code == 0
    assert Path("companion.pdf").read_bytes().startswith(b"%PDF")
    assert "companion.pdf" in out
