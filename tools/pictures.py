"""Draws the pictures of the documents: `python -m tools.pictures`.

Every picture is a moment of a bundled recording, as the program shows it, or a page that it prints.
"""

import shutil
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import imgui_bundle as imgui_bundle  # isort: skip  # sets the path of the GLFW that it contains
import cv2
import glfw
import numpy as np
from rich.console import Console

from cubeling.app.behaving.opening import open_lines
from cubeling.app.behaving.player import BehaviourPlayer
from cubeling.app.behaving.recording import record_behaviour
from cubeling.app.commands.study.mood import plot
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.step import RobotView, Step
from cubeling.app.preferences import PreferenceStore
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.app.session.bundled import bundled_session
from cubeling.app.show.blocks import BehaviourOptions
from cubeling.app.ui.calibration.coach import ANIMATION_PERIOD_S, CoachView
from cubeling.app.ui.calibration.coach_lines import write_coverage
from cubeling.app.ui.calibration.session import Advice, CalibrationSession, Picture
from cubeling.app.ui.canvas import PICTURE_HEIGHT
from cubeling.app.ui.cards.layout import CardLayout
from cubeling.app.ui.cards.overlay import overlay, virtual_robot_side
from cubeling.app.ui.cards.virtual_robot import VirtualRobot
from cubeling.app.ui.panels import PANELS
from cubeling.app.ui.playback.corner_buttons import ROOM_BELOW
from cubeling.app.ui.playback.layer import PlaybackLayer
from cubeling.app.ui.playback.status import PlaybackMark, Position, SessionStatus
from cubeling.app.ui.window import Window
from cubeling.app.workshop.latency.pattern import draw_pattern
from cubeling.app.workshop.motion_graphs.timeline import save_timeline
from cubeling.app.workshop.motion_graphs.transition import find_transitions
from cubeling.characters import Character
from cubeling.characters.model.motion_library import library_of
from cubeling.characters.rendering import create_context
from cubeling.characters.rendering.portrait import PortraitRenderer
from cubeling.characters.synthesis.graphs.building import analyse
from cubeling.tracking import CubeModel, open_source, write_sheet
from cubeling.tracking.calibration import CubeFinder
from cubeling.tracking.synthetic import open_synthetic
from tools.gesture_sheets import draw_library, draw_settings
from tools.gesture_tour import draw_tour
from tools.offscreen import no_display_needed
from tools.study_pictures import draw_sheets, draw_stimuli, draw_times
from tools.talk_pictures import draw_play, draw_talk

FOLDER = Path(__file__).parent.parent / "docs" / "pictures"

MOMENTS_S: dict[str, dict[str, float]] = {
    "companion": {"kiss": 12.2, "window": 18.0, "shout": 27.3},
    "follow": {"walk": 6.2, "run": 12.6},
    "sketch": {"path": 22.6},
    "reach": {"stretch": 30.6, "give": 10.95},
}
"""For every recording, the pictures taken from it and their times [s]."""

CAST, CAST_MOMENTS_S = ("human", "vleo", "human", "vleo"), {"cast": 9.0}
"""Who stands beside Vleo in a picture of `companion`, and when it is taken [s]."""

TILES = Path(__file__).parent.parent / "app" / "ui" / "playback" / "scenario_pictures"
"""Where the window finds the pictures of the scenarios."""

TILE_MOMENTS_S = {"follow": 6.2, "sketch": 22.6, "companion": 12.2, "reach": 10.95}
"""When each of them is taken [s]."""

TILE_SIZE, TILE_SETTLING_S = (480, 270), 0.5
"""Width and height of them [px], and for how long light is measured before [s]."""


