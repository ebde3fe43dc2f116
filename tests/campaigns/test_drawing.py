"""The campaign of drawing sees an object that is not released."""

import pytest

from characters.rendering import create_context
from tests.campaigns.drawing import Held, grown, held


def test_an_object_that_is_kept_is_counted():
    context = create_context()
    before = held(context, 0)
    kept = context.texture((1, 1), 4)
    assert held(context, 0).counts[0] == before.counts[0] + 1
    kept.release()
    assert held(context, 0).counts == before.counts
    context.release()


@pytest.mark.parametrize(
    ("last", "wrong"),
    [(Held(9, 500, (3, 4)), False), (Held(9, 500, (4, 4)), True), (Held(9, 10**9, (3, 4)), True)],
)
def test_growth_is_reported(last, wrong):
    assert grown([Held(1, 400, (3, 4)), Held(5, 600, (3, 4)), Held(7, 500, (3, 4)), last]) is wrong
