import math
from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import Animator, Character, RootDelta
from cubeling.characters.model.look_at import LookAt, RangeMap
from tests.characters.commands import command


def test_what_a_clip_states_beyond_a_whole_morph_stays():
    vleo = Character.load("vleo")
    stated = vleo.clips["kiss_head"].poses.morphs
    assert stated is not None
    kiss = stated.max(0)
    assert kiss.max() > 1.0
    animator = Animator(vleo, place=RootDelta())
    poses = [animator.update(command(n / 30, "kiss", weight=-1.0)).pose for n in range(90)]
    shown = np.max([pose.morphs for pose in poses if pose.morphs is not None], axis=0)
    assert shown.max() == pytest.approx(kiss.max(), abs=0.02)


@pytest.mark.parametrize("most", [1.0, 10.0])
def test_a_look_by_expressions_is_at_most_a_whole_one_whatever_its_range(most):
    ranges = RangeMap(math.radians(90.0), most)
    looking = LookAt("expression", ranges, ranges, ranges, ranges)
    assert max(map(abs, looking.map_angles(0.6, -0.6))) <= 1.0
    turning = replace(looking, by="bone")
    assert turning.map_angles(math.pi / 2, 0.0)[0] == pytest.approx(most)