def draw(scenario: str, moments: dict[str, float], others: Sequence[str] = ()) -> None:
    """Play one recording, with others on the table, and save some of its pictures."""
    waiting = sorted((time, name) for name, time in moments.items())
    with ExitStack() as closing:
        source = closing.enter_context(open_source(str(bundled_session(scenario))))
        context = create_context()
        closing.callback(context.release)
        intrinsics = intrinsics_for(source.intrinsics, source.size)
        cast = [Character.load(name) for name in others]
        playground = Playground(scenario, intrinsics, others=cast, context=context)
        closing.callback(playground.close)
        virtual_robot = VirtualRobot(context, virtual_robot_side(source.size[1]))
        closing.callback(virtual_robot.close)
        layout, layer = CardLayout(ROOM_BELOW), PlaybackLayer((scenario,), Path(), {}, lambda: None)
        for frame in source:
            step = playground.step(frame)
            if not waiting or step.picture is None:
                break
            emotion = step.emotion
            view = RobotView("ready", emotion.emotion.valence, emotion.emotion.label)
            # Each time: the virtual robot is alive, and the cards move.
            picture = overlay(step.picture, step, view, virtual_robot, layout)
            if frame.timestamp < waiting[0][0]:
                continue
            _, name = waiting.pop(0)
            if name == "window":
                picture = in_window(picture, scenario, frame.timestamp, source.duration or 0.0)
            else:
                for card in layer.cards(source.size):  # the buttons in the corner
                    card.blend_over(picture)
            path = FOLDER / f"{scenario}-{name}.jpg"
            cv2.imwrite(str(path), picture, (cv2.IMWRITE_JPEG_QUALITY, 88))
            Console().print(f"{path.name}: {path.stat().st_size / 1e3:.0f} kB")


def draw_tile(scenario: str, moment: float) -> None:
    """Save a small picture of a scenario without cards, around character and cube."""
    with ExitStack() as closing:
        source = closing.enter_context(open_source(str(bundled_session(scenario))))
        context = create_context()
        closing.callback(context.release)
        intrinsics = intrinsics_for(source.intrinsics, source.size)
        playground = Playground(scenario, intrinsics, context=context)
        closing.callback(playground.close)
        steps = (
            playground.step(frame, drawn=frame.timestamp >= moment - TILE_SETTLING_S)
            for frame in source
        )
        step = next(each for each in steps if each.frame.timestamp >= moment)
    save_tile(scenario, step)


def save_tile(scenario: str, step: Step) -> None:
    """Save the part of a step's picture around character and cube."""
    assert step.picture is not None
    height, width = step.picture.shape[:2]
    left, top, right, bottom = np.array(step.subjects).T
    x, y = (left.min() + right.max()) / 2, (top.min() + bottom.max()) / 2
    wide = min(max(right.max() - left.min(), (bottom.max() - top.min()) * 16 / 9) * 1.1, width)
    high = wide * 9 / 16
    x0 = round(min(max(x - wide / 2, 0), width - wide))
    y0 = round(min(max(y - high / 2, 0), height - high))
    part = step.picture[y0 : y0 + round(high), x0 : x0 + round(wide)]
    path = TILES / f"{scenario}.jpg"
    small = cv2.resize(part, TILE_SIZE, interpolation=cv2.INTER_AREA)
    cv2.imwrite(str(path), small, (cv2.IMWRITE_JPEG_QUALITY, 88))
    Console().print(f"{path.name}: {path.stat().st_size / 1e3:.0f} kB")


def in_window(picture: Picture, scenario: str, now: float, length: float) -> Picture:
    """Return a picture of a replay as the window shows it, paused."""
    layer = PlaybackLayer((scenario,), Path(), {}, lambda: None)
    with SessionFile(bundled_session(scenario)) as session:
        marks = tuple(PlaybackMark(time, event) for time, event in session.events)
    position = Position(now, length, 0.0, length, marks=marks)
    layer.report(SessionStatus(scenario, paused=True, position=position))
    height, width = picture.shape[:2]
    strip = round(layer.strip_height * height / PICTURE_HEIGHT)
    shown = np.vstack([picture, np.zeros((strip, width, 3), np.uint8)])
    for card in layer.cards((width, height)):
        card.blend_over(shown)
    return shown


