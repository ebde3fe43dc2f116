"""What goes over the robot's line, and how well the line works."""

from cubeling.app.pipeline.step import RobotView
from cubeling.app.ui.panels.content import Fact, LogLines, Note, Panel, Tone, Widget
from cubeling.app.ui.panels.monitor import SessionMonitor
from cubeling.app.ui.panels.wire_log import MAX_MESSAGES, Traffic, WireMessage
from cubeling.robot import Telemetry, protocol_of

STATE_TONES: dict[str, Tone] = {"ready": "good", "lost": "bad"}
"""Tones of the link's states; the others are warnings."""

SENDERS = {"tx": "to robot", "rx": "from robot"}
"""Words for the directions of bytes."""


def content(monitor: SessionMonitor) -> tuple[Widget, ...]:
    """Return the health of the link and the last messages of both sides."""
    robot, telemetry = monitor.robot, monitor.robot.telemetry
    if telemetry is None:
        return (Note("No robot is connected: choose one with --robot sim, or --robot PORT."),)
    _, protocol = protocol_of(monitor.options.robot, None)
    traffic = monitor.wire.read(protocol, robot.catalogue, robot.time)
    rows = tuple(_row(each, robot.time) for each in (*traffic.messages, *traffic.routine))
    facts = _health(monitor.options.robot, telemetry, traffic)
    second = () if robot.second is None else _second(monitor.options.second_robot, robot.second)
    return (*facts, *second, LogLines(rows, MAX_MESSAGES + 2))


def _health(url: str, telemetry: Telemetry, traffic: Traffic) -> tuple[Widget, ...]:
    counts = telemetry.counts
    faults = counts.retries + counts.crc_errors
    reconnections = max(counts.sessions - 1, 0)
    battery = "unknown" if telemetry.battery is None else f"{100 * telemetry.battery:.0f} %"
    facts = [
        _link("Link", url, telemetry),
        Fact("Round trip", _trip(telemetry)),
        *(Fact(_sender(way), _flow(*traffic.rates[way])) for way in traffic.rates),
        Fact(
            "Repeated, damaged, reconnected",
            f"{counts.retries}, {counts.crc_errors}, {reconnections}",
            "warning" if faults or reconnections else "good",
        ),
        Fact("Battery", battery + (", charging" if telemetry.charging else "")),
    ]
    if telemetry.limp:
        facts.append(Fact("Motors", "without power", "bad"))
    if telemetry.complaint:
        facts.append(Fact("Complaint", telemetry.complaint, "bad"))
    return tuple(facts)


def _second(url: str, robot: RobotView) -> tuple[Widget, ...]:
    """Return how well the line of the second player's robot works."""
    if robot.telemetry is None:
        return ()
    link = _link(f"Link of {robot.name}", url, robot.telemetry)
    return link, Fact(f"Round trip of {robot.name}", _trip(robot.telemetry))


def _link(name: str, url: str, telemetry: Telemetry) -> Fact:
    tone = STATE_TONES.get(telemetry.state, "warning")
    return Fact(name, f"{telemetry.state} on {url}", tone)


def _trip(telemetry: Telemetry) -> str:
    """Return how long the robot takes to answer, and when it was heard last."""
    trip, silence = telemetry.round_trip, telemetry.silence
    measured = "not measured" if trip is None else f"{1e3 * trip:.1f} ms"
    heard = "never" if silence is None else f"{1e3 * silence:.0f} ms ago"
    return f"{measured}, last heard {heard}"


def _sender(way: str) -> str:
    return SENDERS[way].capitalize()


def _flow(messages: float, size: float) -> str:
    return f"{messages:.0f} messages/s, {size:.0f} bytes/s"


def _row(message: WireMessage, now: float) -> tuple[str, str, str]:
    age = max(now - message.time, 0.0)
    return f"{age:.1f} s", SENDERS[message.direction], message.text


SERIAL = Panel("serial", "Robot's line", 400.0, content)
