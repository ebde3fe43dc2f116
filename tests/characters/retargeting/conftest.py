"""Lets tests of one gait make one clip of it, not a whole tree of curves."""

import pytest

from cubeling.characters.retargeting.locomotion import locomotion_clips


@pytest.fixture
def straight_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make no curves: a tree of walking or running has its straight clip alone."""
    for name, clip in (("WALK_CLIPS", "Walk"), ("RUN_CLIPS", "Run")):
        monkeypatch.setattr(locomotion_clips, name, {0.0: clip})
