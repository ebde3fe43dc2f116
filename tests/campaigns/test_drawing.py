"""The campaign of drawing sees an object that is not released."""

import pytest

from cubeling.characters.rendering import create_context
from tests.campaigns.drawing import Held, grown, held

pytestmark = pytest.mark.full


def test_an_object_that_is_kept_is_counted():
    context = create_context()
    before = held(context, 0)
    kept = context.texture((1, 1), 4)
    assert held(context, 0).counts[0] == before.counts[0] + 1
    kept.release()
    assert held(context, 0).counts == before.counts
    context.release()


@pytest.mark.parametrize(
    ("counts", "memory", "wrong"),
    [
        ((3, 4), (0.41e9, 0.9e9), False),
        ((4, 4), (0.41e9, 0.41e9), True),
        ((3, 4), (0.43e9, 0.7e9), True),
    ],
    ids=["a peak", "an object", "a leak"],
)
def test_growth_is_reported(counts, memory, wrong):
    early = [Held(1, int(0.4e9), (3, 4)), Held(5, int(0.8e9), (3, 4))]
    late = [Held(7, int(memory[0]), (3, 4)), Held(9, int(memory[1]), counts)]
    assert grown([*early, *late]) is wrong
