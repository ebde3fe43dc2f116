"""What the program makes of the bundled recordings is what it made of them before."""

import pytest

from cubeling.app.scenarios import SCENARIOS
from tests.golden import FOLDER, agrees, describe, differences, renewed


@pytest.fixture(scope="module", params=SCENARIOS)
def recording(request, computed_session):
    """The name of a bundled recording, and its file with every channel."""
    return request.param, computed_session(request.param)


def test_a_recording_leads_to_what_is_written_down(recording):
    name, session = recording
    path = FOLDER / f"{name}.txt"
    assert path.stat().st_size <= 60_000
    found = differences(path.read_text("utf-8"), describe(session))
    assert not found, f"python -m tests.golden {name} --renew\n" + "\n".join(found[:5])


@pytest.mark.parametrize(
    ("old", "new", "same"),
    [
        ("at 1.00 2.00", "at 1.10 2.00", True),
        ("at 1.00 2.00", "at 1.12 2.00", False),
        ("yaw -179.98°", "yaw 179.99°", True),
        ("at -179.98", "at 179.99", False),
        ("weight 0.500", "weight 0.503", False),
        ("x 1.0000 0.0010", "x 1.0000 0.0027", True),
        ("action idle", "action kiss", False),
        ("at -", "at 0.00 0.00", False),
    ],
)
def test_numbers_agree_within_a_tenth_of_a_millimetre_or_degree(old, new, same):
    assert agrees(old, new) == same


def test_only_what_moved_is_renewed():
    old = "frame 0\n  at 1.00\n  yaw 2.00°\nframe 10\n  at 3.00\n"
    new = "frame 0\n  at 1.09\n  yaw 2.50°\nframe 10\n  at 3.00\n  more\n"
    assert renewed(old, new) == "frame 0\n  at 1.00\n  yaw 2.50°\nframe 10\n  at 3.00\n  more\n"
    assert differences(old, new) == [
        "frame 0\n- yaw 2.00°\n+ yaw 2.50°",
        "frame 10\n- nothing\n+ more",
    ]
