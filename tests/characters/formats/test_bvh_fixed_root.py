"""Recordings whose joint 0 stays at the origin while the person walks away from it."""

import math

import numpy as np
import pytest

from cubeling.characters import Character, CharacterError
from cubeling.characters.formats import load_motion
from cubeling.characters.retargeting import load_recording, make_locomotion

LIMBS = (
    *(("Spine", "Hips", 10), ("Chest", "Spine", 20), ("Neck", "Chest", 22), ("Head", "Neck", 12)),
    *((side + part, above, length)
      for side in ("Left", "Right")
      for part, above, length in (
          ("UpLeg", "Hips", 9), ("Leg", f"{side}UpLeg", 42), ("Foot", f"{side}Leg", 43),
          ("Arm", "Chest", 15), ("ForeArm", f"{side}Arm", 28), ("Hand", f"{side}ForeArm", 25))),
)  # fmt: skip
"""Joints with the joint above and their distance along x [cm]."""


def bones_along_x(away, frames=40):
    """A BVH of a person who walks along z from `away` [cm]; every bone lies along x at rest."""
    turns = {"Hips": 0.0, "Spine": 90.0} | {f"{s}UpLeg": -90.0 for s in ("Left", "Right")}
    turns |= {"LeftArm": 180.0, "RightArm": 180.0}

    def write(name):
        length = next((each for joint, _, each in LIMBS if joint == name), 0)
        below = [joint for joint, above, _ in LIMBS if above == name]
        yield f"JOINT {name}\n{{\nOFFSET {length if name != 'Hips' else 0} 0 0"
        yield "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation"
        for joint in below:
            yield from write(joint)
        if not below:
            yield "End Site\n{\nOFFSET 10 0 0\n}"
        yield "}"

    root = "HIERARCHY\nROOT joint_Root\n{\nOFFSET 0 0 0"
    channels = "CHANNELS 3 Xposition Yposition Zposition"
    text = "\n".join([root, channels, *write("Hips"), "}"])
    # Channels come in the order of the joints in the file: parents first.
    names = [line.split()[1] for line in text.splitlines() if line.startswith("JOINT")]
    rows = []
    for frame in range(frames):
        row = [0.0] * 3
        step = 25.0 * math.sin(2 * math.pi * frame / 20)
        for name in names:
            length = next((each for joint, _, each in LIMBS if joint == name), 0)
            place = [float(length), 0.0, 0.0]
            turn = [turns.get(name, 0.0), 0.0, 0.0]
            if name == "Hips":
                place = [0.0, 95.0, away + 6.0 * frame]
            if name.endswith("UpLeg"):
                side = 1.0 if name.startswith("Left") else -1.0
                place = [0.0, 0.0, 0.0]
                turn[2] = side * step
            row += [*place, *turn]
        rows.append(" ".join(f"{value:.4f}" for value in row))
    return f"{text}\nMOTION\nFrames: {frames}\nFrame Time: 0.0333333\n" + "\n".join(rows) + "\n"


@pytest.mark.parametrize("away", [0.0, 200.0, -400.0])
def test_a_person_stands_however_far_from_a_root_that_stays_at_the_origin(tmp_path, away):
    path = tmp_path / "walk.bvh"
    path.write_text(bones_along_x(away))
    motion = load_motion(path)
    names = motion.skeleton.names
    at = motion.clip.poses.globals(motion.skeleton)[..., :3, 3]
    body = at[:, names.index("Head")] - at[:, names.index("LeftFoot")]
    assert (body[:, 1] > 0.9 * np.linalg.norm(body, axis=1)).all()
    assert 1.3 < body[:, 1].max() < 1.8
    assert not any("up" in note for note in motion.notes)


def test_a_body_that_lies_is_refused_as_a_walk_with_its_angle(tmp_path):
    path = tmp_path / "lies.bvh"
    path.write_text(bones_along_x(0.0))
    lying = load_recording(str(path), up="z")
    with pytest.raises(CharacterError, match=r"lies\.bvh: its body lies, \d+° away from upright"):
        make_locomotion(Character.load("human"), [lying])
