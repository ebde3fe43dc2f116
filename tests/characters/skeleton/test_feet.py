import numpy as np
import pytest

from characters import Pose, Skeleton
from characters.skeleton import rotations
from characters.skeleton.feet import foot_joints_by_side


@pytest.mark.parametrize(
    "names",
    [
        ("LeftFoot", "RightFoot", "Spine"),
        ("foot_l", "foot_r", "ball"),
        ("Foot.L", "Foot.R", "Metal_bar"),
        ("b_LeftFoot01_017", "b_RightFoot01_021", "tail"),
        ("ToeL", "ToeR", "toeless"),
    ],
)
def test_feet_are_found_by_common_joint_names(names):
    rest = Pose(np.zeros((3, 3)), np.tile(rotations.IDENTITY, (3, 1)))
    assert foot_joints_by_side(Skeleton(names, (-1, -1, -1), rest)) == ([0], [1])
