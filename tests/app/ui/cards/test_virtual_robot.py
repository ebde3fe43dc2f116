"""Without a real robot, the virtual robot feels what the robot is asked to feel."""

import itertools
from collections.abc import Iterator
from dataclasses import replace

import moderngl
import numpy as np
import pytest

from cubeling.affect import Emotion
from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.app.pipeline.step import RobotView
from cubeling.app.running.robots import RobotLine
from cubeling.app.ui.cards.overlay import overlay, virtual_robot_side
from cubeling.app.ui.cards.virtual_robot import VirtualRobot, backdrop, intensity
from cubeling.app.ui.display import is_software_renderer
from cubeling.app.ui.palette import ANGRY, HAPPY
from cubeling.characters import CharacterError
from cubeling.characters.rendering import create_context

SIDE = 96


@pytest.fixture(scope="module")
def context() -> Iterator[moderngl.Context]:
    try:
        made = create_context()
    except CharacterError as missing:
        pytest.skip(str(missing))
    yield made
    made.release()


def felt(valence: float, label: str, time: float) -> EmotionTarget:
    return EmotionTarget(Emotion(valence, abs(valence), label), time)


def played(context: moderngl.Context, moods: list[tuple[float, str]]) -> list[np.ndarray]:
    """Return the pictures of moods that follow each other ten times a second."""
    virtual_robot = VirtualRobot(context, SIDE)
    pictures = [
        virtual_robot.portrait(felt(*mood, number / 5)).copy() for number, mood in enumerate(moods)
    ]
    virtual_robot.close()
    return pictures


def lit(picture: np.ndarray, color: tuple[int, int, int], by: int) -> int:
    """Return how many pixels have more of a colour's (BGR) strongest part than of the others."""
    strongest = int(np.argmax(color))
    others = np.delete(picture.astype(int), strongest, axis=2).max(axis=2)
    return int((picture[:, :, strongest] - others > by).sum())


@pytest.mark.slow(reason="portraits are drawn twice")
def test_the_same_session_gives_the_same_pictures(context):
    moods = [(0.0, "neutral"), (0.5, "happy"), (0.9, "happy"), (-0.6, "angry")] * 2
    for one, other in zip(played(context, moods), played(context, moods), strict=True):
        np.testing.assert_array_equal(one, other)


def test_it_never_stands_still_and_stays_in_the_picture(context):
    for mood in ((0.3, "neutral"), (1.0, "happy"), (-1.0, "angry")):
        pictures = played(context, [mood] * 5)
        assert all((a != b).any() for a, b in itertools.pairwise(pictures))
        empty = backdrop(SIDE, mood[0])
        for picture in pictures:  # its shadow falls to the right
            np.testing.assert_allclose(picture[0].astype(int), empty[0], atol=2)
            np.testing.assert_allclose(picture[:, 0].astype(int), empty[:, 0], atol=2)


@pytest.mark.parametrize("strength", [0.36, 0.67, 1.0])
def test_its_lamps_tell_the_mood_at_every_intensity(context, strength):
    happy = played(context, [(strength, "happy")] * 8)[-1]
    angry = played(context, [(-strength, "angry")] * 8)[-1]
    assert lit(happy, HAPPY, 60) > 12 > 4 * lit(angry, HAPPY, 60)
    assert lit(angry, ANGRY, 120) > 12 > 4 * lit(happy, ANGRY, 120)


def test_where_the_processor_draws_only_some_frames_bring_a_new_picture(context):
    virtual_robot = VirtualRobot(context, SIDE)
    words = ["happy"] * 8 + ["neutral"] * 4
    pictures = [
        virtual_robot.portrait(felt(0.9, word, 5.0 + n / 30)) for n, word in enumerate(words)
    ]
    virtual_robot.close()
    fresh = [n for n in range(1, 12) if pictures[n] is not pictures[n - 1]]
    software = is_software_renderer(context.info["GL_RENDERER"])
    assert fresh == ([5, 8] if software else list(range(1, 12)))


def test_a_session_that_starts_over_in_time_is_followed(context):
    virtual_robot = VirtualRobot(context, SIDE)
    late, early = (virtual_robot.portrait(felt(0.0, "neutral", time)) for time in (9.0, 0.0))
    virtual_robot.close()
    assert late is not early


def test_intensity_rises_with_the_mood_and_never_leaves_its_range():
    for sign, label in ((1, "happy"), (-1, "angry"), (1, "neutral")):
        values = [intensity(felt(sign * v, label, 0.0).emotion) for v in np.linspace(0, 1, 21)]
        assert values == sorted(values)
        assert (values[0], values[-1]) == (-1.0, 1.0)


def test_it_takes_the_place_of_a_robot_that_is_not_real(context, a_step):
    step = a_step(None)
    image = np.full((720, 1280, 3), 90, np.uint8)
    virtual_robot = VirtualRobot(context, virtual_robot_side(720))
    real = overlay(image.copy(), step, RobotView("ready", 0.5, "happy", real=True), virtual_robot)
    face = overlay(image.copy(), step, RobotView("ready", 0.5, "happy"))
    np.testing.assert_array_equal(real, face)
    for link in ("none", "ready", "lost"):
        shown = overlay(image.copy(), step, RobotView(link, 0.5, "happy"), virtual_robot)
        assert (shown[410:580, 1070:1246] != face[410:580, 1070:1246]).all(axis=2).mean() > 0.9
    virtual_robot.close()
    virtual_robot.close()


@pytest.mark.parametrize("height", [240, 480, 1080])
def test_its_card_fits_pictures_of_every_size(context, a_step, height):
    step = replace(a_step(None), subjects=())
    image = np.full((height, height * 16 // 9, 3), 90, np.uint8)
    virtual_robot = VirtualRobot(context, virtual_robot_side(height))
    shown = overlay(image.copy(), step, RobotView("none", -0.5, "angry"), virtual_robot)
    virtual_robot.close()
    rim = np.ones(image.shape[:2], bool)
    rim[2:-2, 2:-2] = False
    assert (shown[rim] == 90).all()
    assert (shown[height // 2 :, image.shape[1] // 2 :] != 90).any()


def test_a_robot_that_is_simulated_or_absent_is_not_real():
    for url in ("none", "sim:cubeling"):
        with RobotLine.open(url, lambda: 0.0) as line:
            assert not line.view().real
