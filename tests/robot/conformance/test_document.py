"""The document of the suite and the suite itself say the same."""

from pathlib import Path

import pytest

from cubeling.robot.conformance import all_checks
from tools.conformance_reference import DOCUMENT, checks_table, updated


def test_the_document_is_current():
    document = DOCUMENT.read_text("utf-8")
    assert updated(document) == document, "run `python -m tools.conformance_reference`"


def test_a_document_without_the_mark_is_refused():
    with pytest.raises(ValueError, match="must have one part marked"):
        updated("# nothing")


def test_the_table_names_every_check():
    assert all(f"| {check.name}" in checks_table() for check in all_checks())


def test_the_picture_loads_nothing_from_the_network():
    picture = (Path(DOCUMENT).parent / "pictures" / "conform.svg").read_text("utf-8")
    assert "http" not in picture.replace("http://www.w3.org/", "")
    assert len(picture) < 40_000
