"""`cubeling robot try`: what a robot makes of each mood, in a line each."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from cubeling import robot
from cubeling.app.commands.robots.robot import trial
from cubeling.robot.protocol import messages as m
from cubeling.robot.simulators import SIMULATORS
from cubeling.robot.simulators.cubeling.dinosaur import CATALOGUE
from cubeling.robot.simulators.cubeling.simulator import Simulator


@pytest.fixture
def virtual_time(monkeypatch):
    """Let simulated robots live in virtual time, which passes only while the command waits."""

    def connect(url, settings=None):
        stepped = robot.SteppedRobot(url, settings=settings)
        clock = SimpleNamespace(monotonic=lambda: stepped.now, sleep=stepped.advance)
        monkeypatch.setattr(trial, "time", clock)
        return stepped

    monkeypatch.setattr(robot, "connect", connect)


in_virtual_time = pytest.mark.usefixtures("virtual_time")


@pytest.fixture
def simulate(monkeypatch):
    """Return a function that changes the catalogue of the simulated robot of our protocol."""

    def change(**fields):
        class Changed(Simulator):
            def __init__(self, seed: int = 0) -> None:
                super().__init__(seed)
                self.body.catalogue = replace(CATALOGUE, **fields)

        monkeypatch.setitem(SIMULATORS, "cubeling", Changed)

    return change


def without_log(out: str) -> list[str]:
    return [line for line in out.splitlines() if not line.startswith("log ")]


def test_every_mood_is_tried_and_what_came_of_it_told(cubeling):
    code, out, _ = cubeling("robot", "try", "sim", "--seconds", "0.3")
    assert code == 0
    lines = without_log(out)
    assert "moods neutral, happy, angry" in lines[0]
    assert [line.split()[0] for line in lines[1:]] == ["neutral", "happy", "angry", "neutral"]
    assert all("acknowledged 0." in line and "shown 0." in line for line in lines[1:])


@in_virtual_time
def test_a_robot_that_does_not_say_what_it_shows_is_not_believed_to_show_it(cubeling):
    code, out, _ = cubeling("robot", "try", "sim:pleo", "--mood", "happy", "--seconds", "1")
    assert code == 0
    assert "happy        acknowledged 0." in out
    assert "it does not say what it shows" in out


@in_virtual_time
def test_a_mood_that_the_robot_does_not_have_is_refused_and_the_others_named(cubeling):
    code, _, err = cubeling("robot", "try", "sim:cubeling", "--mood", "furious")
    assert code == 2
    assert "no mood 'furious': neutral, happy, angry" in err


def test_a_time_that_is_none_is_refused(cubeling):
    for seconds in ("0", "nan", "1e9"):
        code, _, err = cubeling("robot", "try", "sim:cubeling", "--seconds", seconds)
        assert code == 2
        assert "0.1 to 3600 seconds" in err


@in_virtual_time
def test_what_the_robot_complains_of_is_told_in_its_own_words(cubeling, tmp_path):
    (tmp_path / "mine.toml").write_text('[moods.neutral]\nmotion = "[red]x"\nlength_s = 9\n')
    args = (
        "--robot-settings",
        str(tmp_path / "mine.toml"),
        "--mood",
        "neutral",
        "--seconds",
        "1.5",
    )
    code, out, _ = cubeling("robot", "try", "sim:pleo", *args)
    assert code == 1
    assert "not acknowledged" in out
    assert "it complains: Error: file not found: [red]x" in out


@in_virtual_time
def test_a_robot_without_moods_is_tried_with_all_that_it_has(cubeling, simulate):
    simulate(moods=(), motions=("nod", "bow"), sounds=("chirp",))
    code, out, err = cubeling("robot", "try", "sim", "--seconds", "0.2")
    assert (code, err) == (0, "")
    lines = without_log(out)
    assert "It has no moods: its emotions, motions and sounds are tried." in lines[1]
    assert [line.split()[0] for line in lines[2:5]] == ["happy", "angry", "neutral"]
    assert all("acknowledged 0." in line for line in lines[2:5])
    assert [line.split()[:2] for line in lines[5:]] == [
        ["nod", "played"],
        ["bow", "played"],
        ["chirp", "played"],
    ]


@in_virtual_time
def test_a_mood_of_a_robot_without_moods_is_refused(cubeling, simulate):
    simulate(moods=())
    code, _, err = cubeling("robot", "try", "sim", "--mood", "happy")
    assert code == 2
    assert "Dino has no mood 'happy': it has none" in err


@in_virtual_time
def test_the_names_of_a_robot_are_neither_markup_nor_control_codes(cubeling, simulate):
    simulate(name="[red]R\x1b[2J", moods=("[/]m\x1b[1m",), motions=("[x",))
    code, out, _ = cubeling("robot", "try", "sim", "--seconds", "0.2")
    assert code == 0
    assert r"[red]R\x1b[2J (simulator 1)" in out
    assert r"moods [/]m\x1b[1m; motions [x;" in out
    assert "\x1b" not in out
    code, _, err = cubeling("robot", "try", "sim", "--mood", "glad")
    assert code == 2
    assert r"[red]R\x1b[2J has no mood 'glad'" in err


@in_virtual_time
def test_a_joint_is_turned_to_its_angle(cubeling):
    joints = ("--joint", "neck up=-5 deg", "--joint", "torso=0.1rad")
    code, out, _ = cubeling("robot", "try", "sim", *joints, "--seconds", "1.2")
    assert code == 0
    neck, torso = without_log(out)[1:]
    assert neck.startswith("neck up=-5 deg reached ")
    assert torso.startswith("torso=0.1rad reached ")


@in_virtual_time
@pytest.mark.parametrize(
    ("port", "joint", "told"),
    [
        ("sim", "neck up", "a joint is given as NAME=ANGLE"),
        ("sim", "neck up=20", "a joint is given as NAME=ANGLE"),
        ("sim", "neck=20deg", "Dino has no joint 'neck': right shoulder"),
        ("sim", "torso=20deg", "torso turns from -15° to 15°, not to 20°"),
        ("sim:pleo", "torso=2deg", "the joints of Pleo cannot be turned one by one"),
    ],
)
def test_a_joint_that_cannot_be_turned_so_is_refused_in_one_line(cubeling, port, joint, told):
    code, _, err = cubeling("robot", "try", port, "--joint", joint, "--seconds", "0.2")
    assert code == 2
    assert told in err
    assert err.count("\n") == 1


class Exhausted(Simulator):
    """It can move nothing, and says so in words that a terminal would obey."""

    def __init__(self, seed: int = 0) -> None:
        super().__init__(seed)
        self.body.refusal = lambda: m.RESULT_LOW_BATTERY  # type: ignore[method-assign]
        self.link.log.write(m.SEVERITY_ERROR, "[red]charge\x1b[2J me", 0)


@in_virtual_time
def test_why_a_robot_refuses_and_what_it_logs_is_shown_as_it_is(cubeling, monkeypatch):
    monkeypatch.setitem(SIMULATORS, "cubeling", Exhausted)
    code, out, _ = cubeling("robot", "try", "sim", "--joint", "torso=5deg", "--seconds", "0.5")
    assert code == 1
    assert "torso=5deg   not reached" in out
    assert "it complains: torso: refused, its battery is low" in out
    (line,) = [line for line in out.splitlines() if "charge" in line]
    assert line.startswith("log ")
    assert line.endswith(r"error: [red]charge\x1b[2J me")
