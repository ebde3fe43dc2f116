"""Files that are no files: pipes and devices, names that cannot be, tables from other editors."""

import os
import sys
from pathlib import Path

import pytest

from cubeling.characters import Character, CharacterError
from cubeling.characters.formats import load_motion
from cubeling.characters.model.sidecar import Sidecar, read_sidecar
from cubeling.characters.synthesis.idle.pauses import PauseLaw


@pytest.mark.skipif(sys.platform == "win32", reason="devices have no path there")
@pytest.mark.parametrize(
    ("name", "read"),
    [
        ("x.glb", Character.load),
        ("x.vrm", Character.load),
        ("x.bvh", load_motion),
        ("x.toml", lambda path: read_sidecar(path, ())),
    ],
)
def test_devices_are_refused(tmp_path: Path, name: str, read) -> None:
    path = tmp_path / name
    path.symlink_to(os.devnull)
    with pytest.raises(CharacterError, match="a pipe or a device"):
        read(path)


@pytest.mark.parametrize("name", ["a\0b.glb", "x" * 5000 + ".glb", "a\0b.bvh"])
def test_an_invalid_file_name_is_refused_in_one_line(name: str) -> None:
    with pytest.raises(CharacterError, match="cannot read the"):
        load_motion(name)


def test_a_sidecar_file_says_how_activation_shortens_pauses(tmp_path: Path) -> None:
    path = tmp_path / "x.toml"
    path.write_text("[idle]\nbeta = 0.5\n", encoding="utf-8")
    assert read_sidecar(path, ()).pauses == PauseLaw(beta=0.5)
    for wrong in ("beta = -1", "alpha = 0.5", "gamma = 1", 'beta = "much"'):
        path.write_text(f"[idle]\n{wrong}\n", encoding="utf-8")
        with pytest.raises(CharacterError, match="idle") as refusal:
            read_sidecar(path, ())
        assert "\n" not in str(refusal.value)


def test_a_sidecar_file_with_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    path = tmp_path / "x.toml"
    text = '[joints]\nhead = "Kopf"\n[body]\nself_collision = true\ndependent_joints = false\n'
    path.write_text(text, encoding="utf-8-sig")
    assert read_sidecar(path, ()) == Sidecar({"head": "Kopf"}, None, ("self_collision",))
