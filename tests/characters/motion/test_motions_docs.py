import re
from pathlib import Path

import numpy as np

from cubeling.characters import Motion

PAGE = Path(__file__).parents[3] / "docs" / "motions.md"


def test_the_examples_in_the_documentation_run_and_make_motions():
    names: dict[str, object] = {}
    for block in re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL):
        exec(block, names)
    played = [m for m in names.values() if isinstance(m, Motion) and not isinstance(m, type)]
    assert len(played) > 15
    for motion in played:
        for time in (0.0, 0.7, 3.1):
            pose = motion.sample(time)
            assert np.isfinite(pose.rotations).all()
