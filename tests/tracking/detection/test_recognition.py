"""Cubes are told apart by their markers."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.tracking import CubeModel, CubeRecognizer, bundled_cubes
from tests.tracking.drawn import held, photograph, scene

CUBES = tuple(CubeModel.load(name) for name in bundled_cubes())


@pytest.mark.parametrize("cube", CUBES, ids=lambda cube: cube.name)
def test_each_bundled_cube_is_recognized(cube):
    found = CubeRecognizer(CUBES).recognize(photograph(scene((cube, held()))))
    assert found is cube


def test_no_cube_is_seen_in_noise():
    noise = np.random.default_rng(1).integers(0, 255, (480, 640, 3), np.uint8)
    assert CubeRecognizer(CUBES).recognize(noise) is None


def test_cubes_with_the_same_markers_cannot_be_told_apart():
    twins = (CUBES[0], replace(CUBES[0], name="twin"))
    picture = photograph(scene((CUBES[0], held())))
    assert CubeRecognizer(twins).recognize(picture) is None