def draw_sheet(name: str) -> None:
    """Draw the printable sheet of a cube as a picture."""
    import pypdfium2  # a dependency of the tests only

    with tempfile.TemporaryDirectory() as folder:
        pdf = Path(folder) / "sheet.pdf"
        write_sheet(CubeModel.load(name), pdf)
        page = pypdfium2.PdfDocument(pdf)[0]
        page.render(scale=1.5).to_pil().save(FOLDER / f"sheet-{name}.png", optimize=True)


PANELS_TIME_S = 14.0
"""When the window with all panels is drawn [s]."""


def draw_panels() -> None:
    """Draw the window with its panels; that of sound would cover the character."""
    given = {"panels": tuple(name for name in PANELS if name != "sound"), "panels_shown": True}
    options = SessionOptions(scenario="companion", source=str(bundled_session("companion")))
    preferences = PreferenceStore(None, given)
    with no_display_needed(), open_session(options, preferences=preferences) as session:
        assert isinstance(session.screen, Window)
        window, session.pace = session.screen, None  # every frame

        def save(step: Step) -> None:
            if step.frame.timestamp >= PANELS_TIME_S and not window.closed:
                picture = window.pixels()
                quality = (cv2.IMWRITE_JPEG_QUALITY, 88)
                cv2.imwrite(str(FOLDER / "panels.jpg"), picture, quality)
                glfw.set_window_should_close(glfw.get_current_context(), True)

        run(session, save)


COACH_PICTURES = {"tip": "tilt up", "near": "near"}
"""Names of the coach's pictures, and the request that each shows."""

SHOWN_FOR_S = (0.6, 1.2)
"""Time since the request began [s]: in the middle of the animation."""

MAX_CUBE_BOTTOM = 0.74
"""Bottom of the cube as a share of the picture's height, so that no card covers it."""


class _PictureCoach:
    """Saves some pictures of a calibration session."""

    closed = False

    def __init__(self) -> None:
        self._coach = CoachView("cube")
        self._waiting = {request: name for name, request in COACH_PICTURES.items()}
        self._since = ("", 0.0)

    def show_advice(self, picture: Picture, timestamp: float, advice: Advice) -> None:
        """Draw the coach, and save the picture at the right time."""
        shown = self._coach.draw(picture, timestamp, advice)
        if advice.request != self._since[0]:
            self._since = advice.request, timestamp
        held = SHOWN_FOR_S[0] <= (timestamp - self._since[1]) % ANIMATION_PERIOD_S <= SHOWN_FOR_S[1]
        lowest = max((outline[:, 1].max() for outline in advice.outlines), default=np.inf)
        seen = lowest < MAX_CUBE_BOTTOM * picture.shape[0]
        if advice.request in self._waiting and held and seen:
            path = FOLDER / f"calibrate-{self._waiting.pop(advice.request)}.jpg"
            cv2.imwrite(str(path), shown, (cv2.IMWRITE_JPEG_QUALITY, 88))


def draw_calibration() -> None:
    """Calibrate a synthetic camera with a synthetic cube, and save what the coach shows."""
    source = open_synthetic("wave?fold=0.8&seed=1&rate=15")
    session = CalibrationSession([CubeFinder(CubeModel.load("locomotion"))], source.size)
    session.run(source, _PictureCoach(), 60.0)
    write_coverage(FOLDER / "calibrate-coverage.jpg", session)


