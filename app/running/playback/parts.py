"""The parts of a session that the player can exchange while it runs."""

import platform
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from cubeling.app.errors import AppError
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.running.opened_session import OpenedSession
from cubeling.app.running.playback.transport import Transport
from cubeling.app.running.recording.wire_tap import WireTap
from cubeling.app.running.robots import RobotLine
from cubeling.app.ui.playback.status import MenuChoice
from cubeling.characters import Character, load_to_play
from cubeling.robot import serial_ports
from cubeling.tracking import FrameSource, Intrinsics, TrackingError, open_source

MAX_CAMERAS = 4
"""Numbers of cameras that are tried where the system does not list them."""


@dataclass(frozen=True)
class Part:
    """A part of a session: what can be chosen for it, and how it is exchanged."""

    name: str
    """That of the option that chooses it."""

    refusal: Callable[[OpenedSession], str]
    """Returns why it has to stay as it is now, or ""."""

    choices: Callable[[OpenedSession], Iterator[MenuChoice]]
    """Yields what can be chosen, the present one first; called on a thread of its own."""

    open: Callable[[OpenedSession, str], Any]
    """Opens a choice, or raises the error of its room; called on a thread of its own."""

    exchange: Callable[[OpenedSession, Transport, str, Any], None]
    """Puts what was opened in the place of the present one; if it fails, that one stays."""


def discard(opened: Any) -> None:
    """Close what was opened, if it can be closed."""
    close: Callable[[], None] | None = getattr(opened, "close", None)
    if close is not None:
        close()


def _why_fixed(session: OpenedSession) -> str:
    return session.why_it_stays if session.keeps_scenario else ""


def _refuse_camera(session: OpenedSession) -> str:
    if not session.source.live:
        return "The frames are those of a recording"
    return session.why_it_stays if session.recording is not None else ""


def _cameras(session: OpenedSession) -> Iterator[MenuChoice]:
    if not session.source.live:
        return
    present = session.options.source
    listed = dict.fromkeys((present, session.asked.source, *_camera_uris()))
    for uri in listed:
        if uri == present or _opens(uri):
            yield MenuChoice(
                "camera", uri, uri.replace("camera:", "camera "), present=uri == present
            )


def _camera_uris() -> list[str]:
    numbers = list(range(MAX_CAMERAS))
    if platform.system() == "Linux":
        names = (path.name.removeprefix("video") for path in Path("/dev").glob("video*"))
        numbers = sorted(int(name) for name in names if name.isdecimal())
    return [f"camera:{number}" for number in numbers]


def _opens(uri: str) -> bool:
    try:
        with open_source(uri):
            return True
    except TrackingError:
        return False


def _open_camera(session: OpenedSession, uri: str) -> FrameSource:
    return session.open_camera(uri, session.source.size)


def _exchange_camera(
    session: OpenedSession, transport: Transport, uri: str, camera: FrameSource
) -> None:
    asked = session.asked
    path = asked.intrinsics if uri == asked.source else None
    session.keep_lens()
    calibration = camera.intrinsics if path is None else Intrinsics.load(path)
    calibration = calibration or session.lenses.load(uri, camera.size)
    session.playground.look_through(intrinsics_for(calibration, camera.size))
    session.source.close()
    session.source = camera
    session.options = replace(session.options, source=uri, intrinsics=path)
    session.restart()
    transport.follow_source()


def _characters(session: OpenedSession) -> Iterator[MenuChoice]:
    own = session.playground.scenario.character
    present = session.options.character or own
    for name in dict.fromkeys(
        (present, session.asked.character or own, *Character.bundled_names())
    ):
        yield MenuChoice("character", name, Path(name).name, present=name == present)


def _open_character(session: OpenedSession, name: str) -> Character:
    options = session.options
    return load_to_play(
        name, own_motions_only=options.own_motions_only, whole_limbs=options.whole_limbs
    )


def _exchange_character(
    session: OpenedSession, transport: Transport, name: str, character: Character
) -> None:
    try:
        session.playground.exchange_character(character)
    except AppError as error:
        raise AppError(f"{error}, as {session.options.scenario} asks") from error
    session.options = replace(session.options, character=name)


@dataclass(frozen=True)
class _TappedRobot:
    """A robot with the tap on its wire."""

    line: RobotLine
    wire: WireTap

    def close(self) -> None:
        self.line.close()


def _robots(session: OpenedSession) -> Iterator[MenuChoice]:
    present = session.options.robot
    labels = {session.asked.robot: session.asked.robot}
    labels |= {"sim": "simulated robot", "none": "no robot"}
    for port in serial_ports():
        if port.vendor is not None:  # a built-in port seldom has a robot
            pleo = port.guess is not None and "Pleo" in port.guess
            url = f"pleo:{port.url}" if pleo else port.url
            labels[url] = f"{url}: {port.guess or port.description}"
    for url in dict.fromkeys((present, *labels)):
        yield MenuChoice("robot", url, labels.get(url, url), present=url == present)


def _open_robot(session: OpenedSession, url: str) -> _TappedRobot:
    wire = WireTap()
    settings = session.asked.robot_settings if url == session.asked.robot else None
    return _TappedRobot(RobotLine.open(url, session.clock, wire, settings), wire)


def _exchange_robot(
    session: OpenedSession, transport: Transport, url: str, robot: _TappedRobot
) -> None:
    session.exchange_robot(robot.line, robot.wire, transport.timestamp or 0.0)
    session.options = replace(session.options, robot=url)


PARTS: dict[str, Part] = {
    part.name: part
    for part in (
        Part("camera", _refuse_camera, _cameras, _open_camera, _exchange_camera),
        Part("character", _why_fixed, _characters, _open_character, _exchange_character),
        # A replay does not depend on the robot, so a recording may go on with another one.
        Part("robot", lambda session: "", _robots, _open_robot, _exchange_robot),
    )
}
"""The parts by name, in the order of the menu's columns: a new one is registered here."""
