"""`cubeling doctor`: what this computer has and lacks."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import platform
import shutil
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cubeling.app.errors import AppError
from cubeling.app.ui.display import has_display, is_software_renderer

if TYPE_CHECKING:
    from cubeling.tracking import FrameSource

VERDICT_MARKS = {"good": "[green]✓[/]", "missing": "[yellow]–[/]", "bad": "[red]✗[/]"}

CAMERA_CHECK_S = 4.0
"""How long the camera is read: it locks its exposure after a second or two."""


@dataclass(frozen=True)
class Finding:
    """The result of one check."""

    name: str

    verdict: Literal["good", "missing", "bad"]
    """Cubeling runs without what is "missing", but not with what is "bad"."""

    found: str
    """What was found: one line, for a camera several."""

    remedy: str = ""
    """A command that corrects it, or ""."""


def doctor(
    cameras: Annotated[bool, typer.Option(help="Look for a camera too (takes about 5 s).")] = True,
) -> None:
    """Check what this computer has, and show the commands that install what is missing.

    The exit code is 2 if something is missing without which Cubeling cannot draw or track.

    Example: cubeling doctor
    """
    findings = examine(cameras=cameras)
    table = Table.grid(padding=(0, 2))
    for finding in findings:
        remedy = f"\n[cyan]{escape(finding.remedy)}[/]" if finding.remedy else ""
        table.add_row(
            VERDICT_MARKS[finding.verdict],
            f"[bold]{finding.name}[/]",
            escape(finding.found) + remedy,
        )
    console = Console()
    console.print(table)
    if any(finding.verdict == "bad" for finding in findings):
        raise typer.Exit(2)
    console.print("\nReady. See it work: [cyan]cubeling demo[/]")


def examine(*, cameras: bool = True) -> list[Finding]:
    """Run all checks; no finding is raised as an error."""
    findings = [
        _python(),
        _opencv(),
        _drawing(),
        _video(),
        _characters(),
        _recordings(),
        _display(),
        _sound(),
        _voice(),
        _ports(),
        _broker(),
        _osc(),
        _lsl(),
        _phone(),
    ]
    return [*findings, _camera()] if cameras else findings


def _python() -> Finding:
    system = f"{platform.system()} {platform.machine()}"
    return Finding("Python", "good", f"{platform.python_version()} on {system}")


def _opencv() -> Finding:
    import cv2

    for name in ("opencv-python", "opencv-contrib-python", "opencv-python-headless"):
        if not list(importlib.metadata.distributions(name=name)):
            continue
        # They share one folder: the one that was installed last has overwritten the other.
        return Finding(
            "OpenCV",
            "bad",
            f"{cv2.__version__}, but {name} has overwritten its files",
            f"pip uninstall -y {name} && "
            "pip install --force-reinstall opencv-contrib-python-headless",
        )
    if int(cv2.__version__.split(".")[0]) < 5:
        remedy = "pip install --upgrade -c constraints.txt opencv-contrib-python-headless"
        return Finding("OpenCV", "bad", f"{cv2.__version__} is too old", remedy)
    return Finding("OpenCV", "good", f"{cv2.__version__}")


def _drawing() -> Finding:
    from cubeling.characters import CharacterError
    from cubeling.characters.rendering import create_context

    try:
        context = create_context()
    except CharacterError as error:
        return Finding("drawing", "bad", str(error), _mesa())
    renderer = str(context.info["GL_RENDERER"])
    version = context.version_code
    context.release()
    found = f"OpenGL {version / 100:.1f}, {renderer}"
    if not is_software_renderer(renderer):
        return Finding("drawing", "good", found)
    slow = (
        "software rendering: the processor draws, not a graphics card; expect 10 to 25 pictures "
        "a second.\nA window leaves frames out to keep up; a video has all of them and takes longer"
    )
    return Finding("drawing", "missing", f"{found}\n{slow}")


def _mesa() -> str:
    """Return the command that installs EGL and Mesa's drivers here."""
    for tool, command in (
        ("apt-get", "sudo apt-get install -y libegl1 libgl1 libegl-mesa0 libgl1-mesa-dri"),
        ("dnf", "sudo dnf install -y mesa-libEGL mesa-libGL mesa-dri-drivers"),
        ("pacman", "sudo pacman -S --noconfirm mesa libglvnd"),
    ):
        if shutil.which(tool):
            return command
    return ""


def _video() -> Finding:
    import av

    if "libx264" in av.codecs_available:
        return Finding("video", "good", f"H.264 by PyAV {av.__version__}")
    return Finding("video", "bad", "PyAV has no libx264", "pip install --force-reinstall av")


def _characters() -> Finding:
    from cubeling.characters import Character, CharacterError

    try:
        characters = [Character.load(name) for name in ("human", "vleo", "robot")]
    except CharacterError as error:
        return Finding("characters", "bad", str(error))
    found = ", ".join(f"{one.name} ({len(one.clips)} clips)" for one in characters)
    return Finding("characters", "good", found)


def _recordings() -> Finding:
    from cubeling.app.session.bundled import RECORDED_SCENARIOS, bundled_session

    try:
        names = [bundled_session(name).name for name in RECORDED_SCENARIOS]
    except AppError as error:
        return Finding("recordings", "bad", str(error))
    return Finding("recordings", "good", ", ".join(names))


