"""A marker that is turned is smeared as the one that stands, across instead of along."""

import numpy as np
import pytest

from cubeling.tracking.cube.marker import marker_cells
from cubeling.tracking.detection import smeared_patterns
from tests.examples import some


@pytest.mark.parametrize("turn", some([1, 2, 3]))
def test_a_turned_pattern_is_that_of_the_turned_marker(turn: int) -> None:
    cells, count = marker_cells("DICT_4X4_50", 7), 14
    turned = smeared_patterns._turn(smeared_patterns._smear(cells, count), turn, count)
    drawn = smeared_patterns._smear(np.rot90(cells, turn), count)
    np.testing.assert_allclose(turned, drawn, atol=1e-5)
