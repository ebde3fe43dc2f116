"""The campaign of growing documents detects what grows too fast, and what is refused at length."""

import math

import pytest

from tests.campaigns.growing_documents import Growing, everything
from tests.campaigns.growth import Cost, costs_of, exponent_of, perform, raised_limits, wrong

pytestmark = pytest.mark.full


@pytest.mark.parametrize("exponent", [1.0, 2.0])
def test_the_exponent_of_a_cost_is_found(exponent):
    costs = [Cost(size, 1e-4 * size**exponent, "") for size in (1000, 2000, 4000, 8000)]
    assert exponent_of(costs) == pytest.approx(exponent)
    assert wrong(costs[:1], exponent, 0.0) == ("" if exponent == 1.0 else "superlinear, slow")


def test_a_long_refusal_is_found():
    assert wrong([Cost(1, 0.0, "x" * 1000)], math.nan, 0.0) == "long refusal"
    assert wrong([Cost(1, 0.0, "two\nlines")], math.nan, 0.0) == "long refusal"


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
