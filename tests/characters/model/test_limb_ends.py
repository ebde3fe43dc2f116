import numpy as np
import pytest

from cubeling.characters import Character, Clip, Pose
from cubeling.characters.model.character import skin
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.retargeting.retarget import retarget
from tests.bundled_characters import bundled_character
from tests.characters.skeleton.bodies import DOG, PERSON, named_body

STYLES = {
    "person": (
        "L R Hips Spine Chest Neck Head - UpperArm.{} LowerArm.{} Hand.{} UpperLeg.{} "
        "LowerLeg.{} - - Root>Hips@",
        PERSON,
        2,
    ),
    "dog": (
        "L R Hips Spine Neck Head Tail1 Tail2 BackUpLeg.{} BackLowLeg.{} - - FrontShoulder.{} "
        "FrontUpLeg.{} FrontLowLeg.{} - - Root>Hips@",
        DOG,
        4,
    ),
}


HUMAN = bundled_character("human")
FACES = ((0, 1, 2), (3, 4, 5), (6, 7, 0))


def boxes(skeleton, feet):
    """A box around each joint; those of shins reach down to the ground, and their feet ahead."""
    places = skeleton.rest.globals(skeleton)[:, :3, 3]
    corners = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1]), float).reshape(3, 8).T * 0.03
    points, joints = [], []
    for joint, place in enumerate(places):
        box = place + corners
        if skeleton.names[joint] in feet:
            box[corners[:, 1] < 0, 1] = 0.0
            box[(corners[:, 1] < 0) & (corners[:, 2] > 0), 2] += 0.12
        points.append(box)
        joints += [joint] * 8
    bind = np.tile(np.eye(4), (len(skeleton), 1, 1))
    bind[:, :3, 3] = -places
    positions = np.concatenate(points).astype(np.float32)
    weights = np.tile(np.array([1, 0, 0, 0], np.float32), (len(positions), 1))
    triangles = np.array(
        [(8 * k + a, 8 * k + b, 8 * k + c) for k in range(len(places)) for a, b, c in FACES],
        np.uint32,
    )
    moved = np.zeros((len(positions), 4), np.uint16)
    moved[:, 0] = joints
    normals = np.tile(np.array([0, 1, 0], np.float32), (len(positions), 1))
    return Mesh("boxes", positions, normals, triangles, moved, weights, bind)


@pytest.fixture(params=STYLES)
def made(request, tmp_path):
    style, tree, legs = STYLES[request.param]
    skeleton, _ = named_body(style, tree)
    shins = [name for name in skeleton.names if "Low" in name and "Arm" not in name]
    clip = Clip("Still", 30.0, Pose.of_frames([skeleton.rest] * 3))
    character = Character("made", skeleton, {"Still": clip}, (boxes(skeleton, shins),))
    character.save(tmp_path / "made.glb")
    return character, Character.load(tmp_path / "made.glb"), legs, tmp_path


def test_legs_that_end_at_the_shin_stand_on_the_middle_of_its_sole(made):
    _, loaded, legs, _ = made
    assert loaded.anatomy.missing == ()
    assert len(loaded.anatomy.feet) == legs
    places = loaded.skeleton.rest.globals(loaded.skeleton)[:, :3, 3]
    for foot in loaded.anatomy.feet:
        shin = loaded.skeleton.parents[foot]
        assert places[foot] == pytest.approx(
            [places[shin, 0], 0.0, places[shin, 2] + 0.06], abs=1e-6
        )


def test_a_foot_that_was_added_changes_nothing_that_is_drawn(made):
    loaded = made[1]
    assert len(loaded.clips["Still"].poses.translations[0]) == len(loaded.skeleton)
    mesh = loaded.meshes[0]
    drawn = skin(mesh, loaded.skeleton.rest.globals(loaded.skeleton))
    assert drawn == pytest.approx(mesh.positions, abs=1e-6)


def test_a_foot_is_added_once(made):
    _, loaded, _, folder = made
    loaded.save(folder / "again.glb")
    again = Character.load(folder / "again.glb")
    assert again.skeleton.names == loaded.skeleton.names
    assert again.anatomy == loaded.anatomy


def test_a_stiff_leg_gets_a_knee_and_a_foot_and_a_stiff_arm_an_elbow(tmp_path):
    style = "left right root torso - - head - arm-{} - - leg-{} - - -"
    skeleton, _ = named_body(style, PERSON)
    blocky = Character("blocky", skeleton, {}, (boxes(skeleton, ["leg-left", "leg-right"]),))
    blocky.save(tmp_path / "blocky.glb")
    loaded = Character.load(tmp_path / "blocky.glb")
    assert loaded.anatomy.kind == "humanoid"
    assert loaded.anatomy.missing == ("leftHand", "rightHand")
    places = loaded.skeleton.rest.globals(loaded.skeleton)[:, :3, 3]
    hip, knee, foot = (
        places[loaded.anatomy.joints[f"left{part}"]] for part in ("UpperLeg", "LowerLeg", "Foot")
    )
    assert foot[1] == pytest.approx(0.0, abs=1e-6)
    assert knee == pytest.approx((hip + foot) / 2, abs=1e-6)
    bodies = (loaded.skeleton, loaded.anatomy)
    walk = retarget(HUMAN.clips["Walk"], HUMAN.skeleton, HUMAN.anatomy, *bodies)
    steps = walk.poses.globals(loaded.skeleton)[..., :3, 3][:, list(loaded.anatomy.feet)]
    assert steps[..., 1].min() > -0.02
    assert np.ptp(steps[..., 2], axis=0).min() > 0.3


@pytest.mark.parametrize("made", ["person"], indirect=True)
def test_a_person_without_feet_walks_in_anothers_steps(made):
    loaded = made[1]
    bodies = (HUMAN.skeleton, HUMAN.anatomy, loaded.skeleton, loaded.anatomy)
    walk = retarget(HUMAN.clips["Walk"], *bodies)
    heights = walk.poses.globals(loaded.skeleton)[:, list(loaded.anatomy.feet), 1, 3]
    assert heights.min() > -0.02
    assert heights.max(0).min() > 0.05
