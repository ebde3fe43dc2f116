"""What goes over the robot's line, and how well the line works."""

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
    return (*_health(monitor.options.robot, telemetry, traffic), LogLines(rows, MAX_MESSAGES + 2))


def _health(url: str, telemetry: Telemetry, traffic: Traffic) -> tuple[Widget, ...]:
    counts = telemetry.counts
    trip = (
        "not measured" if telemetry.round_trip is None else f"{1e3 * telemetry.round_trip:.1f} ms"
    )
    silence = telemetry.silence
    heard = "never" if silence is None else f"{1e3 * silence:.0f} ms ago"
    faults = counts.retries + counts.crc_errors
    reconnections = max(counts.sessions - 1, 0)
    battery = "unknown" if telemetry.battery is None else f"{100 * telemetry.battery:.0f} %"
    facts = [
        Fact("Link", f"{telemetry.state} on {url}", STATE_TONES.get(telemetry.state, "warning")),
        Fact("Round trip", f"{trip}, last heard {heard}"),
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


def _sender(way: str) -> str:
    return SENDERS[way].capitalize()


def _flow(messages: float, size: float) -> str:
    return f"{messages:.0f} messages/s, {size:.0f} bytes/s"


def _row(message: WireMessage, now: float) -> tuple[str, str, str]:
    age = max(now - message.time, 0.0)
    return f"{age:.1f} s", SENDERS[message.direction], message.text


SERIAL = Panel("serial", "Robot's line", 400.0, content)