def _display() -> Finding:
    if has_display():
        return Finding("display", "good", "a window can be opened")
    return Finding("display", "missing", "none: cubeling writes videos instead of opening a window")


def _sound() -> Finding:
    """Open the loudspeaker for a moment, in silence."""
    from cubeling.app.sound import NoSoundError
    from cubeling.app.sound.loudspeaker import load_portaudio, open_stream

    try:
        stream = open_stream(load_portaudio(), None)
    except NoSoundError as error:
        found = f"{error}\nonly videos have sound"
        return Finding("sound", "missing", found, error.remedy)
    latency = 1000 * float(stream.latency)
    stream.close()
    return Finding("sound", "good", f"a loudspeaker, {latency:.0f} ms")


def _voice() -> Finding:
    from cubeling.characters.speech import espeak_installed, espeak_remedy

    if espeak_installed():
        return Finding("voice", "good", "eSpeak NG: characters speak")
    return Finding("voice", "missing", "no eSpeak NG: characters are silent", espeak_remedy())


def _ports() -> Finding:
    """Look for ports that a robot may be on; one that is not on USB says nothing of itself."""
    from cubeling.robot import serial_ports

    ports = serial_ports()
    usb = [port.url for port in ports if port.vendor is not None]
    others = [port.url for port in ports if port.vendor is None]
    if usb:
        return Finding("robot", "good", ", ".join(usb))
    if not others:
        return Finding("robot", "missing", "no serial port", "cubeling robot simulate")
    none = f"none on USB. {', '.join(others)}: built in, probably with nothing connected"
    return Finding("robot", "missing", none, f"cubeling robot try {others[0]}")


def _broker() -> Finding:
    """Look for an MQTT broker; only players in several places need one."""
    path = shutil.which("mosquitto") or shutil.which("mosquitto", path="/usr/sbin:/usr/local/sbin")
    if path is None:
        remedy = "apt install mosquitto"
        return Finding("broker", "missing", "none: only for players in several places", remedy)
    return Finding("broker", "good", path)


def _osc() -> Finding:
    """Look for the library of OSC; only instruments of others need it."""
    from cubeling.app.bridges.opening import OSC_REMEDY, check_osc

    try:
        check_osc()
    except AppError:
        return Finding("OSC", "missing", "none: only for --osc, --osc-in and --vmc", OSC_REMEDY)
    return Finding("OSC", "good", f"python-osc {importlib.metadata.version('python-osc')}")


def _lsl() -> Finding:
    """Look for Lab Streaming Layer, whose own library pylsl's wheel may lack."""
    from cubeling.app.bridges.opening import lsl_problem

    problem = lsl_problem()
    if problem is not None:
        return Finding("LSL", "missing", f"{problem[0]}: only for --lsl and --lsl-in", problem[1])
    import pylsl

    version = pylsl.library_version()
    return Finding("LSL", "good", f"liblsl {version // 100}.{version % 100}")


PHONE_LIBRARIES = ("aiohttp", "cryptography", "segno")
"""What pages in a browser need: the extra [web]."""

CHROMIUM, FIREFOX = ("chromium", "chromium-browser", "google-chrome"), ("firefox-esr", "firefox")
"""What programs of these browsers are called."""


def _phone() -> Finding:
    """Look for what pages need, and for a browser for their tests."""
    absent = [each for each in PHONE_LIBRARIES if importlib.util.find_spec(each) is None]
    if absent:
        found = f"no {', '.join(absent)}: for cubeling serve, --wizard and study run --page"
        return Finding("phone", "missing", found, f"pip install {' '.join(absent)}")
    browser = installed(*CHROMIUM, *FIREFOX)
    tests = "no browser here: tests of the page are left out" if browser is None else browser
    return Finding("phone", "good", f"cubeling serve, --wizard and study run --page work; {tests}")


def installed(*programs: str) -> str | None:
    """Return the path of the first of some programs that is there."""
    return next(filter(None, map(shutil.which, programs)), None)


def _camera() -> Finding:
    from cubeling.tracking import TrackingError, open_source

    try:
        with open_source("camera:0") as source:
            read_for(source, CAMERA_CHECK_S)
            return Finding("camera", "good", camera_report("camera:0", source))
    except TrackingError as error:
        return Finding("camera", "missing", str(error), "cubeling demo --recording")


def read_for(source: FrameSource, seconds: float) -> None:
    """Read frames until their timestamps have advanced by `seconds`."""
    start: float | None = None
    for frame in source:
        start = frame.timestamp if start is None else start
        if frame.timestamp - start >= seconds:
            return


def camera_report(uri: str, source: FrameSource) -> str:
    """Return what a camera delivers, and whether it accepted the settings."""
    from cubeling.app.running.summary.summary import camera_line
    from cubeling.tracking import LiveFrames

    size = f"{uri}, {source.size[0]}x{source.size[1]}"
    if not isinstance(source, LiveFrames):
        return size
    health = source.health
    settings = [f"{setting.name} {setting.detail}" for setting in health.settings]
    return "\n".join([f"{size}, {camera_line(health)}", *settings])
