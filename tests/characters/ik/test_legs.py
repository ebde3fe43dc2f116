import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters import Character, Pose, Skeleton
from cubeling.characters.ik import two_bones
from cubeling.characters.ik.legs import find_legs
from cubeling.characters.locomotion.gaits import Gaits
from cubeling.characters.motion.blend import mix
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.scalar_quaternions import multiply, rotate, subtract

NAMES = (
    "root", "hips",
    "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToe",
    "RightUpLeg", "RightLeg", "RightFoot", "RightToe",
)  # fmt: skip
PARENTS = (-1, 0, 1, 2, 3, 4, 1, 6, 7, 8)


@pytest.fixture(scope="module")
def body():
    offsets = np.zeros((10, 3))
    offsets[1] = [0, 0.9, 0]
    for first, side in ((2, 1), (6, -1)):
        offsets[first : first + 4] = [
            [side * 0.1, 0, 0],
            [0, -0.4, 0.02],
            [0, -0.4, -0.02],
            [0, -0.06, 0.1],
        ]
    return Skeleton(NAMES, PARENTS, Pose(offsets, np.tile(rotations.IDENTITY, (10, 1))))


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


def planted(body, poses, weights):
    """The mix of poses, its feet at the mean of their feet."""
    legs = find_legs(body)
    assert legs is not None
    mixed = mix(poses, weights)
    feet = [pose.globals(body) for pose in (*poses, mixed)]
    balls = [
        np.tensordot(weights, [each[toes, :3, 3] for each in feet[:-1]], 1).tolist()
        for toes in (5, 9)
    ]
    facings = [rotations.from_matrix(feet[-1][ankle, :3, :3]).tolist() for ankle in (4, 8)]
    return legs.reach(mixed, balls, facings)


def bent(body, angles):
    """A pose with hips, knees and ankles bent; knees only backward."""
    hip, knee, ankle, hip2, knee2, ankle2 = angles
    turns = body.rest.rotations.copy()
    bends = [-hip, knee, -ankle, 0.0, -hip2, knee2, -ankle2, 0.0]
    turns[2:] = rotations.about("x", np.array(bends))
    return Pose(body.rest.translations, turns)


bends = st.tuples(*[st.floats(-0.5, 0.9), st.floats(0.1, 1.2), st.floats(-0.4, 0.4)] * 2)


@given(bends, bends, st.floats(0, 1))
def test_the_feet_of_a_mix_are_the_mean_of_the_feet(body, one, other, share):
    poses, weights = [bent(body, one), bent(body, other)], [1 - share, share]
    shown = planted(body, poses, weights)
    feet, single = shown.globals(body), [pose.globals(body) for pose in poses]
    mean = (1 - share) * single[0] + share * single[1]
    for hip, ankle, toes in ((2, 4, 5), (6, 8, 9)):
        wanted = mean[toes, :3, 3]
        reach = np.linalg.norm(feet[ankle, :3, 3] - feet[hip, :3, 3])
        if reach < 0.79:  # otherwise the leg is too short to get there
            assert np.allclose(feet[toes, :3, 3], wanted, atol=1e-4)


@given(bends)
def test_a_pose_mixed_with_itself_is_left_as_it_is(body, one):
    pose = bent(body, one)
    shown = planted(body, [pose, pose], [0.5, 0.5])
    moved = shown.globals(body)[:, :3, 3] - pose.globals(body)[:, :3, 3]
    assert np.abs(moved).max() < 2e-3


def test_legs_are_found_from_pelvis_to_toes(human):
    legs = find_legs(human.skeleton)
    assert legs is not None
    names = [[legs.skeleton.names[joint] for joint in line] for line in legs.joints]
    for side, line in zip(("Left", "Right"), names, strict=True):
        assert line == ["hips", *(f"{side}{part}" for part in ("UpLeg", "Leg", "Foot", "Toe"))]


def test_without_knees_there_are_no_legs_to_bend(skeleton):
    assert find_legs(skeleton) is None


@pytest.mark.parametrize("weight", [0.25, 0.5, 0.75])
def test_a_foot_that_stands_in_walk_and_in_run_stands_in_the_mix(human, weight):
    gaits = Gaits(human.clips, human.skeleton, human.clips["idle"].sample(0.0))
    blend = gaits.at(2.75 + 0.5 * weight, 0.0)
    toes = human.skeleton.index("LeftToe")
    phases = np.linspace(0.1, 0.24, 16)  # the left foot is flat on the ground in both
    places = []
    for phase in phases:
        x, _, z = blend.at(phase).globals(human.skeleton)[toes, :3, 3]
        at = blend.between(0.0, phase).then(RootDelta(x, z))
        places.append((at.x, at.z))
    assert np.ptp(places, axis=0).max() < 5e-3  # [m]; joints alone let it slide by centimetres


@pytest.mark.parametrize("speed", [0.5, 1.0, 2.0, 3.0, 5.0])
def test_no_foot_dips_into_the_ground(human, speed):
    gaits = Gaits(human.clips, human.skeleton, human.clips["idle"].sample(0.0))
    joints = [
        human.skeleton.index(f"{side}{part}")
        for side in ("Left", "Right")
        for part in ("Foot", "Toe")
    ]
    rest = human.skeleton.rest.globals(human.skeleton)[joints, 1, 3]
    motion = gaits.at(speed, 0.7)
    heights = [
        motion.at(phase).globals(human.skeleton)[joints, 1, 3] for phase in np.arange(40) / 40
    ]
    assert (np.array(heights) - rest).min() > -0.006  # [m] of a person 1.7 m tall


def test_a_knee_that_is_stretched_too_far_bends_back_the_right_way():
    hip, ankle, target = (0.0, 0.8, 0.0), (0.0, 0.0, 0.0), (0.0, 0.1, 0.0)
    for knee in ((0.0, 0.4, 0.02), (0.0, 0.4, -0.02)):  # bent a little, and too straight
        upper, lower = two_bones.reach(hip, knee, ankle, target)
        x, y, z = rotate(upper, subtract(knee, hip))
        assert z > 0.1  # the knee comes forward
        sx, sy, sz = rotate(multiply(upper, lower), subtract(ankle, knee))
        assert (x + sx, 0.8 + y + sy, z + sz) == pytest.approx(target, abs=1e-6)


def test_a_knee_does_not_snap_while_it_is_stretched_past_straight() -> None:
    """A nearly straight knee of a recording also bends a little to the side."""
    hip, target = (0.0, 1.0, 0.0), (0.0, 0.012, 0.0)
    knees = []
    for flexion in np.linspace(-0.06, 0.06, 121):  # forward of the line from hip to ankle [m]
        knee = (0.04, 0.5, float(flexion))
        upper, _ = two_bones.reach(hip, knee, (0.0, 0.0, 0.0), target)
        knees.append(rotate(upper, subtract(knee, hip)))
    assert np.abs(np.diff(knees, axis=0)).max() < 0.01
    assert np.array(knees)[:, 2].min() > -0.01  # always bent the right way
