"""`cubeling bridge`, and play and replay over a broker."""

import os
import signal
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from cubeling import recordings
from cubeling.affect import Emotion
from cubeling.app.commands.robots.bridge import EventPrinter
from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.app.running.network.bridge import Bridge, RecordedPlayer, patterns_of
from cubeling.app.running.network.connection import Network
from cubeling.app.running.network.players import CastPublisher, PlayerPublisher
from cubeling.app.session import Recorder
from cubeling.app.session.encoding import encode
from cubeling.app.ui.roster import table
from cubeling.characters import ActionIntent, CharacterCommand, LocomotionIntent
from cubeling.robot.network import Member
from cubeling.robot.network.roster import Roster
from tests.robot.network.mosquitto import Mosquitto, needs_mosquitto

COMPANION = Path(recordings.__path__[0]) / "companion.mcap"


def soon(condition: Callable[[], Any], within: float = 8.0) -> None:
    end = time.monotonic() + within
    while not condition():
        assert time.monotonic() < end, f"not within {within} s"
        time.sleep(0.005)


@pytest.fixture
def broker(tmp_path: Path) -> Iterator[Mosquitto]:
    running = Mosquitto(tmp_path)
    running.start()
    yield running
    running.kill()


def command(action: str, **changes: Any) -> CharacterCommand:
    weight = changes.pop("weight", 0.0)
    intent = None if action == "move" else ActionIntent(action, weight)
    return CharacterCommand(0.0, LocomotionIntent(1.0), intent, **changes)


def test_an_action_is_published_when_it_begins_and_only_if_visible():
    with Network() as network:
        line = PlayerPublisher(network, "ann")
        for what in (
            command("idle"), command("kiss", weight=0.5), command("kiss"), command("move"),
            command("shout", visible=False), command("shout"), command("idle"), command("kiss"),
        ):  # fmt: skip
            line.publish_action(what)
        assert line.client.endpoint.counts["made"] == 3


@pytest.fixture(scope="module")
def companion(scripted_session: Callable[[str], Path]) -> Path:
    """A session with every channel."""
    return scripted_session("companion")


@pytest.mark.full
def test_a_recorded_session_drives_robots_without_a_broker(companion):
    robots = {"rex": "sim", "max": "sim:cubeling?seed=2"}
    with Network() as network, Bridge(network, robots, {"ann": companion}) as bridge:
        roster = bridge.roster.endpoint
        assert bridge.advance(0.0)
        soon(lambda: len(roster.members) == 3)
        assert not bridge.advance(1000.0)

        def state(name: str) -> Any:
            return roster.members[Member("home", "robot", name)].messages.get("state")

        def is_done(name: str) -> bool:  # two kisses and a shout, each again when it is stronger
            return (state(name).played, state(name).unknown) == (6, 0)

        soon(lambda: is_done("rex") and is_done("max"))
        for name in ("rex", "max"):
            assert (state(name).link, state(name).player) == ("ready", "home/ann")
        with bridge.roster.lock:
            assert table(roster, time.monotonic()).row_count == 3


def test_a_recorded_session_plays_in_its_own_time(companion):
    with Network() as network:
        line = CastPublisher(network, "ann")
        player = RecordedPlayer(line, companion)
        made = []
        for second in range(60):
            player.advance(100.0 + second)
            made.append(line.lead.client.endpoint.counts["made"])
        assert (made[2], made[5], made[-1]) == (0, 1, 6)


