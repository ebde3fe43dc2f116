"""The thread at the port: real pseudo-terminals, real sockets, ports that are bad."""

import contextlib
import os
import socket
import subprocess
import sys
import threading
import time
from typing import Literal

import pytest

from cubeling import robot
from cubeling.affect import Emotion
from cubeling.robot.conformance import SimulatedChannel, run_checks
from cubeling.robot.errors import RobotError
from cubeling.robot.protocol.timing import ACTIONS_MAX, FAILSAFE_PROMISE
from cubeling.robot.protocol.wire import FrameReader
from cubeling.robot.simulators.cubeling.simulator import Simulator
from cubeling.robot.simulators.port import SimulatedPort

HAPPY = Emotion(0.8, 0.5)

KINDS: list[Literal["pty", "tcp"]] = ["tcp"] if sys.platform == "win32" else ["pty", "tcp"]


class SilencedSimulator(Simulator):
    """A robot that can be told to hang: it hears nothing and says nothing."""

    hung = False

    def receive(self, data: bytes, now: float) -> None:
        if not self.hung:
            super().receive(data, now)

    def bytes_to_send(self) -> bytes:
        return b"" if self.hung else super().bytes_to_send()


@pytest.fixture(params=KINDS)
def port(request):
    with SimulatedPort(SilencedSimulator(seed=3), kind=request.param) as port:
        yield port


def descriptors() -> int:
    return len(os.listdir("/dev/fd")) if os.path.isdir("/dev/fd") else 0


def threads() -> int:
    return sum(thread.name.startswith("robot") for thread in threading.enumerate())


def test_an_emotion_travels_to_the_robot_and_back_over_a_real_port(port, soon):
    with robot.connect(port.url) as dino:
        assert dino.telemetry.state == "ready"
        dino.express(HAPPY)
        assert dino.telemetry.commanded == HAPPY
        soon(lambda: dino.telemetry.acknowledged == HAPPY)
        soon(lambda: dino.telemetry.label == "happy")
        assert set(dino.telemetry.joints) == {joint.name for joint in dino.catalogue.joints}
        assert 0.7 < (dino.telemetry.battery or 0) <= 1
        assert 0 < (dino.telemetry.round_trip or 0) < 1
        dino.play("nod")
        soon(lambda: dino.telemetry.motion == "nod")
        dino.stop()
        soon(lambda: dino.telemetry.stopped)


def test_the_simulated_robot_is_behind_the_same_interface_without_a_port(soon):
    with robot.connect("sim:cubeling?seed=7") as dino:
        dino.express(HAPPY)
        soon(lambda: dino.telemetry.label == "happy")


def test_sim_is_the_simulated_robot_of_our_protocol():
    with robot.connect("sim") as dino:
        assert dino.url == "sim:cubeling"


def test_a_client_may_leave_and_another_one_come(port, soon):
    for _ in range(3):
        with robot.connect(port.url) as dino:
            dino.express(HAPPY)
            soon(lambda dino=dino: dino.telemetry.acknowledged == HAPPY)
            assert dino.telemetry.counts.crc_errors == 0


def test_both_directions_can_be_recorded(port, soon):
    taken = {"tx": b"", "rx": b""}

    def note(direction, data, now):
        taken[direction] += data

    with robot.connect(port.url, on_bytes=note) as dino:
        soon(lambda: dino.telemetry.label is not None)
        counts = dino.telemetry.counts
    for direction, at_least in (("tx", counts.frames_sent), ("rx", counts.frames_received)):
        reader = FrameReader()
        assert len(reader.feed(taken[direction])) >= at_least > 0
        assert reader.errors == 0


def test_a_silent_robot_blocks_nothing_and_is_found_again(soon):
    simulator = SilencedSimulator()
    with SimulatedPort(simulator) as port, robot.connect(port.url) as dino:
        dino.check()
        simulator.hung = True
        soon(lambda: dino.telemetry.state == "lost")
        dino.express(HAPPY)
        with pytest.raises(RobotError, match=r"fallen silent \(last heard \d+\.\d s ago\)"):
            dino.check()
        simulator.hung = False
        soon(lambda: dino.telemetry.acknowledged == HAPPY)
        dino.check()
        assert dino.telemetry.counts.sessions == 2


