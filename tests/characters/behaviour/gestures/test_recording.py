"""Gestures taken from recordings: what a character performed is found again."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import Character, CharacterError, Clip, Pose
from cubeling.characters.behaviour.gestures.planning import GestureRealizer
from cubeling.characters.behaviour.gestures.recording import gesture_from_recording, polyline
from cubeling.characters.behaviour.symbolic_gesture import BodyKey, HandKey, Place, SymbolicGesture

KEYS = (
    HandKey(0.0, Place("XP", "YUpperP", "ZMiddle"), "flat", "forward", "up"),
    HandKey(0.5, Place("XC", "YLowerC", "ZMiddle"), "fist", "down", "forward"),
    HandKey(1.0, Place("XP", "YCC", "ZMiddle"), "point", "in", "forward"),
)
GESTURE = SymbolicGesture("Z", right=KEYS, one_handed=True, stroke=1.0)


@pytest.fixture(scope="module")
def performer():
    return GestureRealizer.of(Character.load("human"))


def _recorded(performer, gesture, hand):
    """Return a clip: 0.6 s up from rest, the stroke, 0.6 s down."""
    motion = performer.plan(gesture, hand)

    def pose(time):
        up, down = np.clip([time / 0.6, (2.2 - time) / 0.6], 0.0, 1.0)
        weight = min(up * up * (3.0 - 2.0 * up), down * down * (3.0 - 2.0 * down))
        share = min(max(time - 0.6, 0.0), 1.0)
        return motion.over(performer.posture, motion.times.in_stroke(share), float(weight))

    poses = [pose(float(time)) for time in np.arange(0.0, 2.2, 1 / 60)]
    return Clip("take", 60.0, Pose.of_frames(poses), loop=False)


@pytest.mark.parametrize("hand", ["right", "left", "both"])
def test_sectors_palms_and_shapes_come_back(performer, hand):
    character = performer.character
    clip = _recorded(performer, GESTURE, hand)
    found = gesture_from_recording(clip, character.skeleton, character.anatomy, name="AGAIN")
    assert found.name == "AGAIN"
    assert found.one_handed == (hand != "both")
    for keys in (found.right, found.left) if hand == "both" else (found.right,):
        assert [(key.place.x, key.place.y, key.place.z) for key in keys] == [
            (key.place.x, key.place.y, key.place.z) for key in KEYS
        ]
        for key, asked in zip(keys, KEYS, strict=True):
            assert (key.shape, key.palm, key.fingers) == (asked.shape, asked.palm, asked.fingers)
            assert key.at == pytest.approx(asked.at, abs=0.05)
    assert found.preparation == pytest.approx(0.6, abs=0.06)
    assert found.stroke == pytest.approx(1.0, abs=0.06)


def test_a_turn_of_the_trunk_comes_back(performer):
    character = performer.character
    turned = replace(GESTURE, body=(BodyKey(0.0), BodyKey(1.0, lean_deg=15.0, turn_deg=20.0)))
    clip = _recorded(performer, turned, "right")
    found = gesture_from_recording(clip, character.skeleton, character.anatomy, 0.0, 1.6)
    assert found.body[-1].lean_deg == pytest.approx(15.0, abs=3.0)
    assert found.body[-1].turn_deg == pytest.approx(20.0, abs=3.0)


def test_a_span_without_movement_is_refused(performer):
    character = performer.character
    clip = Clip("still", 30.0, Pose.of_frames([performer.posture] * 30), loop=False)
    with pytest.raises(CharacterError, match="no hand moves"):
        gesture_from_recording(clip, character.skeleton, character.anatomy)


def test_a_body_without_arms_is_refused(actor):
    clip = next(iter(actor.clips.values()))
    with pytest.raises(CharacterError, match="no arms"):
        gesture_from_recording(clip, actor.skeleton, actor.anatomy)


def test_a_polyline_is_near_all_points():
    way = np.linspace(0.0, 3.0, 200)
    points = np.stack([way, np.sin(way)], axis=1)
    kept = polyline(points, 0.05)
    off = np.abs(np.interp(way, way[kept], points[kept, 1]) - points[:, 1])
    assert kept[0] == 0
    assert kept[-1] == 199
    assert off.max() < 0.08
    assert len(kept) < 12
