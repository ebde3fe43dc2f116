"""The nearest of many rows, found by boxes, is that of all rows."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters.synthesis.matching.nearest import NearestRow
from tests.examples import examples


@settings(max_examples=examples(25), deadline=None)
@given(st.integers(1, 400), st.integers(1, 27), st.integers(0, 2**32 - 1))
def test_the_nearest_row_is_that_of_all_rows(count, columns, seed):
    rng = np.random.default_rng(seed)
    rows = rng.standard_normal((count, columns)) * rng.uniform(0.01, 3.0, columns)
    nearest = NearestRow(rows)
    for query in rng.standard_normal((5, columns)):
        apart = np.square(rows - query).sum(1)
        found = nearest.find(query)
        assert found is not None
        assert apart[found[0]] == pytest.approx(apart.min(), rel=1e-4)
        assert found[1] == pytest.approx(apart.min(), rel=1e-3, abs=1e-5)


def test_equal_rows_are_no_obstacle():
    found = NearestRow(np.ones((100, 4))).find(np.zeros(4))
    assert found is not None
    assert found[1] == pytest.approx(4.0)


def test_no_row_is_found_beyond_the_bound():
    rows = np.random.default_rng(0).standard_normal((200, 5))
    nearest = NearestRow(rows)
    least = float(np.square(rows).sum(1).min())
    assert nearest.find(np.zeros(5), 0.9 * least) is None
    assert nearest.find(np.zeros(5), 1.1 * least) is not None