# pySerial 3.5 does not close a socket that the other side has reset; the garbage collector does.
@pytest.mark.filterwarnings("ignore:unclosed <socket:ResourceWarning")
def test_a_port_that_is_unplugged_is_lost_and_when_it_is_back_so_is_the_robot(soon):
    first = SimulatedPort(kind="tcp")
    number = int(first.url.rpartition(":")[2])
    with robot.connect(first.url) as dino:
        dino.express(HAPPY)
        soon(lambda: dino.telemetry.acknowledged == HAPPY)
        first.close()
        soon(lambda: dino.telemetry.state == "lost")
        with SimulatedPort(kind="tcp", tcp_port=number):
            soon(lambda: dino.telemetry.acknowledged == HAPPY)


@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are not on Windows")
def test_a_pseudo_terminal_that_is_gone_is_lost_and_not_looked_for_again(soon):
    # Its name may be a person's shell by then.
    port = SimulatedPort()
    with robot.connect(port.url) as dino:
        port.close()
        soon(lambda: dino.telemetry.state == "lost")
        dino.express(HAPPY)


def test_a_program_that_is_killed_leaves_a_neutral_robot_behind(soon):
    program = (
        "import sys, robot; dino = robot.connect(sys.argv[1]);"
        "dino.express(robot.Emotion(0.8, 0.5)); sys.stdin.read()"
    )
    simulator = Simulator()
    with SimulatedPort(simulator) as port:
        command = [sys.executable, "-c", program, port.url]
        with subprocess.Popen(command, stdin=subprocess.PIPE) as child:
            soon(lambda: simulator.body.target == HAPPY, within=20)
            child.kill()
            child.wait()
            killed = time.monotonic()
            soon(lambda: simulator.body.target == Emotion(0, 0))
            assert time.monotonic() - killed < FAILSAFE_PROMISE + 0.5  # on a busy machine


def test_closing_twice_is_closing_once_and_nothing_is_left_open(port, soon):
    before, running = descriptors(), threads()
    dino = robot.connect(port.url)
    dino.close()
    dino.close()
    assert dino.telemetry.state == "closed"
    dino.express(HAPPY)
    with pytest.raises(RobotError, match="was closed"):
        dino.check()
    soon(lambda: descriptors() <= before + 1)  # the far end of a socket that has just been left
    assert threads() == running


def test_a_simulated_port_leaves_nothing_open():
    before, running = descriptors(), threads()
    for kind in KINDS:
        port = SimulatedPort(kind=kind)
        port.close()
        port.close()
    assert (descriptors(), threads()) == (before, running)


def test_an_unknown_motion_is_refused_and_the_known_ones_named():
    with (
        robot.connect("sim:cubeling") as dino,
        pytest.raises(RobotError, match="Dino cannot play 'fly'; it knows neutral, happy, angry"),
    ):
        dino.play("fly")


def test_single_joints_are_turned_by_name_where_the_robot_has_that():
    with robot.SteppedRobot("sim:cubeling") as dino:
        assert dino.moves_joints
        dino.move({"neck up": -0.5, "torso": 0.2618}, duration=1.0)
        dino.advance(1.3)
        assert dino.telemetry.held == {"neck up", "torso"}
        assert dino.telemetry.joints["neck up"] == pytest.approx(-0.5, abs=0.02)
        dino.move({"torso": None})
        dino.advance(0.2)
        assert dino.telemetry.held == {"neck up"}
        for angles, duration, says in (
            ({"neck": 0.1}, 0.0, "Dino has no joint 'neck': right shoulder"),
            ({"torso": 0.3}, 0.0, "torso turns from -15° to 15°, not to 17°"),
            ({"torso": float("nan")}, 0.0, "not to nan°"),
            ({"torso": 0.1}, -1.0, "a move takes 0 to 65 s, not -1 s"),
        ):
            with pytest.raises(RobotError, match=says):
                dino.move(angles, duration)
        for _ in range(ACTIONS_MAX):
            dino.play("nod")
        with pytest.raises(RobotError, match="one move too many"):
            dino.move({"torso": 0.1})
    with robot.SteppedRobot("sim:pleo") as pleo:
        assert not pleo.moves_joints
        with pytest.raises(RobotError, match="joints of Pleo cannot be turned one by one"):
            pleo.move({"torso": 0.1})


def test_a_recorder_that_breaks_is_reported_and_not_taken_for_an_unplugged_robot(soon):
    def full(direction, data, now):
        raise OSError("disk full")

    with pytest.raises(RobotError, match="disk full"):
        robot.connect("sim:cubeling", on_bytes=full)


