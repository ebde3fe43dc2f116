"""The options of other programs and instruments, on the command line."""

import sys

import pytest

from cubeling.app.bridges import opening
from cubeling.app.commands.play.instrument_options import INSTRUMENTS


@pytest.mark.parametrize("command", ["play", "replay", "talk", "show"])
def test_a_command_that_plays_lists_them(cubeling, command):
    code, out, _ = cubeling(command, "--help")
    assert code == 0
    for name in INSTRUMENTS:
        assert f"--{name.replace('_', '-')}" in out


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (("--osc", "nowhere"), "--osc nowhere: give a port, or HOST:PORT"),
        (("--osc-in", "127.0.0.1:99999"), "HOST:PORT"),
        (("--osc", "udp://127.0.0.1:9000"), "HOST:PORT"),
        (("--vmc", ""), "--vmc"),
        (("--vmc", "39539"), "vleo is no person: other programs know only the bones of persons"),
        (("--lsl", "--lsl-scope", "mars"), "machine, link, site, not mars"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(cubeling, short_session, given, words):
    code, _, err = cubeling("replay", short_session, "--no-pictures", *given)
    assert code == 2
    assert words in err
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("library", "given", "remedy"),
    [
        ("pythonosc", ("--osc", "9000"), "pip install python-osc"),
        ("pythonosc", ("--vmc", "9000"), "pip install python-osc"),
        ("pylsl", ("--lsl",), "pip install pylsl"),
        ("pylsl", ("--lsl-in", "buttons"), "pip install pylsl"),
    ],
)
def test_without_a_library_one_line_says_what_installs_it(
    cubeling, short_session, monkeypatch, library, given, remedy
):
    monkeypatch.setitem(sys.modules, library, None)
    code, _, err = cubeling("replay", short_session, "--no-pictures", *given)
    assert code == 2
    assert remedy in err
    assert err.count("\n") == 1


def test_doctor_says_what_brings_liblsl_where_the_wheel_has_none(monkeypatch):
    from cubeling.app.commands.look import doctor

    assert doctor._osc().verdict == "good"
    monkeypatch.setattr(
        opening, "lsl_problem", lambda: ("pylsl has no liblsl", opening.LIBLSL_REMEDY)
    )
    finding = doctor._lsl()
    assert finding.verdict == "missing"
    assert "no liblsl" in finding.found
    assert "PYLSL_LIB" in finding.remedy


def test_a_settings_file_of_lsl_stays_the_users(monkeypatch):
    """Whoever has one says there who finds the streams."""
    if opening.lsl_problem() is not None:
        pytest.skip("there is no LSL here")
    import pylsl

    monkeypatch.setenv(opening.LSL_CONFIG, "/etc/lsl_api.cfg")
    monkeypatch.setattr(pylsl, "set_config_content", lambda content: pytest.fail("it is changed"))
    opening.configure_lsl("machine")
