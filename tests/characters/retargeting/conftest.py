"""Lets tests of one gait make one clip of it, or one curve, not a whole tree of curves."""

import pytest

from cubeling.characters.retargeting.locomotion import locomotion_clips


@pytest.fixture
def straight_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make no curves: a tree of walking or running has its straight clip alone."""
    for name, clip in (("WALK_CLIPS", "Walk"), ("RUN_CLIPS", "Run")):
        monkeypatch.setattr(locomotion_clips, name, {0.0: clip})


@pytest.fixture
def one_curve(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make one curve to each side: those of several differ in how much they turn alone."""
    walks = {-60.0: "WalkLeftMedium", 0.0: "Walk", 60.0: "WalkRightMedium"}
    runs = {-90.0: "RunLeftMedium", 0.0: "Run", 90.0: "RunRightMedium"}
    monkeypatch.setattr(locomotion_clips, "WALK_CLIPS", walks)
    monkeypatch.setattr(locomotion_clips, "RUN_CLIPS", runs)
