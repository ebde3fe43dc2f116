"""Connects to the robot on a port."""

import time
from pathlib import Path

from cubeling.robot.contract.driver import DRIVERS
from cubeling.robot.contract.port import ByteHook, Clock, Direction
from cubeling.robot.errors import RobotError
from cubeling.robot.link.exchange import IoThread
from cubeling.robot.link.line_sample import LineSample
from cubeling.robot.link.linked_robot import Robot
from cubeling.robot.link.transport import opener, space_writes

CATALOGUE_TIMEOUT_S = 10.0
"""Additional time to report its catalogue for a robot that answers over a very lossy line [s]."""


def connect(
    url: str,
    protocol: str | None = None,
    *,
    clock: Clock = time.monotonic,
    on_bytes: ByteHook | None = None,
    answer_within: float | None = None,
    settings: Path | str | None = None,
) -> Robot:
    """Return the robot on a port, once it has reported its catalogue; the caller closes it.

    Parameters
    ----------
    url
        Any pySerial URL ("/dev/ttyACM0", "COM3", "socket://localhost:5000"), or a simulated robot:
        "sim" (which is "sim:cubeling"), "sim:pleo?seed=7". The protocol may be a prefix:
        "pleo:/dev/ttyACM0".
    protocol
        One of `DRIVERS`; None for the one in the URL, or "cubeling".
    clock
        The time [s] of the link and of a simulated robot.
    on_bytes
        Receives every byte of both directions, in the link's thread. It must be fast.
    answer_within
        How long to wait for the robot [s]; None for the protocol's default. A board that reboots
        when its port is opened needs longer.
    settings
        A TOML file for the driver: the motion of each mood …; None for the bundled one.

    Returns
    -------
    Robot
        Ready for `express`.

    Raises
    ------
    RobotError
        If the port does not open, or nobody on it answers in time. Nothing stays open then.
    """
    url, protocol = protocol_of(url, protocol)
    kind = DRIVERS[protocol]
    # The microsecond of the call tells this program from others.
    host = int(clock() * 1e6) % 0xFFFFFFFF + 1
    driver = kind.make(host, None if settings is None else Path(settings))
    # Simulators are reached by URL whatever the protocol, also where a driver opens its own line.
    if kind.opener is None or url.startswith("sim:"):
        open_port = opener(url, clock, getattr(driver, "baud", kind.baud))
    else:
        open_port = kind.opener(url, clock)
    if kind.spacing:
        open_port = space_writes(open_port, kind.spacing, clock)
    sample = LineSample()

    def observe(direction: Direction, data: bytes, now: float) -> None:
        sample.add(direction, data)
        if on_bytes is not None:
            on_bytes(direction, data, now)

    thread = IoThread(url, open_port, driver, clock, observe)
    robot = Robot(url, thread, driver, clock)
    wait = kind.answer_within if answer_within is None else answer_within
    try:
        if robot.wait_until_ready(wait):
            return robot
        if thread.failure is not None:
            robot.check()
        # Whoever speaks the protocol but loses many frames gets more time; a dead line does not.
        answers = robot.telemetry.silence is not None
        if answers and robot.wait_until_ready(CATALOGUE_TIMEOUT_S):
            return robot
    except BaseException:  # also Ctrl-C while waiting: nothing stays open then either
        robot.close()
        raise
    robot.close()
    if answers:
        raise RobotError(
            f"the robot on {url} answers, but has not introduced itself within "
            f"{wait + CATALOGUE_TIMEOUT_S:g} s: is the line very bad?"
        )
    raise RobotError(
        f"nobody on {url} answers in the protocol {protocol!r} within {wait:g} s: "
        + sample.diagnosis()
    )


def protocol_of(url: str, protocol: str | None) -> tuple[str, str]:
    """Return the URL of the port without a protocol prefix, and the protocol.

    >>> protocol_of("sim", None), protocol_of("pleo:COM3", None)
    (('sim:cubeling', 'cubeling'), ('COM3', 'pleo'))
    """
    named, colon, rest = url.partition(":")
    if colon and named in DRIVERS:
        if protocol not in (None, named):
            raise RobotError(f"{url!r} is to be spoken to in {protocol!r}: which of the two?")
        url, protocol = rest, named
    if url == "sim":
        url = f"sim:{protocol or 'cubeling'}"
    if protocol is None:
        simulated = url.removeprefix("sim:").partition("?")[0]
        known = url.startswith("sim:") and simulated in DRIVERS
        protocol = simulated if known else "cubeling"
    if protocol not in DRIVERS:
        raise RobotError(f"no robot speaks {protocol!r} here; known are: {', '.join(DRIVERS)}")
    return url, protocol
