"""The sheet of a cube, flat as it comes from the printer, is no cube, and costs little."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from cubeling.tracking import CubeModel, CubeTracker, Frame, Intrinsics, open_source
from tests.tracking.showing import show_until_decided

CASES = Path(__file__).parents[3] / "shared" / "data" / "cases" / "cubes"
FOCAL_PX = 532.6
"""Of the camera that took the crosses [px]."""

needs_cases = pytest.mark.skipif(not CASES.exists(), reason="the cases are not on this machine")


@needs_cases
@pytest.mark.parametrize("name", ["sheet-ghost-first-frame", "sheet-ghost-6", "sheet-slow"])
def test_a_flat_cross_is_no_cube(name: str) -> None:
    picture = np.asarray(cv2.imread(str(CASES / f"{name}.png")), np.uint8)
    size = (picture.shape[1], picture.shape[0])
    middle = (np.array(size) - 1) / 2
    matrix = np.array([[FOCAL_PX, 0, middle[0]], [0, FOCAL_PX, middle[1]], [0, 0, 1]])
    camera = Intrinsics(matrix, np.zeros(5), size)
    state, calls = show_until_decided(
        CubeTracker(CubeModel.load(CASES / "plain.toml"), camera), picture
    )
    assert state.verdict == "flat"
    assert len(calls) == 1


@needs_cases
def test_the_sheet_that_we_print_is_no_cube_in_any_frame() -> None:
    with open_source(str(CASES / "own-sheet.mp4")) as source:
        tracker = CubeTracker(CubeModel.load("companion"), Intrinsics.guess(source.size))
        verdicts = {tracker.update(frame).verdict for frame in source}
    assert verdicts == {"flat"}
    picture = np.asarray(cv2.imread(str(CASES / "own-sheet-8.jpg")), np.uint8)
    camera = Intrinsics.guess((picture.shape[1], picture.shape[0]))
    tracker = CubeTracker(CubeModel.load("companion"), camera)
    assert tracker.update(Frame(picture, 0.0, 0)).verdict == "flat"
