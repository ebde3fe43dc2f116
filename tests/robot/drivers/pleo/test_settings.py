"""The settings: what they say is what is used, and what cannot be is refused in one line."""

import math

import pytest
from hypothesis import given, strategies as st

from cubeling.robot.drivers.pleo.joints import JOINTS
from cubeling.robot.drivers.pleo.settings import (
    BUNDLED_SETTINGS,
    MotionFile,
    PleoSettings,
    load_settings,
)
from cubeling.robot.errors import RobotError

NEUTRAL = '[moods.neutral]\nmotion = "n.umf"\nlength_s = 2\n'


def settings(tmp_path, text: str):
    (tmp_path / "mine.toml").write_text(text)
    return load_settings(tmp_path / "mine.toml")


def test_the_bundled_settings_are_those_of_the_thesis():
    bundled = load_settings()
    assert tuple(bundled.moods) == ("neutral", "happy", "angry")
    assert all(mood.motion and mood.sound and mood.loop for mood in bundled.moods.values())
    assert bundled.moods["angry"].round == pytest.approx(2.0)
    assert bundled.catalogue.motions == ("nod", "wag tail")
    assert bundled.catalogue.sounds == ("chirp",)
    console = PleoSettings({}, {}, {})
    for name in ("volume", "battery_every", "mood_every", "play_within", "boot_text"):
        assert getattr(bundled, name) == getattr(console, name)


def test_ones_own_settings_stand_instead_of_the_bundled_ones(tmp_path):
    mine = settings(
        tmp_path,
        '[moods.sad]\njoints = { torso = 9.4, "neck up" = -30 }\nsound = "é.usf"\n'
        + NEUTRAL
        + '[motions.bow]\nfile = "bow.umf"\nlength_s = 1.5\n[console]\nvolume = 30\n',
    )
    assert tuple(mine.moods) == ("neutral", "sad")
    assert mine.moods["sad"].joints == {8: 10, 12: -30}
    assert (mine.moods["sad"].volume, mine.moods["sad"].sound) == (30, "é.usf")
    assert mine.motions == {"bow": MotionFile("bow.umf", 1.5)}
    assert mine.sounds == {}


