"""A share of the campaign of generated BML blocks."""

import pytest

from tests.campaigns.behaviour import run

pytestmark = pytest.mark.full


def test_generated_blocks_lose_nothing_and_report_in_time():
    counts, failures = run(300, seed=4)
    assert not failures
    assert counts["performed"] > 300
    assert counts["links checked"] > 10
