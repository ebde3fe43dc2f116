"""No byte that calibrates, saves, resets or walks away can leave the driver."""

import string
from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from cubeling.robot.drivers.opencat import tokens
from cubeling.robot.drivers.opencat.host import OpenCatHost
from cubeling.robot.drivers.opencat.settings import load_settings, parse_settings
from cubeling.robot.errors import RobotError

ALLOWED = b"kibd?j"


@given(st.binary(max_size=40))
def test_an_allowed_line_begins_with_an_allowed_token(line):
    if tokens.why_not(line) is None:
        assert line[:1] in [bytes([token]) for token in ALLOWED]
        assert line.endswith(b"\n")
        assert line.count(b"\n") == 1
        assert line[:-1].decode("ascii").isprintable()


@given(st.sampled_from([chr(code) for code in range(256)]), st.text(max_size=10))
def test_no_other_token_is_allowed(token, rest):
    line = (token + rest + "\n").encode("latin-1", "replace")
    if line[0] not in ALLOWED:
        with pytest.raises(RobotError):
            tokens.check_line(line)


@pytest.mark.parametrize("line", [
    b"c\n", b"c0 5\n", b"a\n", b"s\n", b"S\n", b"!\n", b"R\n", b"gc\n", b"g\n", b"n\n", b"w%a%b\n",
    b"K\x01~", b"T\n", b"f\n", b"z\n", b"p\n", b"Y\n", b"XA\n",
    b"b\n", b"b5\n", b"b12 8 14\n",  # one number alone is stored as the volume, none as mute
    b"d0\n", b"j8\n", b"?p\n",
    b"ksit\nc\n", b"ksit\n\n", b"ksit", b"k\n", b"kx\n", b"ksit c\n", b"ksit;s\n",
    b"i0\n", b"i\n", b"i16 0\n", b"i0 126\n", b"i0 5\nc\n", b"i0 --5\n", b"i-1 5\n",
    b"b12 0\n", b"b99 8\n", b"b12 65\n",
    b"kcalib\n", b"kcal\n", b"kca\n", b"kwkF\n", b"kwkL\n", b"kvtF\n", b"kbk\n", b"kbf\n",
    b"ktestServo\n", b"kts\n", b"k" + b"a" * 10 + b"\n", b"b" + b"12 8 " * 8 + b"12 8\n",
    b"\n", b"", b" ?\n", b"?", b"?\r\n",
])  # fmt: skip
def test_this_is_never_sent(line):
    with pytest.raises(RobotError, match="is not sent"):
        tokens.check_line(line)


@pytest.mark.parametrize("line", [b"?\n", b"j\n", b"d\n", b"ksit\n", b"kbuttUp\n", b"kpu1\n",
                                  b"i0 -40 8 125\n", b"b14 8 0 4\n"])  # fmt: skip
def test_this_may_be_sent(line):
    assert tokens.check_line(line) == line


@given(st.text(string.printable, max_size=12))
def test_a_skill_of_any_name_is_refused_or_becomes_one_plain_line(name):
    try:
        line = tokens.skill(name)
    except RobotError:
        return
    assert line == f"k{name}\n".encode()
    assert name.isalnum()
    assert not name.startswith("calib")


BAD = {
    'posture = "balance\\nc"': "no name of a skill",
    'posture = "calib"': "calibration",
    'posture = "wkF"': "walks away",
    'posture = "balance"\ngestures = ["hi", "!"]': "no name of a skill",
    'posture = "balance"\ngestures = "hi"': "list of",
    'posture = "balance"\nsound = "loud"': "there is no sound",
    'posture = "balance"\npose = { wing = 4 }': "no joint",
    'posture = "balance"\npose = { head = "up" }': "number",
    'posture = "balance"\ngesture_every_s = 1.0\ngestures = ["hi"]': "servos get hot",
    'posture = "balance"\ntoken = "c"': "means nothing here",
}