@pytest.mark.parametrize(
    ("text", "key", "allowed"),
    [
        ("moods = 3", "moods", "table"),
        ("[moods.sad]\njoints = {}\n", "moods", "neutral"),
        (NEUTRAL + "[moods.sad]\n", "moods.sad.motion", "either a motion or joints"),
        (NEUTRAL + "joints = {}\nloop = true", "moods.neutral.motion", "either"),
        ("[moods.neutral]\njoints = {}\nloop = true", "moods.neutral.joints", "for a motion"),
        ('[moods.neutral]\nmotion = "a"', "moods.neutral.length_s", "number from 0.5 to 600"),
        ('[moods.neutral]\nmotion = "a"\nlength_s = nan', "moods.neutral.length_s", "not nan"),
        ('[moods.neutral]\nmotion = "a"\nlength_s = true', "moods.neutral.length_s", "not True"),
        (
            '[moods.neutral]\nmotion = "a\\nFORMAT"\nlength_s = 1',
            "moods.neutral.motion",
            "one word",
        ),
        ('[moods.neutral]\nmotion = "a b"\nlength_s = 1', "moods.neutral.motion", "one word"),
        ('[moods.neutral]\nmotion = "a\\u0000"\nlength_s = 1', "moods.neutral.motion", "one word"),
        ('[moods.neutral]\nmotion = "ж"\nlength_s = 1', "moods.neutral.motion", "ISO-8859-1"),
        ('[moods.neutral]\nmotion = ""\nlength_s = 1', "moods.neutral.motion", "one word"),
        (NEUTRAL + "loop = 1", "moods.neutral.loop", "true or false"),
        (NEUTRAL + "speed = 1", "moods.neutral.speed", "here are motion, length_s"),
        (NEUTRAL + "motion_speed = 0", "moods.neutral.motion_speed", "whole number from 1 to 200"),
        (NEUTRAL + "volume = 101", "moods.neutral.volume", "from 0 to 100, not 101"),
        (NEUTRAL + "sound = 3", "moods.neutral.sound", "a text, not 3"),
        ("[moods.neutral]\njoints = {nose = 3}", "moods.neutral.joints.nose", "neck up"),
        ("[moods.neutral]\njoints = {torso = 16}", "moods.neutral.joints.torso", "from -15 to 15"),
        (NEUTRAL + '[motions.x]\nfile = "a"', "motions.x.length_s", "from 0.1 to 600"),
        (NEUTRAL + '[motions."a\\nb"]\nfile = "a"\nlength_s=1', "motions", "printable"),
        (NEUTRAL + "[motions]\nx = 3", "motions.x", "table"),
        (NEUTRAL + "[sounds]\nx = 3", "sounds.x", "a text, not 3"),
        (NEUTRAL + '[sounds]\nx = "a"\n[motions.x]\nfile="a"\nlength_s=1', "sounds.x", "this name"),
        (NEUTRAL + '[sounds]\n"sixteen bytes and more" = "a"', "sounds", "1 to 16 bytes"),
        (NEUTRAL + "[console]\nbaud = 3", "console.baud", "there are volume"),
        (NEUTRAL + "[console]\nvolume = 1.5", "console.volume", "whole number"),
        (NEUTRAL + "[console]\nmood_every_s = -1", "console.mood_every_s", "from 0 to 60"),
        (NEUTRAL + "[console]\nplay_within_s = 61", "console.play_within_s", "from 0.5 to 60"),
        (NEUTRAL + "[console]\nboot_text = [3]", "console.boot_text", "can be printed"),
        (NEUTRAL + "[console]\nboot_text = 3", "console.boot_text", "list"),
        (NEUTRAL + "[robot]\n", "robot", "there are console, moods"),
        (NEUTRAL + "[[", "", "not TOML"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(tmp_path, text, key, allowed):
    with pytest.raises(RobotError) as refusal:
        settings(tmp_path, text)
    line = str(refusal.value)
    assert line.startswith(f"{tmp_path / 'mine.toml'}: {key}")
    assert allowed in line
    assert line.isprintable()


@given(text=st.text(max_size=80))
def test_any_name_of_a_file_is_refused_or_is_one_word_on_the_wire(tmp_path_factory, text):
    quoted = "".join(f"\\U{ord(one):08x}" for one in text)
    path = tmp_path_factory.mktemp("any") / "mine.toml"
    path.write_text(f'[moods.neutral]\nmotion = "{quoted}"\nlength_s = 1\n')
    try:
        motion = load_settings(path).moods["neutral"].motion
    except RobotError:
        return
    assert motion is not None
    assert motion.file == text
    assert len(f"MOTION PLAY {text}".encode("latin-1").split()) == 3


@given(st.sampled_from(JOINTS), st.floats(-1000, 1000))
def test_an_angle_is_taken_to_the_closest_one_that_the_joint_can_have(joint, degrees):
    angle = joint.nearest(degrees)
    assert joint.low <= angle <= joint.high
    assert angle % joint.step == 0
    if joint.low <= degrees <= joint.high:
        assert abs(angle - degrees) <= joint.step
    assert joint.nearest(angle) == angle


def test_the_joints_are_those_of_the_table():
    assert len(JOINTS) == 14
    assert [(one.low, one.high) for one in JOINTS[4:8]] == [(-45, 40), (-70, 0)] * 2
    assert [one.step for one in JOINTS] == [1, 1, 1, 1, 10, 2, 10, 2, 2, 1, 1, 1, 1, 1]
    torso = load_settings().catalogue.joints[8]
    assert (torso.low, torso.high, torso.speed) == pytest.approx(
        (math.radians(-15), math.radians(15), math.radians(20))
    )
    assert BUNDLED_SETTINGS.is_file()
