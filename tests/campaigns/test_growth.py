"""The campaign of growing documents detects what grows too fast, and what is refused at length."""

import pytest

from tests.campaigns.growing_documents import Growing, everything
from tests.campaigns.growth import (
    Cost,
    Growth,
    costs_of,
    growth_of,
    perform,
    raised_limits,
    wrong,
)

pytestmark = pytest.mark.full


@pytest.mark.parametrize(
    ("exponent", "said"),
    [(1.0, ""), (1.2, "slow"), (1.6, "superlinear, slow"), (2.0, "superlinear, slow")],
)
def test_how_a_cost_grows_is_found(exponent, said):
    costs = [Cost(size, 1e-4 * size**exponent, "") for size in (2000, 4000, 8000)]
    growth = growth_of(costs)
    assert growth.exponent == pytest.approx(exponent)
    assert growth.span == 4.0
    assert wrong(costs[2:], growth, 0.0) == said


def test_a_cache_that_is_left_over_three_sizes_is_no_growth():
    assert not Growth(1.44, 4.0).is_superlinear
    assert Growth(1.44, 8.0).is_superlinear


def test_a_long_refusal_is_found():
    growth = growth_of([])
    assert wrong([Cost(1, 0.0, "x" * 1000)], growth, 0.0) == "long refusal"
    assert wrong([Cost(1, 0.0, "two\nlines")], growth, 0.0) == "long refusal"


def test_limits_are_raised_for_a_while():
    heads = next(each for each in everything() if each.name == "behaviours")
    assert perform(heads.make(300))
    with raised_limits(8):
        assert not perform(heads.make(300))
    assert perform(heads.make(300))


def test_sizes_double():
    growing = Growing("any", lambda n: "x" * n, 1000)
    sizes: list[int] = []
    costs_of(growing, lambda text: sizes.append(len(text)) or "", 3)  # type: ignore[func-returns-value]
    assert sizes == [250, 500, 1000]
