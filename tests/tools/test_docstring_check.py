"""The check of docstrings that say nothing."""

from pathlib import Path

import pytest

from tools.docstring_check import ROOMS, ROOT, short_docstrings


def names_in(source: str) -> list[str]:
    return [short.name for short in short_docstrings(source, Path("module.py"))]


def test_a_docstring_that_repeats_a_name_fails_wherever_it_stands() -> None:
    source = '''"""A module."""
LIMIT = 3
"""The limit."""
class Box:
    """A box."""
    side: float
    """Its side."""
    def close(self) -> None:
        """Close it."""
'''
    assert names_in(source) == ["module", "LIMIT", "Box", "Box.side", "Box.close"]


@pytest.mark.parametrize("text", ["Side [m].", "(n, 3).", "One of `SIDES`.", "Opacity, 0…1."])
def test_a_value_may_say_no_more_than_its_unit_shape_or_range(text: str) -> None:
    assert names_in(f'class Box:\n    side: float\n    """{text}"""') == []
    assert names_in(f'def side() -> float:\n    """{text}"""') == ["side"]


def test_private_names_may_be_brief() -> None:
    assert names_in('def _close() -> None:\n    """Close it."""') == []
    assert names_in('class _Box:\n    side: float\n    """Its side."""') == []


@pytest.mark.full  # `make check` does it for every change
def test_the_rooms_pass() -> None:
    paths = [path for room in ROOMS for path in (ROOT / room).rglob("*.py")]
    assert [s for path in paths for s in short_docstrings(path.read_text(), path)] == []
