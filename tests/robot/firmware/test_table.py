"""The table of servos that a person edits: what is wrong with it is said before anything moves."""

from pathlib import Path
from runpy import run_path
from types import SimpleNamespace

import pytest

import cubeling.robot.firmware
from cubeling.robot.firmware.dino import motions, servos
from cubeling.robot.firmware.dino.table import ServoTable

LAYOUTS = sorted((Path(cubeling.robot.firmware.__file__).parent / "layouts").glob("*.py"))
JOINTS = {sway[0] for motion in motions.MOTIONS for sway in motion[3]}


def changed(**changes: object) -> SimpleNamespace:
    """Return the table with some of its values changed."""
    return SimpleNamespace(**(vars(servos) | changes))


def row(**changes: object) -> tuple[object, ...]:
    """Return a good row with some of its values changed."""
    good = {
        "name": "tail up", "pin": 16, "low": -30, "high": 60, "neutral": 90, "direction": 1,
        "trim": 0, "speed": 100, "shortest": 500, "longest": 2500,
    }  # fmt: skip
    return tuple((good | changes).values())


@pytest.mark.parametrize("platform", ["rp2", "esp32", "linux"])
def test_the_default_table_is_valid_on_every_board(platform):
    ServoTable(servos).check(platform)


@pytest.mark.parametrize("path", LAYOUTS, ids=lambda path: path.stem)
def test_every_layout_is_valid_and_its_joints_move(path):
    table = ServoTable(SimpleNamespace(**run_path(str(path))))
    table.check("rp2")
    table.check("esp32")
    # No motion moves the hind legs: the robot stands on them.
    legs = {"left hip", "left knee", "right hip", "right knee"}
    assert {servo.name for servo in table.servos} <= JOINTS | legs


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"low": 1}, "lowest <= 0 <= highest"),
        ({"high": 181}, "highest <= 180"),
        ({"direction": 0}, "direction must be 1 or -1"),
        ({"speed": 0}, "speed must be from 1 to 600"),
        ({"speed": 601}, "speed must be from 1 to 600"),
        ({"shortest": 300}, "pulses must rise"),
        ({"shortest": 2500}, "pulses must rise"),
        ({"longest": 2700}, "pulses must rise"),
        ({"trim": 40}, "at 60 degrees its servo is at 190"),
        ({"direction": -1, "neutral": 50}, "at 60 degrees its servo is at -10"),
        ({"name": ""}, "must have 1 to 16 bytes"),
        ({"name": "a name that is too long"}, "must have 1 to 16 bytes"),
        ({"one": "too many"}, "has 10 values, not 11"),
        ({"pin": 22}, "pin 22 is used for a servo and for something else"),
        ({"pin": 13}, "pin 13 is used for a servo and for something else"),
    ],
)
def test_an_invalid_row_is_refused_in_one_line(changes, says):
    with pytest.raises(ValueError, match=says) as caught:
        ServoTable(changed(SERVOS=(row(**changes),))).check("esp32")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"SERVOS": ()}, "1 to 16 rows"),
        ({"SERVOS": tuple(row(name=str(n), pin=n) for n in range(17))}, "1 to 16 rows"),
        ({"SERVOS": (row(), row(pin=17))}, "tail up twice"),
        ({"SERVOS": (row(), row(name="other"))}, "16 twice"),
        ({"NAME": "Ä" * 9}, "NAME must have 1 to 16 bytes"),
        ({"PORT": (1, 16, 9)}, "pin 16 is used for a servo and for something else"),
        ({"BATTERY": (16, 3.0, 4.2, 2.0)}, "pin 16 is used for a servo and for something else"),
        ({"DRIVER": (0, 20, 21, 64), "SERVOS": (row(pin=16),)}, "channels 0 to 15, not 16"),
    ],
)
def test_an_invalid_table_is_refused_in_one_line(changes, says):
    with pytest.raises(ValueError, match=says):
        ServoTable(changed(**changes)).check("esp32")


def test_pins_that_share_a_pwm_are_refused_on_that_board():
    buzzer = changed(SERVOS=(row(pin=23),))
    ServoTable(buzzer).check("esp32")
    with pytest.raises(ValueError, match="shares its PWM's frequency"):
        ServoTable(buzzer).check("rp2")
    both = changed(SERVOS=(row(pin=2), row(name="other", pin=18)))
    ServoTable(both).check("esp32")
    with pytest.raises(ValueError, match="pins 2 and 18 share one PWM"):
        ServoTable(both).check("rp2")
