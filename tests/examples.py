"""How many examples Hypothesis draws: some in `make test`, all of them in `make test-all`."""

from collections.abc import Iterable
from typing import Any

import pytest
from hypothesis import settings

QUICK_SHARE, MIN_EXAMPLES = 0.2, 5
"""The part that `make test` draws, and the least of a test."""

FULL_EXAMPLES = 100
"""Examples of a test that says nothing else."""


def examples(full: int) -> int:
    """Return how many of so many examples are drawn now: `@settings(max_examples=examples(40))`."""
    return full if settings.get_current_profile_name() == "full" else quick(full)


def quick(full: int) -> int:
    """Return how many of so many examples `make test` draws."""
    return min(full, max(MIN_EXAMPLES, round(QUICK_SHARE * full)))


def register_profiles() -> None:
    """Make the profiles known, with the same examples everywhere, however busy the machine is."""
    settings.register_profile("full", derandomize=True, deadline=None, max_examples=FULL_EXAMPLES)
    few = quick(FULL_EXAMPLES)
    settings.register_profile("quick", settings.get_profile("full"), max_examples=few)


def some(values: Iterable[Any], quick: int = 1) -> list[Any]:
    """Return values that repeat one claim, of which `make test` tries the first.

    The others are examples like those that Hypothesis draws: `@parametrize("seed", some(SEEDS))`.
    A tuple has a value for each of several names.
    """
    given = [value if isinstance(value, tuple) else (value,) for value in values]
    others = [pytest.param(*value, marks=pytest.mark.full) for value in given[quick:]]
    return [pytest.param(*value) for value in given[:quick]] + others