@pytest.mark.parametrize("mood", BAD)
def test_settings_that_may_not_be_sent_are_refused_in_one_line(mood, tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(f"[bittle.moods.happy]\n{mood}\n")
    with pytest.raises(RobotError) as refusal:
        load_settings(path)
    text = str(refusal.value)
    assert BAD[mood] in text
    assert str(path) in text
    assert "bittle.moods.happy" in text
    assert "\n" not in text


@pytest.mark.parametrize(("said", "reason"), [
    ({"opencat": {"baud": 9600}}, "baud"),
    ({"opencat": {"commands_per_s": 100}}, "commands_per_s"),
    ({"opencat": {"dwell_s": 0}}, "dwell_s"),
    ({"opencat": {"model": "aibo"}}, "model"),
    ({"opencat": {"colour": 1}}, "colour"),
    ({"cat": {}}, "cat"),
    ({"bittle": {"stop": "calib"}}, "calibration"),
    ({"bittle": {"motions": ["bf"]}}, "somersault"),
    ({"bittle": {"sounds": {"loud": [[12]]}}}, "pairs"),
    ({"bittle": {"sounds": {"loud": [[5, 0]]}}}, "values"),
    ({"bittle": {"sounds": {"hi": [[5, 8]]}}}, "another name"),
    ({"bittle": {"moods": {"grim": {"posture": "sit"}}}}, "no mood"),
    ({"bittle": {"moods": {"disgusted": {"gestures": ["hi"]}}}}, "posture is missing"),
    ({"bittle": {"sounds": {"a\nb": [[5, 8]]}}}, "printable"),
    ({"bittle": {"moods": 3}}, "table"),
    ({"bittle": 3}, "table"),
    ({"bittle": {"sounds": {"loud": [[10**5000, 8]]}}}, "pairs, not something so long"),
    ({"bittle": {"sounds": {"a.b": [[5, 8]]}}}, "letters"),
])  # fmt: skip
def test_wrong_settings_are_refused_in_one_line(said, reason):
    with pytest.raises(RobotError, match=reason) as refusal:
        parse_settings(said, "mine.toml")
    assert "\n" not in str(refusal.value)


@given(st.dictionaries(st.sampled_from(["posture", "gestures", "sound", "pose", "gesture_every_s"]),
                       st.one_of(st.text(max_size=9), st.lists(st.text(max_size=9), max_size=3),
                                 st.floats(), st.integers(),
                                 st.dictionaries(st.text(max_size=4), st.integers()))))  # fmt: skip
def test_a_mood_of_any_content_is_refused_or_may_be_sent(mood):
    try:
        settings = parse_settings({"bittle": {"moods": {"happy": mood}}}, "mine.toml")
    except RobotError as error:
        refusal = str(error)
    else:
        refusal = "none"
    assert "\n" not in refusal
    if refusal != "none":
        return
    happy = settings.behaviours["bittle"].moods["happy"]
    for name in (happy.posture, *happy.gestures):
        assert tokens.why_not(f"k{name}\n".encode()) is None


def test_poses_are_kept_within_the_joints_limits():
    happy = {"posture": "sit", "pose": {"head tilt": 90, "tail": -300}}
    settings = parse_settings({"nybble": {"moods": {"happy": happy}}}, "mine.toml")
    assert settings.behaviours["nybble"].moods["happy"].pose == {1: 40, 2: -120}


def test_the_bundled_settings_may_be_sent_and_all_moods_differ():
    for behaviour in load_settings().behaviours.values():
        assert next(iter(behaviour.moods)) == "neutral"
        looks = [(mood.posture, str(mood.pose)) for mood in behaviour.moods.values()]
        assert len(set(looks)) == len(looks)


def test_every_line_of_a_host_is_checked(monkeypatch):
    host = OpenCatHost()
    host.port_opened(0.0)
    monkeypatch.setattr(
        tokens, "check_line", lambda line: (_ for _ in ()).throw(RobotError("gate"))
    )
    with pytest.raises(RobotError, match="gate"):
        host.tick(60.0)
    assert host.bytes_to_send() == b""


def test_the_example_in_the_document_loads_with_the_values_it_states(tmp_path):
    text = (Path(__file__).parents[4] / "docs" / "opencat.md").read_text("utf-8")
    example = tmp_path / "example.toml"
    example.write_text(text.split("```toml\n")[1].split("```")[0], "utf-8")
    settings, bundled = load_settings(example), load_settings()
    assert (settings.baud, settings.model) == (57600, "bittle")
    assert settings.behaviours["bittle"].moods["afraid"].sound == "purr"
    assert settings.behaviours["nybble"] == bundled.behaviours["nybble"]
    for name in ("commands_per_s", "dwell", "ask_every", "rest_after"):
        assert getattr(settings, name) == getattr(bundled, name), "the document quotes defaults"
