"""Ways out of what comes, between other characters."""

import numpy as np

from cubeling.characters.locomotion.obstacles import Obstacle
from cubeling.characters.locomotion.places import way_out

BODY = np.array([[x, y, z] for x in (-0.03, 0.03) for y in (0.0, 0.15) for z in (-0.03, 0.03)])
"""A body that stands at the origin, (8, 3) [m]."""


def box(x, z, velocity=(0.0, 0.0, 0.0), *, alive=False, size=(0.06, 0.15, 0.06)):
    """Return a box on the table at (x, z) [m]."""
    pose = np.eye(4)
    pose[:3, 3] = x, 0.075, z
    return Obstacle(pose, np.array(size), np.array(velocity), alive)


def test_no_way_out_of_an_arm_leads_through_another_character():
    """An arm comes; the shortest way out is through somebody who stands there."""
    arm = box(0.0, -0.2, (0.0, 0.0, 0.3), size=(0.3, 0.15, 0.1))
    other = box(0.02, 0.08, alive=True, size=(0.1, 0.15, 0.1))
    way = way_out(BODY, [arm, other], (0.0, 0.2, 0.4), [0.005, 0.005])
    assert way is not None
    apart = other.size[[0, 2]] / 2 + 0.03
    for share in (0.25, 0.5, 0.75, 1.0):
        offset = share * way.distance * way.direction - other.table_from_box[[0, 2], 3]
        assert (np.abs(offset) > apart - 1e-6).any()


def test_one_who_only_passes_by_moves_nobody():
    passing = box(0.2, -0.2, (0.0, 0.0, 0.5), alive=True)
    assert way_out(BODY, [passing], (0.0, 0.2, 0.4), [0.005]) is None
