"""Files of a person: only regular ones, of a limited size, are read; they are written whole."""

import ast
import errno
import os
import sys
from pathlib import Path

import pytest

from cubeling.files import KINDS, FileKind, whole_file, write_whole


class RoomError(Exception):
    """The error of some room."""


@pytest.fixture
def notes():
    kind = FileKind("note", (".txt",), RoomError, 8, "pathlib:Path.read_text")
    yield kind
    KINDS.remove(kind)


def refusal(do, *what) -> str:
    with pytest.raises(RoomError) as caught:
        do(*what)
    line = str(caught.value)
    assert line.isprintable()
    return line


def test_a_file_is_read_up_to_its_limit(notes, tmp_path):
    path = tmp_path / "a.txt"
    path.write_bytes(b"\xef\xbb\xbf12345")
    assert notes.read_text(path) == "12345"
    path.write_bytes(b"123456789")
    assert refusal(notes.read, path).endswith("it has 9 bytes, of at most 8 bytes")
    path.write_bytes(b"\xff")
    assert "not UTF-8 (byte 0)" in refusal(notes.read_text, path)


@pytest.mark.skipif(sys.platform == "win32", reason="there are no such files")
def test_what_may_never_end_is_not_opened(notes, tmp_path):
    os.mkfifo(tmp_path / "pipe.txt")
    (tmp_path / "loop.txt").symlink_to("loop.txt")
    (tmp_path / "zero.txt").symlink_to("/dev/zero")
    for name in ("pipe.txt", "zero.txt", "."):
        assert refusal(notes.open, tmp_path / name).endswith("give a file")
    for name in ("loop.txt", "none.txt", "a\0b", "a\nb", "x" * 5000):
        assert refusal(notes.open, tmp_path / name).startswith("cannot read the note ")


@pytest.mark.skipif(not Path("/proc/self/maps").exists(), reason="a file of Linux")
def test_a_file_that_does_not_know_its_size_is_read_up_to_its_limit(notes):
    assert "more than 8 bytes" in refusal(notes.read, "/proc/self/maps")


def test_an_error_while_writing_leaves_what_was_there(tmp_path):
    path = tmp_path / "a.txt"
    write_whole(path, "old", RoomError)

    def write_half(error) -> None:
        with whole_file(path, RoomError) as partial:
            partial.write_text("half")
            raise error

    for error in (KeyboardInterrupt, ValueError):
        with pytest.raises(error):
            write_half(error)
    assert [each.name for each in tmp_path.iterdir()] == ["a.txt"]
    assert path.read_text() == "old"


def test_a_full_disk_is_said_in_one_line_with_the_file(tmp_path):
    path = tmp_path / "a.txt"

    def fill() -> None:
        with whole_file(path, RoomError) as partial:
            partial.write_text("half")
            raise OSError(errno.ENOSPC, "No space left on device")

    assert refusal(fill) == f"cannot write '{path}': No space left on device"
    assert not list(tmp_path.iterdir())
    missing = tmp_path / "none" / "a.txt"
    assert refusal(write_whole, missing, b"x", RoomError).startswith(f"cannot write '{missing}'")


@pytest.mark.skipif(sys.platform == "win32", reason="links need a right there")
def test_a_link_stays_one(tmp_path):
    (tmp_path / "link.txt").symlink_to(tmp_path / "a.txt")
    write_whole(tmp_path / "link.txt", "new", RoomError)
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "a.txt").read_text() == "new"


# --- One way to open a file -----------------------------------------------------------------------

OPENERS = {"read_text", "read_bytes", "write_text", "write_bytes", "imread", "imwrite", "fromfile"}

OPENED = {"path", "file", "table", "target", "place", "io", "av", "wave", "Image", "zipfile"}
"""What has a method `open` that opens a file of a name."""

OTHERWISE = {
    "affect/personality_file.py": "a file of the program",
    "app/pipeline/registry.py": "what installed packages say of themselves",
    "app/running/kept_lens.py": "what the system calls a camera",
    "app/session/recorder.py": "written as it goes, so that a kill loses nothing",
    "app/sound/bank.py": "the unfinished file of `whole_file`",
    "app/ui/panels/drawing/style.py": "a font for a library that takes no other",
    "app/ui/playback/scenario_card.py": "files of the program",
    "app/ui/web/certificate.py": "a key that nobody else may read, from its first byte on",
    "app/ui/web/page.py": "files of the program",
    "app/ui/video_file.py": "written as `.partial`, and renamed",
    "app/workshop/exporting/writing.py": "the unfinished files of `whole_file`",
    "app/workshop/study/window/film_sound.py": "FFmpeg opens what `STIMULUS_FILE` has checked",
    "characters/formats/gltf/materials.py": "a picture in memory",
    "characters/rendering/programs.py": "a file of the program",
    "characters/speech/audio.py": "FFmpeg opens what `SOUND_FILE` has opened",
    "characters/speech/recognition.py": "a network for a library that takes no other",
    "cubeling/faces.py": "a file of the program",
    "cubeling/toml_file.py": "a file of the program",
    "tracking/sources/streams/rtsp.py": "an address",
    "tracking/sources/video.py": "FFmpeg opens what `VIDEO_FILE` has checked",
}
"""Modules that open files by themselves, and why."""


def test_the_rooms_open_files_in_one_way():
    tree = Path(__file__).parents[1]
    found = set()
    for room in ("affect", "tracking", "characters", "robot", "app", "cubeling"):
        for path in (tree / room).rglob("*.py"):
            name = path.relative_to(tree).as_posix()
            if "firmware" not in name and name != "cubeling/files.py" and _opens(path):
                found.add(name)
    assert found == set(OTHERWISE)


def _opens(path: Path) -> bool:
    """Return whether a module opens files by other means than `cubeling.files`."""
    text = path.read_text("utf-8")
    if not any(f"{name}(" in text for name in (*OPENERS, "open")):
        return False  # parsing all of them takes two seconds
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, ast.Call):
            continue
        if isinstance(node.func, ast.Name) and node.func.id == "open":
            return True
        if isinstance(node.func, ast.Attribute):
            by = ast.unparse(node.func.value).rpartition(".")[2]
            if by == "partial" or by.endswith("_FILE") or by == "kind":
                continue
            if node.func.attr in OPENERS or (node.func.attr == "open" and by in OPENED):
                return True
    return False
