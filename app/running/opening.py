"""From what a person asks for to the parts of a session."""

from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import moderngl

from app.errors import AppError
from app.pipeline.playground import Playground
from app.running.runner import PATIENCE_S, Plan
from app.scenarios import make_scenario, scenario_cube
from app.session import cues
from app.session.replay_inputs import recorded_arrows
from app.ui.overlay import virtual_robot_side
from app.ui.screen import NullScreen, Screen, VideoFile
from app.ui.virtual_robot import VirtualRobot
from characters import Character
from characters.rendering import create_context
from tracking import CubeModel, FrameSource, Intrinsics, open_source

ALONE_S = 3.0
"""Without a window nobody is told to plug a camera in: only a network's short stalls are borne."""


@dataclass(frozen=True)
class Wish:
    """What a person asks for."""

    scenario: str
    """Name of the scenario."""

    source: str
    """Where the frames come from, as `tracking.open_source` takes it."""

    cube: str | None = None
    """A bundled cube or a .toml file; None for the scenario's own."""

    character: str | None = None
    """A bundled character or a .glb file; None for the scenario's own."""

    intrinsics: Path | None = None
    """The camera's calibration, or None to take the source's own or guess."""

    speed_map: str = "corrected"
    """Which Speed map `follow` and `sketch` use."""

    turns: float = 2.0
    """Full turns from the least to the greatest intensity in `companion`."""

    personality: str | None = None
    """Who feels: a bundled personality or a .toml file; None for the scenario's own."""

    look: str = "auto"
    """What the character's eyes follow: one of `LOOKS`."""

    robot: str = "sim"
    """Who feels: see `RobotLine.open`."""

    record: Path | None = None
    """Where to record the session."""

    codec: str = "jpeg"
    """How a recording keeps the pictures."""

    output: Path | None = None
    """A video to write; None to open a window."""

    pictures: bool = True
    """Whether to draw at all."""

    salvage: bool = False
    """Whether a source that breaks off is simply at its end."""

    robot_settings: Path | None = None
    """Which motion stands for which mood …, for robots that need to be told."""

    start: str = "camera"
    """From which arrow on a session is replayed: one of `STARTS`."""


def open_session(wish: Wish, closing: ExitStack, source: FrameSource | None = None) -> Plan:
    """Open all that a session needs; `closing` closes it.

    The cheap and certain things are checked first, so that a wrong name costs no camera.

    Raises
    ------
    TrackingError, CharacterError, RobotError, AppError
        Something that was asked for is not there or not usable.
    """
    cube = CubeModel.load(wish.cube or scenario_cube(wish.scenario))
    scenario = make_scenario(
        wish.scenario,
        cube,
        speed_map=wish.speed_map,
        turns=wish.turns,
        personality=wish.personality,
    )
    character = Character.load(wish.character or scenario.character)
    calibration = None if wish.intrinsics is None else Intrinsics.load(wish.intrinsics)
    refuse_overwriting(wish)
    if source is None:
        source = closing.enter_context(open_source(wish.source))
    intrinsics = fitting(calibration or source.intrinsics, source.size)
    screen, context = open_screen(wish, source, closing)
    playground = Playground(
        scenario, intrinsics, cube=cube, character=character, context=context, look=wish.look
    )
    closing.callback(playground.close)
    return Plan(
        source,
        playground,
        screen,
        robot=wish.robot,
        robot_settings=wish.robot_settings,
        record=wish.record,
        codec=wish.codec,
        about=describe(wish, cube, source),
        paced=wish.output is None and wish.pictures,
        salvage=wish.salvage,
        cues=cues(Path(wish.source)) if wish.source.endswith(".mcap") else frozenset(),
        given=None if wish.start == "camera" else recorded_arrows(wish.source, wish.start),
        patience=PATIENCE_S if wish.output is None and wish.pictures else ALONE_S,
    )


def open_screen(
    wish: Wish, source: FrameSource, closing: ExitStack
) -> tuple[Screen, moderngl.Context | None]:
    """Open the window or the video file, and the context to draw in."""
    if not wish.pictures:
        return NullScreen(), None
    if wish.output is not None:
        context = create_context()
        closing.callback(context.release)
        virtual_robot = VirtualRobot(context, virtual_robot_side(source.size[1]))
        closing.callback(virtual_robot.close)
        video = VideoFile(wish.output, source.size, source.rate, virtual_robot)
        return closing.enter_context(video), context
    from app.ui.window import Window  # needs a display's libraries, which a server lacks

    window = closing.enter_context(Window(source.size, f"Cubeling: {wish.scenario}"))
    return window, window.context


def fitting(intrinsics: Intrinsics | None, size: tuple[int, int]) -> Intrinsics:
    """Return intrinsics for pictures of `size`, guessed where none are known."""
    if intrinsics is None:
        return Intrinsics.guess(size)
    if intrinsics.size == size:
        return intrinsics
    if abs(intrinsics.size[1] * size[0] / intrinsics.size[0] - size[1]) > 1.0:
        raise AppError(
            f"the calibration is for {intrinsics.size[0]}x{intrinsics.size[1]} pictures, "
            f"the camera gives {size[0]}x{size[1]}: calibrate it at this size"
        )
    return intrinsics.scaled(size)


def guessed(wish: Wish, source: FrameSource) -> bool:
    """Whether nothing is known of the camera's lens."""
    return wish.intrinsics is None and source.intrinsics is None


def describe(wish: Wish, cube: CubeModel, source: FrameSource) -> dict[str, str]:
    """Return what a recording says of itself."""
    return {
        "scenario": wish.scenario,
        "cube": wish.cube or cube.name,
        "character": wish.character or "",
        "speed_map": wish.speed_map,
        "turns": f"{wish.turns:g}",
        "personality": wish.personality or "",
        "look": wish.look,
        "source": wish.source.split("://")[0] if "://" in wish.source else Path(wish.source).name,
        "rate": f"{source.rate:g}",
    }


def refuse_overwriting(wish: Wish) -> None:
    """Refuse to record over a file that exists, or to where nothing can be written."""
    for path, what in ((wish.record, "recording"), (wish.output, "video")):
        if path is None:
            continue
        if not path.parent.is_dir():
            raise AppError(f"there is no folder '{path.parent}' for the {what} '{path.name}'")
        if what == "recording" and path.exists():
            raise AppError(f"the {what} '{path}' exists already: choose another name or remove it")
