"""The code of the README runs as it stands, and its first line fetches a repository."""

import csv
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageSequence

from cubeling.app.ui.video_file import VideoFile
from cubeling.tracking import open_source

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text("utf-8")
MOST_WORDS = 1000
"""The page is for the first five minutes."""


def block(name):
    """Return the code after a mark."""
    (code,) = re.findall(rf"<!-- tested: {name} -->\n```python\n(.*?)^```", README, re.S | re.M)
    return code


def test_the_page_is_short():
    assert len(README.split()) <= MOST_WORDS


@pytest.mark.full
@pytest.mark.slow(reason="it draws a picture and a clip, as the page does")
def test_a_picture_and_a_clip_are_drawn(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code = block("draw")
    assert len(code.strip().splitlines()) <= 8
    exec(compile(code, "README.md", "exec"), {})
    picture = np.asarray(Image.open("human.png"))
    paper = picture[0, 0].astype(int)
    assert 0.05 < (np.abs(picture - paper).max(axis=2) > 40).mean() < 0.6, "somebody is there"
    with Image.open("nod.gif") as clip:
        frames = [np.asarray(f.convert("RGB")).astype(int) for f in ImageSequence.Iterator(clip)]
    assert len(frames) > 10
    moved = np.abs(frames[len(frames) // 3] - frames[0]).max(axis=2) > 30
    assert 0.0005 < moved.mean() < 0.2, "the head moves, and the body stays"


@pytest.mark.slow(reason="it writes a video and tracks a cube in it, as the page does")
def test_a_video_becomes_a_table_of_poses(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with open_source(str(ROOT / "recordings/companion.mcap")) as source:
        frames = [frame for frame, _ in zip(source, range(8), strict=False)]
    with VideoFile(Path("take.mp4"), frames[0].image.shape[1::-1], 30.0) as video:
        for frame in frames:
            video.write(frame.image, frame.timestamp)
    code = block("track")
    assert len(code.strip().splitlines()) == 3, "one import, and one line"
    (named,) = re.findall(r'track_video\("([^"]*)"', code)
    assert (ROOT / named).is_file(), "everybody who cloned has it"
    with open_source(str(ROOT / named)) as source:
        assert not source.live
    exec(compile(code.replace(named, "take.mp4"), "README.md", "exec"), {})  # a few frames of it
    with Path("poses.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(frames)
    assert {row["verdict"] for row in rows} == {"trusted"}
    turns = np.array([[float(row[key]) for key in ("qx", "qy", "qz", "qw")] for row in rows])
    assert np.linalg.norm(turns, axis=1) == pytest.approx(1.0, abs=1e-6)
    assert 0.2 < float(rows[0]["z_m"]) < 2.0


def test_the_line_that_clones_can_be_copied(tmp_path):
    (line,) = re.findall(r"^```sh\n(.*git clone.*)\n```", README, re.MULTILINE)
    source = tmp_path / "source"
    git = ["git", "-C", str(source), "-c", "user.name=a", "-c", "user.email=a@b"]
    subprocess.run(["git", "init", "-q", str(source)], check=True)
    (source / "Makefile").write_text("demo:\n")
    subprocess.run([*git, "add", "-A"], check=True)
    subprocess.run([*git, "commit", "-qm", "x"], check=True)
    subprocess.run(
        ["sh", "-c", f"{line} && test -f Makefile"],
        cwd=tmp_path,
        input=f"file://{source}\n",
        text=True,
        check=True,
        capture_output=True,
    )
    assert (tmp_path / "cubeling" / "Makefile").is_file()