@pytest.mark.parametrize(
    ("url", "says"),
    [
        ("/dev/nowhere", "cannot open the port /dev/nowhere: there is no such port"),
        ("nonsense://x", "cannot open the port nonsense://x: invalid URL"),
        ("", "a port must be named"),
        ("sim:cat", "there is no simulated robot 'sim:cat'; there is sim:cubeling"),
        ("sim:cubeling?fly=1", "'fly' is no option of a simulator"),
        ("sim:cubeling?seed=x", "the seed must be a whole number"),
        (__file__, "cannot open the port"),
        ("sim?drop=0.1", "say which, as in sim:cubeling"),
        ("loop://?x", "cannot open the port loop://?x"),  # pySerial trips over its own message
        ("hwgrep://(", "cannot open the port hwgrep://("),
    ],
)
def test_a_bad_port_is_refused_in_one_line(url, says):
    with pytest.raises(RobotError) as refusal:
        robot.connect(url)
    assert says in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_a_socket_where_nobody_listens_is_refused():
    with socket.create_server(("127.0.0.1", 0)) as server:
        number = server.getsockname()[1]
    with pytest.raises(RobotError, match="cannot open the port socket://"):
        robot.connect(f"socket://127.0.0.1:{number}")


def test_an_unknown_protocol_is_refused():
    with pytest.raises(RobotError, match="known are: cubeling"):
        robot.connect("sim:cubeling", "klingon")


def test_a_line_that_only_echoes_is_not_taken_for_a_robot():
    running = threads()
    says = r"nobody on loop:// answers .* within 0\.2 s: only an echo of what was sent"
    with pytest.raises(RobotError, match=says):
        robot.connect("loop://", answer_within=0.2)
    assert threads() == running


class Monotonous(Simulator):
    """Sends the same bytes again and again, and nothing else."""

    def __init__(self, data: bytes) -> None:
        super().__init__()
        self._data = data

    def bytes_to_send(self) -> bytes:
        return self._data


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"", "nothing was received: is the robot switched on"),
        (b"\0", r"\d+ bytes were received, nothing but zeros"),
        (b"ready>\r\n", r"\d+ bytes were received, but no answer"),
    ],
    ids=["silence", "zeros", "noise"],
)
def test_what_is_on_a_line_without_a_robot_is_told_apart(data, says):
    with (
        SimulatedPort(Monotonous(data)) as port,
        pytest.raises(RobotError, match=f"nobody on .*: {says}"),
    ):
        robot.connect(port.url, answer_within=0.2)
    with pytest.raises(RobotError, match=f"no robot of this protocol .*: {says}"):
        run_checks(SimulatedChannel(Monotonous(data)), [], 1)


@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are not on Windows")
def test_a_port_that_another_program_uses_is_refused():
    with (
        SimulatedPort() as port,
        robot.connect(port.url),
        pytest.raises(RobotError, match="another program is using it"),
    ):
        robot.connect(port.url)


@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are not on Windows")
def test_a_robot_that_does_not_read_blocks_nothing(soon):
    near, far = os.openpty()
    try:
        with pytest.raises(RobotError, match="nobody on"):
            robot.connect(os.ttyname(far), answer_within=0.3)
    finally:
        os.close(near)
        os.close(far)


def test_a_line_full_of_noise_is_given_up_in_time():
    # Somebody sends garbage as fast as the line takes it.
    ending = threading.Event()
    with socket.create_server(("127.0.0.1", 0)) as server:

        def babble() -> None:
            client, _ = server.accept()
            with client, contextlib.suppress(OSError):
                client.settimeout(0.05)
                while not ending.is_set():
                    with contextlib.suppress(TimeoutError):
                        client.send(bytes(range(256)) * 16)

        babbler = threading.Thread(target=babble)
        babbler.start()
        start = time.monotonic()
        try:
            with pytest.raises(RobotError, match="nobody on"):
                robot.connect(f"socket://127.0.0.1:{server.getsockname()[1]}", answer_within=0.3)
            assert time.monotonic() - start < 2
        finally:
            ending.set()
            babbler.join()


def test_a_robot_that_answers_over_a_bad_line_has_longer_to_introduce_itself():
    url = "sim:cubeling?drop=0.25&delay=20ms&seed=4"
    with robot.connect(url, answer_within=0.3) as dino:
        assert dino.telemetry.state == "ready"
        assert len(dino.catalogue.joints) == 14
