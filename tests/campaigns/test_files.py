"""Every reader of the program, tried with files that are none and with damaged ones, in short."""

import os
import sys
from pathlib import Path

import pytest

from cubeling.bad_input import BadInputError
from tests.campaigns.files import examples
from tests.campaigns.files.__main__ import campaign, read_all, reader_of, readers

pytestmark = pytest.mark.full  # all modules of the rooms are loaded


@pytest.fixture(scope="module")
def kinds():
    return readers()


def test_every_kind_of_file_names_a_reader(kinds):
    assert len(kinds) > 20
    for name in kinds:
        assert callable(reader_of(name))


@pytest.mark.skipif(sys.platform == "win32", reason="there are no such files")
def test_no_reader_waits_for_what_is_no_file(kinds, tmp_path):
    failed = []
    for name, kind in kinds.items():
        for suffix in sorted(kind.suffixes):
            folder = tmp_path / f"{len(list(tmp_path.iterdir()))}"
            folder.mkdir()
            (folder / f"folder{suffix}").mkdir()
            os.mkfifo(folder / f"pipe{suffix}")
            (folder / f"loop{suffix}").symlink_to(f"loop{suffix}")
            (folder / f"zero{suffix}").symlink_to("/dev/zero")
            (folder / f"null{suffix}").symlink_to("/dev/null")
            (folder / f"none{suffix}").symlink_to("nowhere")
            (folder / f"empty{suffix}").touch()
            failed += [each for path in folder.iterdir() if (each := _failure(name, path))]
    assert not failed


def _failure(name: str, path: Path) -> str:
    """Return what a reader does with a path that it may not do."""
    try:
        read_all(reader_of(name), path)
    except BadInputError as error:
        return "" if str(error).isprintable() else f"{name}, {path.name}: {error!r}"
    except Exception as error:
        return f"{name}, {path.name}: {error!r}"
    # An empty TOML file may say all that it has to, and preferences are never refused.
    allowed = path.name.startswith(("empty", "none")) or "preferences" in name
    return "" if allowed else f"{name}, {path.name}: was read"


def test_damaged_files_are_read_or_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(examples, "SHARED", tmp_path)  # as on a machine without it
    trials, problems = campaign(150, "", tmp_path, None, 1)
    assert not problems
    assert [trial.failure for found in trials.values() for trial in found if trial.failure] == []