def test_each_of_a_cast_is_published_by_its_name_and_each_robot_follows_whom_it_is_told(tmp_path):
    """The robot that follows all shows the first character, as if there were no others."""
    path = tmp_path / "cast.mcap"
    calm, glad = (
        Emotion(valence, 0.0, word) for valence, word in ((0.0, "neutral"), (0.8, "happy"))
    )
    with Recorder(path, {"scenario": "companion"}) as recorder:
        for topic, emotion, what in (
            ("/character/command", calm, command("kiss")),
            ("/cast/vleo/command", glad, command("shout")),
        ):
            recorder._json(topic, partial(encode, what), 0.0)
            feels = EmotionTarget(emotion, 0.0)
            named = "/robot/emotion" if topic.startswith("/char") else "/cast/vleo/emotion"
            recorder._json(named, partial(encode, feels), 0.0)
        recorder._steps = 1  # a session without a frame would be left out
    robots = {"rex": "sim", "tim": "sim:cubeling?seed=2"}
    with (
        Network() as network,
        Bridge(network, robots, {"ann": path}, follow=["tim=ann:vleo"]) as bridge,
    ):
        members = bridge.roster.endpoint.members
        bridge.advance(0.0)
        bridge.advance(1.0)

        def shown(name: str) -> Any:
            entry = members.get(Member("home", "robot", name))
            state = None if entry is None else entry.messages.get("state")
            return None if state is None else state.player

        soon(lambda: (shown("rex"), shown("tim")) == ("home/ann", "home/ann:vleo"))
        feels = members[Member("home", "player", "ann:vleo")].messages["emotion"]
        assert feels.label == "happy"


def test_a_robot_follows_those_that_are_named_for_it_else_those_for_all():
    follow = ["ann", "tim=ann:vleo", "tim=south/*"]
    found = patterns_of(follow, ["rex", "tim"], "hall")
    assert [[str(each) for each in found[name]] for name in ("rex", "tim")] == [
        ["hall/ann"],
        ["hall/ann:vleo", "south/*"],
    ]
    assert [str(each) for each in patterns_of([], ["rex"], "hall")["rex"]] == ["hall/*"]
    with pytest.raises(AppError, match="no robot of this bridge is called 'max'"):
        patterns_of(["max=ann"], ["rex"], "hall")


def test_a_character_whose_name_is_too_long_for_the_network_is_told_once():
    said: list[str] = []
    with Network() as network:
        line = CastPublisher(network, "ann", on_problem=said.append)
        assert line.of("x" * 40) is line.of("x" * 40) is None
        assert line.of("vleo") is line.of("vleo") is not None
    assert len(said) == 1


def wrong_inputs() -> dict[str, tuple[list[str], str]]:
    return {
        "alone": (["bridge"], "--mqtt"),
        "no name": (["bridge", "--mqtt", "mqtt://h", "--robot", "sim"], "--robot rex=sim"),
        "twice": (["bridge", "--robot", "a=sim", "--robot", "a=sim", "--play", "x=y"], "twice"),
        "bad name": (["bridge", "--robot", "a/b=sim", "--play", f"x={COMPANION}"], "'a/b'"),
        "bad site": (["bridge", "--mqtt", "mqtt://h", "--site", "+"], "'+'"),
        "no broker": (["bridge", "--mqtt", "http://h"], "mqtt://HOST"),
        "no session": (["bridge", "--robot", "a=sim", "--play", "x=absent.mcap"], "absent.mcap"),
        "no robot": (["bridge", "--mqtt", "mqtt://127.0.0.1:1", "--robot", "a=sim:cat"], "sim:cat"),
        "no player": (
            ["replay", str(COMPANION), "--no-pictures", "--mqtt", "mqtt://h"], "--player NAME",
        ),
        "no such robot": (
            ["bridge", "--robot", "a=sim", "--play", f"x={COMPANION}", "--follow", "b=x"], "'b'",
        ),
        "no mqtt": (["replay", str(COMPANION), "--no-pictures", "--player", "ann"], "--mqtt URL"),
    }  # fmt: skip


@pytest.mark.parametrize("what", wrong_inputs())
def test_invalid_options_end_in_one_line(cubeling, what):
    words, says = wrong_inputs()[what]
    code, out, err = cubeling(*words)
    assert (code, err.count("\n")) == (2, 1)
    assert says in err
    assert "online" not in out


def test_the_help_has_an_example(cubeling):
    code, out, _ = cubeling("bridge", "--help")
    assert code == 0
    assert "Example: cubeling bridge --play" in out


def test_an_invalid_session_is_refused_and_leaves_nothing_open(tmp_path):
    text = tmp_path / "text.mcap"
    text.write_text("no session")
    with Network() as network, pytest.raises(AppError, match="not a session"):
        Bridge(network, {"rex": "sim"}, {"ann": text})


