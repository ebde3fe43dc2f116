"""Numbers of things, as messages say them."""

import pytest

from cubeling.app.counted import quantity


@pytest.mark.parametrize(
    ("number", "said"), [(0, "0 meshes"), (1, "1 mesh"), (2, "2 meshes"), (1200, "1,200 meshes")]
)
def test_a_number_is_said_with_its_noun(number, said):
    assert quantity(number, "mesh", "meshes") == said


def test_a_noun_without_a_plural_of_its_own_gets_an_s():
    assert quantity(12_199, "joint") == "12,199 joints"
