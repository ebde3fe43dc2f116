"""What the program makes of the bundled recordings is what it made of them before."""

import pytest

from cubeling.app.session.bundled import RECORDED_SCENARIOS
from tests.conftest import FIRST_S
from tests.examples import some
from tests.golden import EVERY, FOLDER, agrees, describe, differences, renewed


@pytest.mark.slow(reason="five seconds of a recording are computed")
@pytest.mark.parametrize("name", some(sorted(RECORDED_SCENARIOS), 2))
def test_the_first_seconds_lead_to_what_is_written_down(computed_session, name):
    now = describe(computed_session(name, FIRST_S))
    assert now.count("frame ") == FIRST_S * 30 / EVERY
    golden = (FOLDER / f"{name}.txt").read_text("utf-8").splitlines()
    assert_agrees(name, "\n".join(golden[: now.count("\n")]), now)


@pytest.mark.full
@pytest.mark.parametrize("name", RECORDED_SCENARIOS)
def test_a_recording_leads_to_what_is_written_down(computed_session, name):
    golden = (FOLDER / f"{name}.txt").read_text("utf-8")
    assert_agrees(name, golden, describe(computed_session(name)))


def assert_agrees(name, golden, now):
    found = differences(golden, now)
    assert not found, f"python -m tests.golden {name} --renew\n" + "\n".join(found[:5])


@pytest.mark.parametrize("name", RECORDED_SCENARIOS)
def test_what_is_written_down_of_a_recording_is_small(name):
    assert (FOLDER / f"{name}.txt").stat().st_size <= 60_000


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
