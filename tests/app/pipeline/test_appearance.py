"""What the drawing follows of the camera's picture, and that nothing else changes by it."""

from dataclasses import replace
from typing import cast

import moderngl
import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.pipeline import step_renderer
from cubeling.app.pipeline.choices import REALISM_CHOICES, realism_of
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.step_renderer import FOCUSING_S, FocusDistance
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.tracking import CubeGestures, CubeTracker
from cubeling.tracking.synthetic import open_synthetic

FRAMES = 12


@pytest.fixture(scope="module")
def source():
    return open_synthetic("static?clutter=0")


@pytest.fixture(scope="module")
def seen(source):
    tracker, gestures = CubeTracker(source.cube, source.intrinsics), CubeGestures(source.cube)
    found = []
    for index in range(FRAMES):
        frame = source.frame(index)
        state = tracker.update(frame)
        found.append((frame, state, gestures.update(state)))
    return found


def last_view(source, seen, chosen, monkeypatch):
    """Return what a stage would draw of the last frame."""
    views = []

    class Noting:
        def __init__(self, *given):
            pass

        def draw(self, view, characters, floor):
            views.append(view)

        def __getattr__(self, name):
            return lambda *given: None

    monkeypatch.setattr(step_renderer, "_stage", Noting)
    context = cast(moderngl.Context, object())
    playground = Playground(
        "follow", source.intrinsics, cube=source.cube, context=context, realism=chosen
    )
    for frame, _, _ in seen:
        playground.step(frame)
    return views[-1]


def test_nothing_is_measured_that_was_not_chosen(source, seen, monkeypatch):
    plain = last_view(source, seen, (), monkeypatch)
    assert plain.hand is None
    assert plain.light is None
    assert plain.softness is None
    assert plain.focus is None
    assert len(plain.occluders) == 1


@pytest.mark.slow(reason="all is measured")
def test_what_was_chosen_is_measured_and_handed_to_the_stage(source, seen, monkeypatch):
    full = last_view(source, seen, tuple(REALISM_CHOICES), monkeypatch)
    assert full.hand is None  # none is near
    assert full.light.certainty > 0.0
    assert full.softness.blur == pytest.approx(0.5, abs=0.25)
    assert full.focus.nearest == pytest.approx(seen[-1][1].camera_from_cube[2, 3], rel=1e-3)


def test_the_picture_alone_depends_on_it(source, seen):
    intrinsics = intrinsics_for(source.intrinsics, source.size)
    plain, real = (
        Playground("companion", intrinsics, realism=chosen, measured=True)
        for chosen in ((), tuple(REALISM_CHOICES))
    )
    for frame, _, _ in seen[:20]:
        first, second = plain.step(frame), real.step(frame)
        assert first.appearance is None
        assert second.appearance is not None
        assert first.emotion == second.emotion
        assert np.array_equal(first.posed.pose.rotations, second.posed.pose.rotations)


def test_the_focus_follows_the_cube_in_about_half_a_second(seen):
    state = seen[0][1]
    focus = FocusDistance()
    assert focus.update(replace(state, camera_from_cube=None)) is None
    near = focus.update(state)
    assert near is not None
    further = state.camera_from_cube.copy()
    further[2, 3] += 0.2
    moved = replace(state, camera_from_cube=further, timestamp=state.timestamp + FOCUSING_S)
    found = focus.update(moved)
    assert found is not None
    assert found.nearest - near.nearest == pytest.approx(0.2 * (1 - np.exp(-1)))
    lost = focus.update(replace(moved, camera_from_cube=None))
    assert lost == found


def test_choices_are_names_separated_by_commas():
    assert realism_of("light,hand") == ("light", "hand")
    assert realism_of("none") == ()


@pytest.mark.parametrize("text", ["", "shadow", "hand,", "none,hand", "Hand"])
def test_another_name_is_refused_in_one_line(text):
    known = ", ".join(REALISM_CHOICES)
    with pytest.raises(AppError, match=f"choose of {known}, or none"):
        realism_of(text)
