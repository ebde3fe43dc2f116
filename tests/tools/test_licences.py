"""The table of licences: it follows the pins and the wheels, and nothing unknown enters it."""

from pathlib import PurePosixPath
from typing import Any

import pytest

from tools import licences
from tools.licences import LicenceError, holds, licence_of, pinned_versions, problems_of


class FakeWheel:
    """An installed package with some files and metadata."""

    def __init__(self, *files: str, **metadata: str) -> None:
        self.files = [PurePosixPath(file) for file in files]
        self.metadata = Metadata(metadata)


def a_wheel(*files: str, **metadata: str) -> Any:
    """Return a stand-in for a `Distribution`, which only reads files of its own."""
    return FakeWheel(*files, **metadata)


class Metadata(dict[str, str]):
    """Metadata without classifiers."""

    def get_all(self, name, default):
        """Return the default, as there are none."""
        return default


@pytest.fixture(scope="module")
def page():
    """Return the page as it is in the tree."""
    return licences.PAGE.read_text("utf-8")


@pytest.fixture(scope="module")
def pins():
    """Return the versions of constraints.txt."""
    return pinned_versions()


def test_the_page_is_up_to_date(page, pins):
    assert problems_of(page, pins) == []


def test_a_new_version_asks_for_a_new_page(page, pins):
    newer = {**pins, "av": "99.0", "espeakng-loader": "9.9"}
    found = problems_of(page, newer)
    assert any(each.startswith("av is pinned at 99.0") for each in found)
    assert any(each.startswith("espeakng-loader is pinned at 9.9") for each in found)


def test_a_package_that_nobody_pinned_is_refused(page, pins):
    with pytest.raises(LicenceError, match="pillow is not pinned"):
        problems_of(page, {name: pin for name, pin in pins.items() if name != "pillow"})


def test_a_row_that_is_lost_or_changed_is_noticed(page, pins):
    lines = page.splitlines()
    without = "\n".join(line for line in lines if not line.startswith("| `numpy`"))
    assert problems_of(without, pins) == ["numpy is missing"]
    (found,) = problems_of(page.replace("always | LGPL-3.0-only", "always | MIT"), pins)
    assert found.startswith("fpdf2 differs: ")


def test_a_library_whose_licence_nobody_wrote_down_is_refused():
    wheel = a_wheel("a.libs/libx264-d6533a8d.so.165", "a/_a.cpython-311-x86_64-linux-gnu.so")
    assert holds("a", wheel) == "x264 (**GPL-2.0-or-later**)"
    with pytest.raises(LicenceError, match="holds libnew"):
        holds("a", a_wheel("a.libs/libnew-12345678.so"))


def test_a_package_without_a_licence_is_refused():
    assert licence_of("a", a_wheel(License="MIT")) == "MIT"
    with pytest.raises(LicenceError, match="names no licence"):
        licence_of("a", a_wheel())
    with pytest.raises(LicenceError, match="names no licence"):
        licence_of("a", a_wheel(License="Permission is granted\nto everyone"))
