"""The player is told in what a print differs from its file, and AprilTags of OpenCV 4 are read."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.app.pipeline.cubes.print_watch import SHOWN_S, PrintWatch, fault_advice
from cubeling.app.pipeline.playground import Playground
from cubeling.tracking import CubeModel, CubeState, Frame, PrintFault, cube_with
from tests.tracking.drawn import CAMERA, held, photograph, scene

CUBE = CubeModel.load("companion")
APRIL = replace(CUBE, dictionary="DICT_APRILTAG_36h11", name="april")
POSE = held(0.5, 0.6, 0.1, (0.0, 0.0, 0.35))


@pytest.mark.slow(reason="the whole picture is searched for a cube that is not as it should be")
def test_april_tags_of_opencv_4_are_read_and_named() -> None:
    printed = cube_with(APRIL, PrintFault("turned"))
    playground = Playground("companion", CAMERA, cube=APRIL)
    steps = []
    for index in range(6):
        x = 0.5 + 0.04 * index
        picture = photograph(scene((printed, held(x, 0.6, 0.1, (0.0, 0.0, 0.35)))), seed=index)
        steps.append(playground.step(Frame(picture, float(index), index)))
    assert not steps[0].state.visible
    assert steps[-1].state.visible
    assert {"OpenCV 4" in step.outcome.hint for step in steps[-2:]} == {True}
    playground.close()


@pytest.mark.slow(reason="the whole picture is searched for a cube that is not as it should be")
def test_a_fault_of_a_cube_that_is_tracked_is_named_for_a_while() -> None:
    fault = PrintFault("rolled", ("front",), 90)
    printed = cube_with(CUBE, fault)
    watch, picture = PrintWatch(CUBE, CAMERA), photograph(scene((printed, POSE)))
    told = []
    begins = 3.0  # after three looks
    times = [0.0, 1.0, 2.0, begins, 4.0, begins + SHOWN_S - 0.1, begins + SHOWN_S]
    for index, now in enumerate(times):
        pose, still = np.asarray(POSE), np.zeros(6)
        state = CubeState(True, pose, still, np.eye(6), "markers", ("top", "right"), 0.1, now)
        told.append(watch.update(Frame(picture, now, index), state))
    assert told == [None] * 3 + [fault] * 3 + [None]
    assert "front" in fault_advice(fault, CUBE)
    assert watch.printed is CUBE
