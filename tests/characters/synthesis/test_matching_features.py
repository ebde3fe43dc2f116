"""What frames are compared by: exact for motions that are known."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose, Skeleton
from cubeling.characters.synthesis.matching.features import (
    HORIZONS_S,
    FeatureJoints,
    FeatureSpace,
    clip_features,
    row_times,
)

REST = Pose(
    np.array([[0.0, 0, 0], [0, 0.9, 0], [0.1, -0.8, 0], [-0.1, -0.8, 0]]),
    np.tile(rotations.IDENTITY, (4, 1)),
)
SKELETON = Skeleton(("root", "hips", "left", "right"), (-1, 0, 1, 1), REST)
JOINTS = FeatureJoints(hips=1, feet=(2, 3), hands=())
RATE = 60.0


def gliding(seconds, speed, turn_rate, loop=False, start=(0.0, 0.0, 0.0)):
    """Return a clip of a stiff body that glides at a speed [m/s] and turns [rad/s]."""
    times = np.arange(round(seconds * RATE) + 1) / RATE
    yaw = turn_rate * times
    if turn_rate:
        x, z = (1 - np.cos(yaw)) * speed / turn_rate, np.sin(yaw) * speed / turn_rate
    else:
        x, z = np.zeros_like(times), speed * times
    shifts = np.tile(REST.translations, (len(times), 1, 1))
    turns = np.tile(REST.rotations, (len(times), 1, 1))
    turned = rotations.about("y", np.full(len(times), start[2]))
    path = np.stack([x, np.zeros_like(x), z], axis=-1)
    shifts[:, 0] = rotations.rotate(turned, path) + [start[0], 0.0, start[1]]
    turns[:, 0] = rotations.about("y", yaw + start[2])
    return Clip("gliding", RATE, Pose(shifts, turns), loop, root_motion=True)


@pytest.mark.parametrize("loop", [True, False])
@pytest.mark.parametrize(("speed", "turn_rate"), [(1.4, 0.0), (1.0, 0.8), (2.0, -1.5)])
def test_path_and_facing_are_exact_on_arcs_also_beyond_the_end(speed, turn_rate, loop):
    features = clip_features(gliding(1.5, speed, turn_rate, loop), SKELETON, JOINTS)
    for number, horizon in enumerate(HORIZONS_S):
        angle = turn_rate * horizon
        sine = math.sin(angle) / turn_rate if turn_rate else horizon
        aside = (1 - math.cos(angle)) / turn_rate if turn_rate else 0.0
        columns = slice(2 * number, 2 * number + 2)
        expected = np.array([aside, sine]) * speed
        np.testing.assert_allclose(features["path"][:, columns] - expected, 0.0, atol=2e-4)
        facing = features["facing"][:, columns] - [math.sin(angle), math.cos(angle)]
        np.testing.assert_allclose(facing, 0.0, atol=1e-6)


def test_velocities_are_over_the_ground():
    features = clip_features(gliding(1.0, 1.4, 0.5), SKELETON, JOINTS)
    # The left foot is 0.1 m from the root, on the outside of no turn to its own side.
    np.testing.assert_allclose(features["foot velocities"][:, 2] - (1.4 - 0.05), 0.0, atol=1e-4)
    np.testing.assert_allclose(features["hips velocity"] - [0, 0, 1.4], 0.0, atol=1e-4)


def test_features_do_not_depend_on_place_and_heading():
    here = clip_features(gliding(1.0, 1.2, 0.7), SKELETON, JOINTS)
    there = clip_features(gliding(1.0, 1.2, 0.7, start=(5.0, -3.0, 2.0)), SKELETON, JOINTS)
    for name, values in here.items():
        np.testing.assert_allclose(values, there[name], atol=1e-9, err_msg=name)


def test_a_loop_has_no_row_for_its_end():
    clip = gliding(1.0, 1.0, 0.0)
    assert len(row_times(clip)) == 31
    assert len(row_times(replace(clip, loop=True))) == 30


def test_a_feature_has_one_scale_and_its_weight():
    rng = np.random.default_rng(0)
    features = [{"a": rng.normal(3.0, (1.0, 2.0), (200, 2)), "b": rng.normal(0, 9, (200, 1))}]
    space = FeatureSpace.of(features, {"a": 2.0, "b": 0.5})
    spreads = space.values.std(0)
    assert math.hypot(*spreads[:2]) == pytest.approx(2.0 * math.sqrt(2))
    assert spreads[1] / spreads[0] == pytest.approx(2.0, rel=0.2)
    assert spreads[2] == pytest.approx(0.5)
    np.testing.assert_allclose(space.scale_feature("a", features[0]["a"][7]), space.values[7, :2])
