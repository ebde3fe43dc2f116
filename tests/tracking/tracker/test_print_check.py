"""Prints that differ from their file are named, after some looks, and right ones are not."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from cubeling.tracking import CubeModel, Frame
from cubeling.tracking.synthetic.folding import fold_cube
from cubeling.tracking.tracker.print_check import PrintCheck, PrintFault, cube_with, with_markers
from tests.examples import some
from tests.tracking.drawn import CAMERA, Picture, held, photograph, scene

CUBE = CubeModel.load("companion")
APRIL = replace(CUBE, dictionary="DICT_APRILTAG_36h11")
POSES = [
    held(x, y, z, (0.0, 0.0, 0.35))
    for x, y, z in ((0.5, 0.6, 0.1), (0.7, -0.6, 0.0), (-0.5, 0.7, -0.2), (0.6, 0.9, 0.3))
]
"""Each shows three faces, front among them."""


def seen(
    printed: CubeModel, change: Callable[[Picture], Picture] = lambda picture: picture
) -> PrintFault | None:
    """The fault that looks at a print find, with the file of `CUBE` or `APRIL`."""
    file = APRIL if printed.dictionary == APRIL.dictionary else CUBE
    check = PrintCheck(file, CAMERA)
    for number, pose in enumerate(POSES):
        picture = change(photograph(scene((printed, pose)), seed=number))
        check.look(Frame(np.ascontiguousarray(picture), float(number), number))
    return check.fault


def test_a_right_print_has_no_fault() -> None:
    assert seen(fold_cube(CUBE, 0.4, 1)) is None
    assert seen(APRIL) is None


@pytest.mark.parametrize(
    "fault",
    some(
        [
            PrintFault("rolled", ("front",), 270),
            PrintFault("swapped", ("front", "right")),
            PrintFault("swapped", ("front", "back")),
        ],
        2,
    ),
    ids=lambda fault: f"{fault.kind} {' '.join(fault.faces)}",
)
def test_a_marker_in_another_place_is_named(fault: PrintFault) -> None:
    found = seen(cube_with(CUBE, fault))
    assert found is not None
    assert (found.kind, set(found.faces), found.roll_deg) == (
        fault.kind,
        set(fault.faces),
        fault.roll_deg,
    )


def test_april_tags_of_opencv_4_are_named() -> None:
    turned = cube_with(APRIL, PrintFault("turned"))
    assert seen(turned) == PrintFault("turned")


def test_mirrored_and_inverted_prints_are_named() -> None:
    assert seen(CUBE, lambda picture: picture[:, ::-1]) == PrintFault("mirrored")
    assert seen(CUBE, lambda picture: 255 - picture) == PrintFault("inverted")


@pytest.mark.parametrize("share", some([1.1, 0.97, 0.9, 1.03], 2))
def test_markers_of_another_size_are_measured(share: float) -> None:
    found = seen(with_markers(CUBE, share))
    assert found is not None
    assert found.kind == "size"
    assert found.marker_mm == pytest.approx(1000 * CUBE.marker_size * share, abs=0.3)


def test_one_look_is_not_enough_and_a_right_look_speaks_against_a_fault() -> None:
    check = PrintCheck(CUBE, CAMERA)
    rolled = cube_with(CUBE, PrintFault("rolled", ("front",), 90))
    wrong, good = (photograph(scene((cube, POSES[0]))) for cube in (rolled, CUBE))
    faults = []
    for number, picture in enumerate((wrong, wrong, wrong, good)):
        check.look(Frame(picture, float(number), number))
        faults.append(check.fault)
    assert faults == [None, None, PrintFault("rolled", ("front",), 90), None]
