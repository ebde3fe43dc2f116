"""The campaign of the tracker draws the same again, and sees what is raised."""

import numpy as np

from cubeling.tracking import CubeTracker
from tests.campaigns.tracker import FRAMES_PER_CLIP, clip, run, show


def test_a_clip_is_the_same_again_and_differs_from_others() -> None:
    first, again, other = clip(3, 5), clip(3, 5), clip(3, 6)
    for one, same in zip(first.frames, again.frames, strict=True):
        assert np.array_equal(one.image, same.image)
    assert not np.array_equal(first.frames[0].image, other.frames[0].image)


def test_what_the_tracker_raises_is_counted_with_its_clip(monkeypatch) -> None:
    def fail(self, frame, markers=None):
        raise KeyError("top")

    assert sum(show(1, 0)[0].values()) == FRAMES_PER_CLIP
    monkeypatch.setattr(CubeTracker, "update", fail)
    counts, raised = run(range(2, 4), 1)
    assert not counts
    assert list(raised) == [2, 3]
    assert "KeyError: 'top'" in raised[2]


def test_the_other_lean_of_a_face_that_no_marker_was_read_of_raises_nothing() -> None:
    counts, told = show(1, 31)
    assert (sum(counts.values()), told) == (FRAMES_PER_CLIP, "")
