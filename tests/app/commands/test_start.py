"""Helps and wrong arguments: nothing heavy is loaded for them."""

import json
import os
import subprocess
import sys

import pytest

HEAVY = ("numpy", "cv2", "av", "moderngl", "pydantic", "mcap", "paho", "serial", "scipy", "PIL")

WRONG = {
    "play nosuch": "no scenario is called 'nosuch'",
    "play compagnon": "did you mean companion?",
    "play companion --realism x": "a picture cannot follow 'x'",
    "play companion --inside x": "the character cannot be inside 'x'",
    "play companion --quality x": "there is no quality 'x'",
    "play companion --controller x": "no controller is called 'x'",
    "play companion --record a.mcap --codec x": "a session cannot hold 'x' pictures",
    "play companion -o a.mp4 --codec x": "a .mp4 video cannot hold 'x' pictures",
    "play companion --codec x": "a session cannot hold 'x' pictures",
    "schedule any.xml -o a.bvh --codec libx264": "a.bvh is no video: leave out --codec",
    "play companion --record a.avi": "a recording is written as .mcap",
    "play companion -o x.abc": "a video is written as .mp4",
    "play companion -o there.mp4": "exists already",
    "play companion --profile missing.toml": "missing.toml",
    "play companion --profile loud": "there is no profile 'loud'",
    "play companion --set volume=1": "volume means nothing here",
    "play companion --panels weather": "there is no panel 'weather'",
    "replay missing.mcap": "cannot read the session 'missing.mcap'",
    "replay there.mp4": "is not a session",
    "replay begun.mcap --scenario nosuch": "no scenario is called 'nosuch'",
    "replay begun.mcap --controller x": "no controller is called 'x'",
    "replay begun.mcap --quality x": "there is no quality 'x'",
    "replay begun.mcap -o there.mp4": "exists already",
    "demo nosuch": "no scenario is called 'nosuch'",
    "play companion --look x": "the character cannot look at 'x'",
    "play companion --speed-map x": "no speed map is called 'x'",
    "play companion --turns 99": "the turns must be from 0.1 to 20, not 99",
    "play companion --personality x": "there is no personality 'x'",
    "play companion --language xx": "there are no lines in 'xx'",
    "play companion --lines x.toml": "cannot read the lines 'x.toml'",
    "play companion --character x.glb": "cannot read the character 'x.glb'",
    "play companion --motions x.bvh": "cannot read the motion 'x.bvh'",
    "play companion --idle x.idle": "cannot read the idle motion 'x.idle'",
    "play companion --intrinsics x.yaml": "cannot read the camera file 'x.yaml'",
    "play companion --robot-settings x.toml": "cannot read the robot settings 'x.toml'",
    "play companion --sounds x": "there are no .wav files in a folder 'x'",
    "play companion --source x.mp4": "cannot read the video 'x.mp4'",
    "play companion --size 20x10": "the window must be at least 320x180",
    "play companion --player ann": "--player needs --mqtt URL",
    "replay begun.mcap --personality x": "there is no personality 'x'",
    "speak": "there is nothing to say",
    "speak hi --emotion x": "no emotion is called 'x'",
    "speak hi --size x": "a window's size is given as 1280x720, not as 'x'",
    "speak hi -o a.abc": "a speech is written as",
    "speak --file x.txt": "cannot read the text 'x.txt'",
    "speak hi --audio x.wav": "cannot read the sound 'x.wav'",
    "behave": "there is nothing to perform",
    "behave x.bml": "cannot read the document 'x.bml'",
    "calibrate --source x.mp4": "cannot read the video 'x.mp4'",
    "calibrate -o x.abc": "a camera is written as",
    "gesture learn x.bvh": "cannot read the motion 'x.bvh'",
    "idle learn x.bvh": "cannot read the motion 'x.bvh'",
    "motions build x.bvh": "cannot read the motion 'x.bvh'",
    "mood plot x.mcap": "cannot read the session 'x.mcap'",
    "schedule x.xml": "cannot read the schedule 'x.xml'",
    "latency --scenario nosuch": "no scenario is called 'nosuch'",
    "schedule any.xml -o x.abc": "a schedule is written as",
    "idle learn any.bvh -o x.abc": "an idle motion is written as",
    "robot nosuch": "No such command",
}
"""Command lines, and what is said of each."""

RUN = """
import contextlib, functools, io, json, sys
from cubeling.app import cli

cli.load_command = functools.cache(cli.load_command)  # to make them takes longer than to run them

def run(arguments):
    sys.argv = ["cubeling", *arguments]
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            cli.main()
        except SystemExit as end:
            code = end.code
    heavy = [name for name in json.loads(sys.argv_given[1]) if name in sys.modules]
    return code, out.getvalue(), err.getvalue(), heavy

sys.argv_given = sys.argv
groups = [(name, list(getattr(cli.load_command(name), "commands", ()))) for name in cli.COMMANDS]
lines = [[]] + [[name, *more] for name, ones in groups for more in ([], *([each] for each in ones))]
helps = {" ".join(line): run([*line, "--help"]) for line in lines}
wrong = {line: run(line.split()) for line in json.loads(sys.argv_given[2])}
print(json.dumps([helps, wrong]))
"""
"""Runs every help and then every wrong line in one process, as starting one is what takes long."""


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """What every help and every wrong line returned, printed and loaded."""
    folder = tmp_path_factory.mktemp("start")
    (folder / "there.mp4").write_bytes(b"no session")
    (folder / "begun.mcap").write_bytes(b"\x89MCAP0\r\n")
    command = [sys.executable, "-c", RUN, json.dumps(HEAVY), json.dumps(list(WRONG))]
    environment = {**os.environ, "COLUMNS": "200"}
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=True
    )
    return json.loads(done.stdout)


@pytest.mark.slow(reason="a program prints every help")
def test_no_help_loads_what_only_the_work_needs(ran):
    helps, _ = ran
    assert len(helps) > 40
    for line, (code, out, err, heavy) in helps.items():
        assert (line, code, err, heavy) == (line, 0, "", [])
        assert f"Usage: cubeling {line}".rstrip() in out


@pytest.mark.parametrize("line", WRONG)
def test_a_wrong_argument_is_refused_before_it_is_loaded(ran, line):
    code, _, err, heavy = ran[1][line]
    assert (code, heavy) == (2, [])
    assert WRONG[line] in err
    assert err.count("\n") == 1


def test_every_line_of_a_help_fits_80_columns(ran):
    helps, _ = ran
    for text in (out for _, out, _, _ in helps.values()):
        assert max(map(len, text.splitlines())) <= 80