def test_an_absent_broker_is_reported_in_one_line(cubeling):
    code, out, _ = cubeling("bridge", "--mqtt", "mqtt://127.0.0.1:1", "--seconds", "0.5")
    assert code == 0
    assert out.count("trying again") == 1


@needs_mosquitto
def test_a_wrong_password_ends_in_one_line_that_does_not_show_it(cubeling, tmp_path):
    passwords = tmp_path / "passwords"
    passwords.touch()
    subprocess.run(["mosquitto_passwd", "-b", str(passwords), "ann", "right"], check=True)
    broker = Mosquitto(tmp_path, f"password_file {passwords}")
    broker.start()
    url = broker.url.replace("//", "//ann:sesame@")
    for words in (
        ["bridge", "--mqtt", url],
        ["replay", str(COMPANION), "--no-pictures", "--mqtt", url, "--player", "ann"],
    ):
        code, _, err = cubeling(*words)
        assert (code, err.count("\n")) == (2, 1)
        assert "does not let us in as 'ann'" in err
        assert "sesame" not in err
    broker.kill()


@needs_mosquitto
def test_a_bridge_that_is_killed_is_lost_by_its_last_will(broker):
    def start() -> subprocess.Popen[bytes]:
        words = ["bridge", "--mqtt", broker.url, "--robot", "rex=sim"]
        return subprocess.Popen(
            [sys.executable, "-c", "from cubeling.app.cli import main; main()", *words],
            stdout=subprocess.DEVNULL,
            cwd=Path(__file__).parents[3],
        )

    with Network(broker.url) as network:
        roster = network.join(Roster(), "onlooker").endpoint
        rex = Member("home", "robot", "rex")

        def status() -> str:
            return roster.members[rex].messages["status"].status if rex in roster.members else ""

        bridge = start()
        soon(lambda: status() == "online", within=30.0)
        bridge.send_signal(signal.SIGKILL)
        bridge.wait(5.0)
        soon(lambda: status() == "lost")


@needs_mosquitto
def test_a_lost_broker_is_reported_once(broker):
    said: list[str] = []
    with Network(broker.url) as network:
        line = PlayerPublisher(network, "ann", on_problem=said.append)
        calm = EmotionTarget(Emotion(0.0, 0.0, "neutral"), 0.0)
        line.publish(command("idle"), calm)
        broker.kill()
        soon(lambda: line.client.state == "away")
        for _ in range(3):
            line.publish(command("kiss"), calm)
        assert len(said) == 1
        assert broker.url in said[0]
        broker.start()
        soon(lambda: line.client.state == "connected")
        line.publish(command("idle"), calm)
        broker.kill()
        soon(lambda: line.client.state == "away")
        line.publish(command("idle"), calm)
        assert len(said) == 2


@needs_mosquitto
def test_a_hanging_broker_does_not_delay_the_picture(broker):
    with Network(broker.url) as network:
        line = PlayerPublisher(network, "ann")
        soon(lambda: line.client.state == "connected")
        os.kill(broker.pid, signal.SIGSTOP)
        took = []
        for frame in range(600):
            emotion = EmotionTarget(Emotion(frame / 600, 0.0, "neutral"), frame / 30)
            began = time.perf_counter()
            line.publish(command("kiss" if frame % 2 else "idle"), emotion)
            took.append(time.perf_counter() - began)
        os.kill(broker.pid, signal.SIGCONT)
        assert statistics.median(took) < 0.001  # of 0.033 for a frame
        assert line.client.endpoint.pending <= 64


def test_the_bridge_says_once_that_a_robot_lacks_an_action(companion, capsys):
    printer = EventPrinter(Console(width=200), every=False)
    with (
        Network() as network,
        Bridge(network, {"bit": "sim:opencat"}, {"ann": companion}) as bridge,
    ):
        bridge.advance(0.0)
        soon(lambda: len(bridge.roster.endpoint.members) == 2)
        bridge.advance(1000.0)
        soon(lambda: bridge.robots["bit"].counts["unknown"] == 6)
        for _ in range(3):
            printer.unknown_actions(bridge)
    lines = capsys.readouterr().out.splitlines()
    assert lines == [
        "bit has no motion or sound 'kiss': it does nothing then",
        "bit has no motion or sound 'shout': it does nothing then",
    ]
