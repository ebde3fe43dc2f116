"""A leg, a foot and a head in ASF, and two frames of AMC."""

from pathlib import Path

import numpy as np

from cubeling.characters.formats import RecordedMotion

ASF = """# made by hand
:version 1.10
:name hopper
:units
  mass 1.0
  length 0.45
  angle deg
:documentation
   begin anything, :here or not
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
  begin
     id 1
     name leg
     direction 0 -1 0
     length 16
     axis 0 0 90 XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           (-60.0 70.0)
  end
  begin
     id 2
     name foot
     direction 0 0 1
     length 4
     axis 0 0 0 XYZ
    dof rx
    limits (-10 10)
  end
  begin
     id 3
     name head
     direction 0 1 0
     length 12
     axis 0 0 0 XYZ
  end
:hierarchy
  begin
    root leg head
    leg foot
  end
"""

AMC = """#!OML:ASF hopper.ASF
:FULLY-SPECIFIED
:DEGREES
1
root 0 16 0 0 0 0
leg 0 0 0
foot 0
2
root 1 16 2 0 90 0
leg 30 0 0
foot -10
"""


def hopper(folder: Path, asf: str = ASF, amc: str = AMC) -> Path:
    (folder / "hopper.asf").write_text(asf)
    (folder / "hopper.amc").write_text(amc)
    return folder / "hopper.amc"


def places(performance: RecordedMotion) -> np.ndarray:
    """World positions of every joint, (frames, joints, 3)."""
    return performance.clip.poses.globals(performance.skeleton)[..., :3, 3]