def draw_pattern_of_latency() -> None:
    """Save what `cubeling latency` shows while it measures."""
    pattern = draw_pattern(True, "Hold it still", "", 0.4)
    small = cv2.resize(pattern, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    cv2.imwrite(str(FOLDER / "latency.png"), small)


UNPLUGGED_ROBOT = "sim:cubeling?unplug=12s/1s&seed=3"
"""A simulated robot that is unplugged twice during the session of the mood plot."""


def draw_moods() -> None:
    """Plot a session with three personalities, and one whose robot was unplugged."""
    compared = FOLDER / "mood-personalities.svg"
    plot(bundled_session("companion"), compared, True, ["thesis", "shy", "grumpy"])
    with tempfile.TemporaryDirectory() as folder:
        session = Path(folder) / "today.mcap"
        options = SessionOptions(
            scenario="companion",
            source=str(bundled_session("companion")),
            personality="lively",
            robot=UNPLUGGED_ROBOT,
            record=session,
            pictures=False,
        )
        with open_session(options) as opened:
            run(opened)
        plot(session, FOLDER / "mood-robot.svg", True)


TRANSITION_CLIPS = ("WalkLeftWide", "Run")
"""The clips between which docs/motion-graphs.md shows a transition."""

TRANSITION_TIME_S = 0.13
"""When the second is asked for [s]: both searches of the parts find a way."""


def draw_transition() -> None:
    """Plot which clip each part of the body plays between two clips of the bundled human."""
    human = Character.load("human")
    stored = analyse(library_of([*human.clips.values()], human))
    found = find_transitions(stored, *TRANSITION_CLIPS, TRANSITION_TIME_S, as_printed=True)
    title = " → ".join(TRANSITION_CLIPS)
    save_timeline(FOLDER / "transition.svg", stored.library, found, title)


BEHAVIOUR_TIMES_S = (0.4, 0.8, 1.6, 2.0, 2.8, 3.6, 4.0, 4.4)
"""When the block of BML in docs/behaviour.md is shown [s]."""

BEHAVIOUR_CELL_PX = 180, 230
"""Size of each of these pictures [px]."""


def draw_behaviour() -> None:
    """Let two characters perform the block of BML in docs/behaviour.md."""
    page = (FOLDER.parent / "behaviour.md").read_text("utf-8")
    block = page.split("```xml\n")[1].split("```")[0]
    rows = []
    with ExitStack() as closing:
        context = create_context()
        closing.callback(context.release)
        renderer = PortraitRenderer(context, BEHAVIOUR_CELL_PX)
        closing.callback(renderer.release)
        for name in ("human", "vleo"):
            body = Character.load(name)
            lines = open_lines(None, "en")
            closing.callback(lines.close)
            clip = record_behaviour(
                BehaviourPlayer(body, lines, BehaviourOptions()), [block], 25.0
            ).clip
            focus = np.array([0.0, 0.5 * body.height, 0.0]), 0.62 * body.height
            poses = [clip.poses[round(time * clip.rate)] for time in BEHAVIOUR_TIMES_S]
            shown = [renderer.portrait(body, pose, azimuth=0.3, focus=focus) for pose in poses]
            rows.append(np.hstack(shown))
    quality = (cv2.IMWRITE_JPEG_QUALITY, 88)
    cv2.imwrite(str(FOLDER / "behave.jpg"), np.vstack(rows), quality)


EDITOR_STEP = 6
"""The step of the tour through the gesture editor that is shown."""


def draw_gestures() -> None:
    """Draw the library of gestures, and one of them in five settings."""
    draw_library(FOLDER / "gestures.jpg")
    draw_settings(FOLDER / "gesture-settings.jpg")


def draw_gesture_editor() -> None:
    """Draw the editor in the middle of its tour."""
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as own:
        shown = draw_tour(Path(folder), Path(own))[EDITOR_STEP - 1]
        shutil.copyfile(shown, FOLDER / "gesture-editor.png")


if __name__ == "__main__":
    FOLDER.mkdir(parents=True, exist_ok=True)
    for recording, pictures in MOMENTS_S.items():
        draw(recording, pictures)
    draw("companion", CAST_MOMENTS_S, CAST)
    draw_sheet("companion")
    draw_panels()
    draw_calibration()
    draw_pattern_of_latency()
    draw_moods()
    draw_times(FOLDER)
    draw_stimuli(FOLDER)
    draw_sheets(FOLDER)
    draw_transition()
    draw_gestures()
    draw_gesture_editor()
    draw_behaviour()
    save_tile("talk", draw_talk(FOLDER))
    draw_play(FOLDER)
