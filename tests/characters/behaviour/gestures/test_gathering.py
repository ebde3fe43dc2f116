"""Key frames of the whole body, complete or lazy (Huang 2013, section 8.5)."""

import numpy as np
import pytest

from cubeling.characters.behaviour.gestures.gathering import PartKeys, gather


def _keys(**parts):
    return {
        name: PartKeys(np.array(list(keys), float), np.array(list(keys.values()), float)[:, None])
        for name, keys in parts.items()
    }


PARTS = _keys(hand={0.0: 0.0, 1.0: 10.0}, torso={0.0: 5.0, 0.5: 7.0, 1.0: 5.0}, head={0.25: 1.0})


@pytest.mark.parametrize("fill", ["complex", "lazy"])
def test_times_are_the_sorted_union(fill):
    assert [frame.time for frame in gather(PARTS, fill)] == [0.0, 0.25, 0.5, 1.0]


def test_a_complex_fill_interpolates_every_part():
    frames = gather(PARTS, "complex")
    assert all(set(frame.parts) == {"hand", "torso", "head"} for frame in frames)
    assert frames[2].parts["hand"] == pytest.approx([5.0])
    assert frames[1].parts["torso"] == pytest.approx([6.0])


def test_a_lazy_fill_leaves_out_what_is_not_important():
    frames = gather(PARTS, "lazy", important=["hand"])
    assert "head" not in frames[0].parts
    assert "torso" not in frames[1].parts
    assert "hand" in frames[1].parts


def test_a_lazy_fill_repeats_the_previous_key_or_interpolates():
    previous = gather(PARTS, "lazy", ["hand"])[2].parts["hand"]
    between = gather(PARTS, "lazy", ["hand"], "between")[2].parts["hand"]
    assert previous == pytest.approx([0.0])
    assert between == pytest.approx([5.0])


def test_both_agree_where_all_parts_have_a_key():
    parts = _keys(hand={0.0: 1.0, 0.5: 3.0}, torso={0.0: 2.0, 1.0: 4.0})
    complex_fill, lazy_fill = gather(parts, "complex")[0], gather(parts, "lazy")[0]
    for part, value in complex_fill.parts.items():
        assert lazy_fill.parts[part] == pytest.approx(value)


def test_a_lazy_fill_fills_less():
    def filled(frames):
        return sum(len(frame.filled) for frame in frames)

    assert filled(gather(PARTS, "lazy", ["hand"])) < filled(gather(PARTS, "complex"))
